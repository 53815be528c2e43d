/* Checks before a run: the engine must support what the scene needs, and must simulate the masses,
 * inertias, gravity, time step, friction and restitution of the scene. They are read back from the
 * engine. */
#ifndef PLUMB_PARAMETER_CHECK_H
#define PLUMB_PARAMETER_CHECK_H

#include "plumb/engine_abi.h"

/* Compares the engine's own masses, principal inertias (in any order), gravity, step, and the
 * friction and restitution of every pair of materials that two bodies can bring together, with the
 * scene's, to 1e-12 relative. PL_UNSUPPORTED names the first that differs with both numbers. */
pl_status pl_parameter_check(const pl_scene *scene, const pl_engine *engine,
                             const pl_engine_instance *instance, pl_error *error);

/* Compares what the scene needs with what the engine supports. PL_UNSUPPORTED names what is
 * missing. */
pl_status pl_needs_check(const pl_scene *scene, const pl_engine *engine, pl_error *error);

#endif
