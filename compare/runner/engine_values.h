/* Checks of the values that an engine says. Before a run: it must simulate the masses, inertias, gravity, time step,
 * friction and restitution of the scene, without damping; they are read back from the engine. In each step: a run in
 * which it reports a value that cannot be ends, with the value, the field and the step as its reason, because every
 * metric of it would be in doubt. */
#ifndef PLUMB_ENGINE_VALUES_H
#define PLUMB_ENGINE_VALUES_H

#include "plumb/contact_times.h"
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

/* Checks the statistics of a step: each is NAN (unknown), or finite and at least 0, and a count
 * at most 1e12. PL_FAILED. */
pl_status pl_check_stats(const pl_step_stats *stats, long step, pl_error *error);

/* Checks `count` contacts of a step, of an engine that reports the PL_CONTACTS_* bits `reported`:
 * two different bodies of the scene, finite numbers, and normals of unit length to 1e-3.
 * PL_FAILED. */
pl_status pl_check_contacts(const pl_contact *contacts, int count, uint32_t reported,
                            int body_count, long step, pl_error *error);

/* PL_FAILED: a time outside the step, or a number that is not finite. `dt`: of the step, s. */
pl_status pl_check_contact_times(const pl_contact_time *times, int count, double dt, long step,
                                 pl_error *error);

#endif
