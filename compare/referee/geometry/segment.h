/* Distances of points, segments and triangles: the primitives of the referee's geometry of
 * surfaces.
 *
 * Source: Ericson 2005, ch. 5. A segment may have no length and a triangle no area. */
#ifndef PLUMB_SEGMENT_H
#define PLUMB_SEGMENT_H

#include "plumb/vec.h"

#include <stdbool.h>

typedef struct pl_segment {
    pl_vec start, end;
} pl_segment;

typedef struct pl_triangle {
    pl_vec corner[3];
} pl_triangle;

/* Where the nearest point of a triangle lies on it. */
typedef enum pl_feature {
    PL_CORNER_0,   /* + k: corner k */
    PL_EDGE_0 = 3, /* + k: within the edge from corner k to the next */
    PL_FACE = 6
} pl_feature;

/* The point of a segment nearest to `point`. */
pl_vec pl_segment_nearest(const pl_segment *segment, pl_vec point);

/* The distance of two segments, m, with their nearest points (NULL allowed). */
double pl_segment_distance(const pl_segment *a, const pl_segment *b, pl_vec *on_a, pl_vec *on_b);

/* The point of a triangle nearest to `point`, and the feature it lies on (NULL allowed). */
pl_vec pl_triangle_nearest(const pl_triangle *triangle, pl_vec point, pl_feature *feature);

/* Whether a segment meets a triangle in one point, and where: a fraction of its way, 0 .. 1. One
 * that lies in the triangle's plane does not. */
bool pl_triangle_pierced(const pl_triangle *triangle, const pl_segment *segment, double *fraction);

/* The distance of two triangles, m; 0 if they meet. */
double pl_triangle_distance(const pl_triangle *a, const pl_triangle *b);

/* The distance of a triangle and a segment, m; 0 if they meet. */
double pl_triangle_segment_distance(const pl_triangle *triangle, const pl_segment *segment);

#endif
