/* Runs that need not be made to be known to end at the time limit: what ran into it at one time
 * step takes longer at a shorter one. */
#ifndef PLUMB_SWEEP_HOPELESS_H
#define PLUMB_SWEEP_HOPELESS_H

#include "runner/plan.h"

#include <jansson.h>

/* Where `result` timed out, gives `keep` a result of the outcome `timeout` for the first run of
 * each point of the plan that has a shorter step and is else the same, whose reason says that it
 * was not run. `keep` borrows it; anything but PL_OK ends it with that. PL_NO_MEMORY. */
pl_status pl_prune_timeouts(const pl_plan *plan, const json_t *result, json_t *provenance,
                            void *user,
                            pl_status (*keep)(void *user, json_t *result, pl_error *error),
                            pl_error *error);

#endif
