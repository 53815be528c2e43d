/* How deep a stretch of an edge lies inside a solid. */
#ifndef PLUMB_STRETCH_H
#define PLUMB_STRETCH_H

#include "plumb/vec.h"

#include <stdbool.h>

/* A plane that touches the solid's surface: {x : normal.x = offset}, normal unit and outward. */
typedef struct pl_tangent {
    pl_vec normal;
    double offset; /* m */
} pl_tangent;

/* The tangent through a point. */
pl_tangent pl_tangent_at(pl_vec normal, pl_vec point);

typedef struct pl_edge_segment {
    pl_vec p, q; /* its ends, m */
    /* Of the surface there, or where the end or the middle is inside, nearest to it. */
    pl_tangent at_p, at_q, at_middle;
    double middle_depth; /* m, of its middle: the distance to the surface */
} pl_edge_segment;

/* The point, m, of the line in which the tangents meet that is nearest to the stretch. False where
 * they do not meet, or in a line along the stretch. */
bool pl_edge_segment_ridge(const pl_edge_segment *stretch, pl_vec *ridge);

/* The least translation that takes the stretch out through one of the tangents or over that line,
 * if the surface is there (`on_surface` is its point nearest to `ridge`), which then is an edge of
 * it; otherwise the depth of the middle. m, >= 0. */
double pl_edge_segment_depth(const pl_edge_segment *stretch, pl_vec ridge, pl_vec on_surface);

#endif
