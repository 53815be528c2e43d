/* The search for the critical value of every scenario on every engine: each trial is an isolated
 * run, and all searches go on side by side, one trial each in a round. */
#ifndef PLUMB_SEARCH_H
#define PLUMB_SEARCH_H

#include "bisection.h"
#include "runner/execute.h"

/* One scenario on one engine. */
typedef struct pl_threshold_search {
    int problem, contender; /* indices in the plan */
    int param;              /* index of the searched parameter in the scenario's */
    pl_bisection bisection;
    int runs;
    /* The outcome that ended the search, but for ok and collapsed, as in a result, and its reason;
     * empty: none did. */
    char outcome[32];
    char reason[512];
    char run[17]; /* hash of the trial in progress; empty: none */
    double value; /* of that trial */
} pl_threshold_search;

typedef struct pl_threshold_search_def {
    const pl_plan *plan; /* problems of the catalogue with a threshold */
    int jobs;            /* >= 1 */
    pl_limits limits;
    json_t *provenance; /* pl_provenance */
    FILE *progress;     /* NULL: nowhere */
} pl_threshold_search_def;

/* The scenario's index of its threshold's parameter. */
int pl_threshold_param(const pl_scenario *scenario);

/* Fills *searches, problem by problem and in each engine by engine, as far as the search came; the
 * caller frees it. A signal ends it as in pl_execute. */
pl_status pl_find_thresholds(const pl_threshold_search_def *def, pl_threshold_search **searches,
                             int *count, int *signal_number, pl_error *error);

/* "found", "never holds", "always holds", "reversed", the outcome that ended it, or "searching". */
const char *pl_threshold_outcome(const pl_threshold_search *search);

/* The closed form for the problem's parameters; NAN: there is none. */
double pl_threshold_critical(const pl_plan *plan, const pl_threshold_search *search);

#endif
