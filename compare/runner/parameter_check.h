/* A check before a run: the engine must simulate the masses, inertias, gravity, time step, friction
 * and restitution of the scene, without damping. They are read back from the engine. */
#ifndef PLUMB_PARAMETER_CHECK_H
#define PLUMB_PARAMETER_CHECK_H

#include "results/result.h"
#include "session.h"

/* Compares the engine's own masses, principal inertias (in any order), gravity, step, damping, and
 * the friction and restitution of every pair of materials that two bodies can bring together, with
 * the scene's: to 1e-12 relative, or to 16 units in the last place of a float where the engine
 * computes with floats. What the engine does not read back is not compared. *compared has a bit
 * 1 << pl_read_back for each kind of number that was, and *substeps the engine's sub-steps a step.
 * PL_UNSUPPORTED names the first number that differs, with both values. */
pl_status pl_parameter_check(pl_session *session, const pl_scene *scene, unsigned *compared,
                             int *substeps, pl_error *error);

#endif
