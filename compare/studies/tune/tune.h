/* Finds the cheapest settings of an engine that meet targets on scenarios: it searches, measures
 * the best points again, varies each parameter of the best, and validates it on scenarios that the
 * search did not use. */
#ifndef PLUMB_TUNE_H
#define PLUMB_TUNE_H

#include "runner/execute.h"
#include "space.h"
#include "studies/study.h"
#include "target.h"
#include "tune_search.h"

/* What to tune, and on which cases. All pointers are borrowed. */
typedef struct pl_tune_def {
    const pl_plan *plan; /* the cases as asked for, and the seed, of the search too */
    const pl_tune_space *space;
    const pl_targets *targets;
    int budget; /* settings that the search evaluates; what is measured afterwards is not counted */
} pl_tune_def;

/* Makes all runs of a tuning. `how` has everything but the plan. A signal ends them as in pl_execute. PL_UNSUPPORTED:
 * the engine does not support a scenario. PL_BAD_INPUT: the store has runs of another tuning. */
pl_status pl_tune_run(const pl_tune_def *def, const pl_execution_def *how, int *signal_number,
                      pl_error *error);

/* The study: its conclusion is a plumb.tuning/1 (SCHEMA.md). If the runs are of several builds
 * of the engine, it is of the build of the last run. */
extern const pl_study pl_tune_study;

/* plumb.profile/1 of a conclusion, as pl_engine_choose reads it. A new reference. */
json_t *pl_tune_profile(const json_t *conclusion);

#endif
