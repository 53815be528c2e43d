/* The scene's forces as a step sees them. */
#ifndef PLUMB_LOADS_H
#define PLUMB_LOADS_H

#include "integrator.h"
#include "plumb/engine_abi.h"
#include "plumb/vec.h"

/* Nodes of Simpson's rule over a step: its start, its middle and its end. */
enum { PL_LOAD_NODES = 3 };
extern const double pl_load_weights[PL_LOAD_NODES];

/* Whether the force acts in step number `step` (from 1) of length dt, s. */
bool pl_load_acts(const pl_force *force, long step, double dt);

/* The frame of the body at a node of a step of dt seconds between two states. */
pl_axes pl_load_axes(const pl_body_state *before, const pl_body_state *after, double dt, int node);

/* The force's impulse on its body over a step of dt seconds, N s, world. One in the body's frame
 * turns within the step where the engine is of second order, and keeps the direction of the start
 * where it is not. */
pl_vec pl_load_impulse(const pl_force *force, pl_integrator integrator, const pl_body_state *before,
                       const pl_body_state *after, double dt);

#endif
