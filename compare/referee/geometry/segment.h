/* Distances of points, segments and triangles, on which the referee's geometry of surfaces is
 * built. A segment may have no length, and a triangle no area. Source: Ericson 2005, ch. 5. */
#ifndef PLUMB_SEGMENT_H
#define PLUMB_SEGMENT_H

#include "plumb/vec.h"

#include <stdbool.h>

/* A line segment; m. */
typedef struct pl_segment {
    pl_vec start, end;
} pl_segment;

/* A triangle, counter-clockwise seen from outside where it bounds a solid; m. */
typedef struct pl_triangle {
    pl_vec corner[3];
} pl_triangle;

/* The feature of a triangle on which a point lies. */
typedef enum pl_feature {
    PL_CORNER_0,   /* + k: corner k */
    PL_EDGE_0 = 3, /* + k: within the edge from corner k to the next */
    PL_FACE = 6
} pl_feature;

/* The distance of two segments, m. */
double pl_segment_distance(const pl_segment *a, const pl_segment *b);

/* The point of a triangle nearest to `point`, and the feature that it lies on (NULL allowed). */
pl_vec pl_triangle_nearest(const pl_triangle *triangle, pl_vec point, pl_feature *feature);

/* Whether a segment crosses a triangle in one point, and where: the fraction of the segment's
 * length from its start, 0 .. 1. False for a segment in the triangle's plane. */
bool pl_triangle_pierced(const pl_triangle *triangle, const pl_segment *segment, double *fraction);

/* The distance of two triangles, m; 0 if they meet. */
double pl_triangle_distance(const pl_triangle *a, const pl_triangle *b);

#endif
