/* What a sweep varies when nothing is said: the time step, and how long engines iterate. */
#ifndef PLUMB_SWEEP_USUAL_H
#define PLUMB_SWEEP_USUAL_H

#include "runner/plan.h"
#include "vary.h"

enum { PL_SWEEP_DEFAULT_REPEATS = 3, PL_SWEEP_DEFAULT_TIMEOUT = 20 /* s */ };

/* The steps 1/60 to 1/960 s by halves, and of each engine of the plan that is shipped with so many
 * `iterations` these and five times as many. *varied is malloc'd, and freed, with what is in it, by
 * the caller, also on failure. */
pl_status pl_default_vary(const pl_plan *plan, pl_vary **varied, int *count, pl_error *error);

#endif
