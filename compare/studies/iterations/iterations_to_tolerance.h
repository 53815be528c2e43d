/* The metric iterations_to_tolerance of every scenario on every engine of a plan: searched by
 * isolated runs with other values of the engine's own option `iterations`. */
#ifndef PLUMB_ITERATIONS_TO_TOLERANCE_H
#define PLUMB_ITERATIONS_TO_TOLERANCE_H

#include "referee/metrics/metrics.h"
#include "runner/execute.h"
#include "runner/progress.h"

enum { PL_MOST_ITERATIONS = 1024 };

typedef struct pl_tolerance_def {
    const pl_plan *plan;
    pl_limits limits; /* of each run */
    json_t *provenance;
    pl_progress *bar; /* counts the runs too; its total has them already; NULL: none */
    void *user;
    /* Whether this run's result is there already, as in pl_execution_def: a scenario and engine of
     * which all are need no search. NULL: none is. */
    bool (*skip)(void *user, const char *run);
} pl_tolerance_def;

/* Runs that all searches take, at most. PL_NO_MEMORY. */
pl_status pl_tolerance_most_runs(const pl_tolerance_def *def, long *runs, pl_error *error);

/* *metrics gets one metric for each problem and configuration, at problem x configuration_count +
 * configuration; the caller frees it, in any case. A metric is absent where the engine has no
 * option `iterations` or its profile refuses it, where the scene has no primary error, and where no
 * search was needed. A signal ends it as in pl_execute. */
pl_status pl_tolerance_search(const pl_tolerance_def *def, pl_metric **metrics, int *signal_number,
                              pl_error *error);

/* Puts the metric of the result's scenario and engine into its metrics, unless it is absent. */
pl_status pl_tolerance_put(const pl_plan *plan, const pl_metric *metrics, json_t *result,
                           pl_error *error);

#endif
