/* The critical value of a scenario's parameter: the value at which the scene stops holding, found
 * by bisection on every engine. Every trial is an isolated run. All searches run side by side, one
 * trial of each in a round. */
#ifndef PLUMB_THRESHOLD_H
#define PLUMB_THRESHOLD_H

#include "runner/execute.h"
#include "studies/study.h"

/* What the trials of a search say of it, for pl_case.study: {"name": "threshold", "param", "unit", "low", "high",
 * "tolerance", "holds_below", "either_side", "closed_form", "formula"}. `params` are those of the case. A new
 * reference. */
json_t *pl_threshold_study_of(const pl_scenario *scenario, const pl_threshold *threshold,
                              const double *params);

/* Makes the trials of all searches: of each case of how->plan that has a `study`, on each configuration. A signal ends
 * the search as in pl_execute. */
pl_status pl_threshold_run(const pl_execution_def *how, int *signal_number, pl_error *error);

/* The study: its conclusion is an array of plumb.threshold/1 (results/SCHEMA.md). */
extern const pl_study pl_threshold_study;

#endif
