/* Fairness by reading back: what the engine says it simulates must be what the scene says. */
#ifndef PLUMB_READBACK_H
#define PLUMB_READBACK_H

#include "plumb/engine_abi.h"

/* Compares the engine's own masses, principal inertias (in any order), gravity, step, and the
 * friction and restitution of every pair of materials that two bodies can bring together, with the
 * scene's, to 1e-12 relative. PL_UNSUPPORTED names the first that differs with both numbers. */
pl_status pl_parameter_check(const pl_scene *scene, const pl_engine *engine,
                             const pl_engine_instance *instance, pl_error *error);

/* PL_UNSUPPORTED names what the scene needs and the engine lacks. */
pl_status pl_needs_check(const pl_scene *scene, const pl_engine *engine, pl_error *error);

#endif
