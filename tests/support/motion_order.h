/* Of what order the engine's motion is, by its public interface alone. */
#ifndef PLUMB_TEST_MOTION_ORDER_H
#define PLUMB_TEST_MOTION_ORDER_H

#include "world_for_tests.h"

enum { STEP_SIZES = 4 };
static const double GRAVITY = 9.81; /* m/s^2 */

/* The k-th time step, s: 1/60, 1/120 .. 1/480. */
double order_step(int k);

/* Prints the errors and the order between neighbours, and returns that from the first to the last;
 * infinite where there is no error. */
double order_of(const char *name, const double error[STEP_SIZES]);

/* Fails below the order `least`. */
void assert_order(const char *name, const double error[STEP_SIZES], double least);

/* With the profile `accurate` and every bounce. */
pe_world *accurate_world(pe_vec3 gravity);

/* `count` steps of h, in s. */
void step_times(pe_world *world, double h, int count);

/* A body on a plane; the caller destroys the world. */
typedef struct on_plane {
    pe_world *world;
    pe_body_id body;
} on_plane;

/* `gravity` holds the slope; the plane is z = 0. */
on_plane put_on_plane(pe_vec3 gravity, double friction, double restitution, pe_body_def def);

/* By the angle, in rad, that the plane falls towards x. */
pe_vec3 slope_gravity(double angle);

/* At that height over the origin. */
pe_body_def sphere_def(double radius, double height);

#endif
