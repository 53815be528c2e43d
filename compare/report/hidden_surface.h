/* Which faces of a picture are seen, and the order in which to paint them. */
#ifndef PLUMB_PAINTER_H
#define PLUMB_PAINTER_H

#include "view.h"

#include <stdbool.h>
#include <stddef.h>

/* A flat quadrilateral, a triangle, whose last corner is there twice, or a sphere's disc (corner 0
 * is its centre). */
typedef struct pl_face {
    pl_pixel corner[4];
    double depth[4]; /* px, of the corners; larger is nearer the eye */
    double radius;   /* px; 0 for a quadrilateral or triangle */
    char kind;       /* the painter does not look at these */
    int shade;
    bool triangle, fine;
} pl_face;

typedef struct pl_painting {
    pl_face *faces;
    size_t count;
} pl_painting;

/* Drops the faces that are nowhere seen in a picture of width x height px, and sorts the others so
 * that, painted one over the other, they show what is nearest. Deterministic. False when out of
 * memory: the painting is then in any order. Time: samples covered, summed over faces. */
bool pl_painting_arrange(pl_painting *painting, double width, double height);

/* Some of the face is inside the picture, judged by its bounding rectangle. */
bool pl_face_inside(const pl_face *face, double width, double height);

#endif
