/* Spheres, capsules, boxes and hulls, made at random or by hand. */
#ifndef PLUMB_TEST_POLYTOPES_H
#define PLUMB_TEST_POLYTOPES_H

#include "placed_shape.h"

/* A hull that release_hull frees: a prism about z with n sides, up to 80, or, with the top moved,
 * something skew. */
placed_shape hull_prism(int n, double radius, double half, double shear);

/* The box of these half extents as a hull, whose principal axes are those of the box in some order.
 */
placed_shape hull_box(double x, double y, double z);
void release_hull(placed_shape *b);

/* By half extents, radius and half height, m. */
placed_shape box_of(double x, double y, double z);
placed_shape capsule_of(double radius, double half);

enum { SOLID_SPHERE, SOLID_CAPSULE, SOLID_BOX, SOLID_HULL, SOLID_PRISM, SOLID_KINDS };

/* Of sizes from 0.1 to 1.5 m or so; release_hull frees it, whatever its kind. */
placed_shape random_solid(check_random *random, int kind);

/* Up to 1 m from the origin along each axis. */
void place_at_random(placed_shape *b, check_random *random);

#endif
