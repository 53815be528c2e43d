/* Spheres, capsules, boxes and hulls, random or given. */
#ifndef PLUMB_TEST_POLYTOPES_H
#define PLUMB_TEST_POLYTOPES_H

#include "placed_shape.h"
#include "solid_forms.h"

/* Hulls, to be freed by release_hull. That of a form lies where the form does. */
placed_shape hull_of_form(const form *f);

/* A prism about z with n sides, up to 80, whose top is moved by `shear` along x. */
placed_shape hull_prism(int n, double radius, double half, double shear);

/* A box by its half extents. Its principal axes are those of the box in some order. */
placed_shape hull_box(double x, double y, double z);
void release_hull(placed_shape *b);

/* By half extents, radius and half height, m. */
placed_shape box_of(double x, double y, double z);
placed_shape capsule_of(double radius, double half);

enum { SOLID_SPHERE, SOLID_CAPSULE, SOLID_BOX, SOLID_HULL, SOLID_PRISM, SOLID_KINDS };

/* A shape of about 0.1 to 1.5 m. release_hull frees it, whatever its kind. */
placed_shape random_solid(check_random *random, int kind);

/* At most 1 m from the origin along each axis, turned at random. */
void place_at_random(placed_shape *b, check_random *random);

#endif
