/* The faces of a hull as polygons, for engines whose hulls need them. */
#ifndef PLUMB_HULL_FACES_H
#define PLUMB_HULL_FACES_H

#include "plumb/scene.h"

/* The faces of one hull. */
typedef struct pl_hull_faces {
    int count;
    double (*planes)[4]; /* (count): unit normal n out of the hull, and n . x on the face, m */
    /* For each face how many corners it has, then their indices, counter-clockwise seen from
     * outside. */
    unsigned int *polygons;
} pl_hull_faces;

/* The faces of a convex polyhedron, its planes in the frame with origin `origin` and the shape's
 * axes. On success the caller frees *faces. PL_NO_MEMORY; PL_BAD_INPUT when the triangles of one
 * plane do not have a single border, as those of a hull do. */
pl_status pl_hull_faces_of(const pl_polyhedron *hull, const double origin[3], pl_hull_faces *faces,
                           pl_error *error);

/* Frees the faces. */
void pl_hull_faces_free(pl_hull_faces *faces);

#endif
