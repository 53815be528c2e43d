/* The metric iterations_to_tolerance of every scenario on every engine of a plan: the least budget
 * of solver iterations whose error is as good as the converged one. It is searched by isolated runs
 * with other values of the engine's option `iterations`. */
#ifndef PLUMB_ITERATIONS_TO_TOLERANCE_H
#define PLUMB_ITERATIONS_TO_TOLERANCE_H

#include "referee/metrics/metrics.h"
#include "runner/execute.h"

/* ---- The search for a budget, without an engine ---- */

/* The outcome of a trial with a budget. */
typedef enum pl_budget_trial {
    PL_BUDGET_SUCCEEDED, /* it has an error */
    PL_BUDGET_FAILED,    /* it has no valid error, but a larger budget may have one */
    PL_BUDGET_END_SEARCH /* it has no valid error, and the search ends */
} pl_budget_trial;

/* A search for the least budget whose error is as good as the converged one. */
typedef struct pl_budget_search_def {
    long least, most; /* 1 <= least <= most: budgets are least 2^k up to most, and those between */
    double floor;     /* >= 0: errors that differ by no more are equal */
    void *user;
    /* Sets *error to the budget's error, finite and >= 0, where the trial succeeded. No budget is
     * tried twice. A status other than PL_OK ends the search with that status. */
    pl_status (*try_budget)(void *user, long budget, pl_budget_trial *trial, double *error,
                            pl_error *fault);
} pl_budget_search_def;

/* How a budget search ended. */
typedef enum pl_budget_state {
    PL_BUDGET_FOUND,
    PL_BUDGET_ALL_FAILED,     /* all budgets that were tried */
    PL_BUDGET_LARGEST_FAILED, /* there is no converged error, though smaller budgets succeeded */
    PL_BUDGET_STOPPED         /* by PL_BUDGET_END_SEARCH */
} pl_budget_state;

/* The result of a budget search. */
typedef struct pl_budget_found {
    pl_budget_state state;
    long budget;      /* the least budget; 0 unless found */
    long largest;     /* the last doubling */
    double converged; /* its error; NAN: none */
    int trials;
} pl_budget_found;

/* Doubles the budget until two doublings in a row changed the error by at most 1 %, or up to
 * `most`; the last error counts as converged. Then bisects for the least budget with an error of at
 * most 1.1 times that, where the next doubling above it, if tried, also has such an error. */
pl_status pl_budget_search(const pl_budget_search_def *def, pl_budget_found *found,
                           pl_error *fault);

/* The most trials that a search takes. */
int pl_budget_most_trials(long least, long most);

/* ---- The metric ---- */

/* The runs to search the least number of iterations for. The pointers are borrowed. */
typedef struct pl_tolerance_def {
    const pl_plan *plan;
    pl_limits limits; /* of each run */
    json_t *provenance;
    pl_store *store;  /* of the runs; NULL: none */
    pl_progress *bar; /* counts these runs, which its total includes; NULL: none */
    void *user;
    /* Whether this run has a result already, as in pl_execution_def. A scenario and engine whose
     * runs all have one need no search. NULL: no run has one. */
    bool (*skip)(void *user, const char *run);
} pl_tolerance_def;

/* The most runs that all searches take. PL_NO_MEMORY. */
pl_status pl_tolerance_most_runs(const pl_tolerance_def *def, long *runs, pl_error *error);

/* Fills *metrics with one metric per case and engine, at test_case x configuration_count +
 * configuration; the caller frees it in any case. A metric is absent where the engine has no option
 * `iterations` or its profile refuses it, where the scene has no primary error, and where no search
 * was needed. A signal ends the search as in pl_execute. */
pl_status pl_tolerance_search(const pl_tolerance_def *def, pl_metric **metrics, int *signal_number,
                              pl_error *error);

/* Adds the metric of the result's scenario and engine to its metrics, unless it is absent. */
void pl_tolerance_put(const pl_plan *plan, const pl_metric *metrics, json_t *result);

#endif
