/* The forces of a scene within a step, which may turn with their bodies. */
#ifndef PLUMB_APPLIED_FORCE_H
#define PLUMB_APPLIED_FORCE_H

#include "integrator.h"

/* Simpson's rule over a step: the start, the midpoint and the end. */
enum { PL_NODES = 3 };
extern const double pl_node_times[PL_NODES]; /* of the step */
extern const double pl_node_weights[PL_NODES];

/* Whether the force acts in step number `step` (from 1) of length dt, s. */
bool pl_applied_force_acts(const pl_force *force, long step, double dt);

/* A force at a node of a step, in the world frame. */
typedef struct pl_applied_force {
    pl_vec impulse; /* over the whole step, N s */
    pl_vec arm;     /* m */
} pl_applied_force;

/* The force at a node of a step of dt seconds. */
pl_applied_force pl_applied_force_at(const pl_force *force, const pl_body_state *before,
                                     const pl_body_state *after, double dt, int node);

/* The force's impulse on its body over a step of dt seconds, N s, world frame. A force in the
 * body's frame turns within the step of a second-order integrator, and keeps the direction of the
 * start in a step of semi-implicit Euler. */
pl_vec pl_applied_force_impulse(const pl_force *force, pl_position_rule integrator,
                                const pl_body_state *before, const pl_body_state *after, double dt);

#endif
