/* The critical value of a scenario's parameter: the value at which the scene stops holding, found
 * by bisection on every engine. Every trial is an isolated run. All searches run side by side, one
 * trial of each in a round. */
#ifndef PLUMB_THRESHOLD_H
#define PLUMB_THRESHOLD_H

#include "runner/execute.h"

/* ---- Bisection, without an engine ---- */

/* Whether a bisection goes on, and how it ended. */
typedef enum pl_bisection_state {
    PL_BISECTION_SEARCHING,
    PL_BISECTION_FOUND,
    PL_BISECTION_NEVER_HOLDS,  /* at neither end of the bracket */
    PL_BISECTION_ALWAYS_HOLDS, /* at both ends */
    PL_BISECTION_REVERSED      /* only at the end where it should fail */
} pl_bisection_state;

/* A bisection for the value of a parameter at which a scene stops holding. */
typedef struct pl_bisection {
    double low, high; /* the bracket so far */
    double tolerance; /* of the bracket's width, > 0 */
    bool holds_below; /* the scene should hold at `low` and fail at `high`; else the reverse */
    bool either_side; /* both are right: the two ends set holds_below */
    int trials;
    bool low_holds; /* defined once trials > 0 */
    pl_bisection_state state;
} pl_bisection;

/* Begins a search in the bracket and with the tolerance of a threshold. */
pl_bisection pl_bisection_begin(const pl_threshold *threshold);

/* The value to try next: both ends first, then the midpoint of the bracket. Call it only while the
 * state is PL_BISECTION_SEARCHING. */
double pl_bisection_next(const pl_bisection *bisection);

/* Records whether the scene holds at the value that pl_bisection_next returned. */
void pl_bisection_take(pl_bisection *bisection, bool holds);

/* The most trials that a whole search takes. */
int pl_bisection_most_trials(const pl_bisection *bisection);

/* ---- Searches on engines ---- */

/* The search of one scenario on one engine. */
typedef struct pl_threshold_search {
    int test_case, configuration; /* indices in the plan */
    int param;                    /* index of the searched parameter in the scenario's */
    pl_bisection bisection;
    int runs;
    char outcome[32]; /* the run's outcome that ended the search, not ok and not collapsed, as in a
                         result; empty: no such outcome */
    char reason[512]; /* the reason of that outcome */
    char run[17];     /* hash of the trial in progress; empty: none */
} pl_threshold_search;

/* A study of thresholds. The pointers are borrowed. */
typedef struct pl_threshold_search_def {
    const pl_plan *plan; /* cases of the catalogue with a threshold */
    int jobs;            /* >= 1 */
    pl_limits limits;
    json_t *provenance;  /* pl_provenance */
    pl_journal *journal; /* of the trials; NULL: none */
    FILE *progress;      /* NULL: no progress is shown */
} pl_threshold_search_def;

/* Fills *searches, ordered by case and then by engine, as far as the search got. The caller
 * frees it in any case. A signal ends the search as in pl_execute. */
pl_status pl_find_thresholds(const pl_threshold_search_def *def, pl_threshold_search **searches,
                             int *count, int *signal_number, pl_error *error);

/* The search as plumb.threshold/1 (results/SCHEMA.md): a new reference, NULL when out of memory.
 * `started` is a time stamp. */
json_t *pl_threshold_json(const pl_plan *plan, const pl_threshold_search *search,
                          json_t *provenance, const char *started);

/* Prints all searches as tables, one per scenario. */
void pl_threshold_print(FILE *out, const pl_plan *plan, const pl_threshold_search *searches,
                        int count);

#endif
