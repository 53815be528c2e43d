/* Values that an engine may not report: a run that has one ends, with the value, the field and the
 * step as its reason, because every metric of it would be in doubt. */
#ifndef PLUMB_REPORTED_VALUES_H
#define PLUMB_REPORTED_VALUES_H

#include "plumb/contact_times.h"

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
