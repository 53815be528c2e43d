/* The velocities that each contact left, where an engine says when its contacts acted.
 *
 * From the state before the step on, the momenta of each body follow from gravity and from the
 * reported impulses in their order. An impulse over an interval [b, e] leaves
 *
 *   v = v_b + (e - b) g + J/m,    w = w_free + I_b^-1 sum r x J,
 *
 * where w_free is what free rotation makes of w_b by e, and I_b the inertia in the axes of b: the
 * velocities of time stepping (Moreau 1988; Jean 1999), which the contact law is imposed on. Then
 * the body rotates, and keeps its angular momentum. What is left to the velocities that the engine
 * reports at the step's end, by applied forces, position correction or errors, is added to those of
 * the last interval. */
#ifndef PLUMB_CONTACT_MOTION_H
#define PLUMB_CONTACT_MOTION_H

#include "mechanics.h"

#include <stdbool.h>

/* Memory for one step of all bodies. */
typedef struct pl_contact_motion pl_contact_motion;

/* `scene` and `arena` must outlive it. Memory of the arena. */
pl_contact_motion *pl_contact_motion_create(const pl_scene *scene, pl_arena *arena);

/* Takes a step whose contacts have times, and follows its bodies. */
void pl_contact_motion_step(pl_contact_motion *motion, const pl_step *step);

/* Velocities of B's point relative to A's, m/s, world. */
typedef struct pl_contact_velocity {
    pl_vec left; /* at the end of the interval, where the contact law holds */
    pl_vec mean; /* of its begin and its end, where the impulse acted */
} pl_contact_velocity;

/* Those of contact i of the step. */
pl_contact_velocity pl_contact_motion_velocity(const pl_contact_motion *motion, const pl_step *step,
                                               int i);

#endif
