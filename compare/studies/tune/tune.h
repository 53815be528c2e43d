/* Finds the cheapest settings of an engine that meet targets on scenarios: it searches, measures
 * the best points again, varies each parameter of the best, and validates it on scenarios that the
 * search did not use. */
#ifndef PLUMB_TUNE_H
#define PLUMB_TUNE_H

#include "space.h"
#include "tune_measure.h"
#include "tune_search.h"

/* What to tune, on which cases, and within which limits. All pointers are borrowed. */
typedef struct pl_tune_def {
    const pl_plan *plan; /* the cases as asked for, and the seed, of the search too */
    const pl_tune_space *space;
    const pl_targets *targets;
    int budget; /* settings that the search evaluates; what is measured afterwards is not counted */
    int jobs;
    pl_limits limits;
    json_t *provenance;
    pl_store *store; /* of the runs; NULL: none */
    FILE *progress;  /* NULL: no progress is shown */
} pl_tune_def;

/* The cost of the best point on a scenario and its targets there, next to the default settings. */
typedef struct pl_tune_score {
    double seconds, default_seconds; /* CPU time per simulated second, s: medians; NAN: none */
    double ratio;                    /* median of the repeats' ratios; NAN: none */
    pl_target_reading target, default_target;
    char outcome[32], default_outcome[32];
} pl_tune_score;

/* One parameter moved from the best point, the others unchanged. */
typedef struct pl_tune_sensitivity {
    int parameter;
    double value;
    double cost; /* ratio to the best point's; NAN: none */
    double excess;
} pl_tune_sensitivity;

/* The best point on a scenario that the search did not use. */
typedef struct pl_tune_check {
    const char *variant;
    int test_case;
    char outcome[32];
    pl_target_reading target;
} pl_tune_check;

/* The result of tuning one engine profile. */
typedef struct pl_tuning {
    /* An evaluation holds where the targets are met on all runs that it was judged by. Its excess
     * is at most 0 where they are met by two standard deviations of ln(value / bound). */
    pl_search_result found;
    bool met;              /* `best` meets the targets; else it is the point nearest to them */
    bool has_margin;       /* with two standard deviations to spare */
    bool by_instructions;  /* the search measured cost in instructions; else in CPU time */
    bool default_has_cost; /* else costs are not ratios but seconds per simulated second */
    pl_evaluation best;
    pl_setting setting;    /* of the best point */
    double cost, worst;    /* ratio of CPU time to the default settings', geometric mean; excess */
    pl_tune_score *scores; /* (case_count of the plan) */
    pl_tune_sensitivity *sensitivities; /* (sensitivity_count) */
    int sensitivity_count;
    pl_tune_check *checks; /* (check_count): empty where nothing could be changed, or not met */
    int check_count, missed;
    int passed_over; /* finalists before the best point that missed a target in validation */
    long runs;
    int signal_number; /* that ended the study; 0: none */
} pl_tuning;

/* Fills *tuning, which the caller frees in any case. PL_UNSUPPORTED: the engine does not support a
 * scenario. PL_NO_MEMORY, PL_IO, PL_BAD_INPUT. */
pl_status pl_tune(const pl_tune_def *def, pl_tuning *tuning, pl_error *error);

/* Frees the arrays of the result. */
void pl_tuning_free(pl_tuning *tuning);

/* Prints the settings as a SPEC and in the engine's own API, their costs and their verdicts. */
void pl_tune_print(FILE *stream, const pl_tune_def *def, const pl_tuning *tuning);

/* plumb.tuning/1 (SCHEMA.md), with all evaluations; NULL when out of memory. */
json_t *pl_tune_json(const pl_tune_def *def, const pl_tuning *tuning);

/* plumb.profile/1, as pl_engine_choose reads it; NULL when out of memory. */
json_t *pl_tune_profile(const pl_tune_def *def, const pl_tuning *tuning);

#endif
