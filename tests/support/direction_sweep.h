/* The signed distance of two convex shapes by a dense sweep over directions, which knows no
 * features. */
#ifndef PLUMB_TEST_DIRECTION_SWEEP_H
#define PLUMB_TEST_DIRECTION_SWEEP_H

#include "placed_shape.h"

/* The extent (m) of a sphere, box, capsule or cylinder from its centre along the direction d. */
double reach_along(const placed_shape *b, pe_vec3 d);

/* The separation (m) of such shapes along the unit direction d, from a to b. */
double separation_along(const placed_shape *a, const placed_shape *b, pe_vec3 d);

/* The largest separation found over all directions: a lower bound of the signed distance, and near
 * it. */
double swept_distance(const placed_shape *a, const placed_shape *b);

#endif
