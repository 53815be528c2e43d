/* The cheapest settings of an engine that meet targets on scenarios: the search, what it found
 * measured again, its sensitivities, and its judgement on scenarios that it was not tuned on. */
#ifndef PLUMB_TUNE_H
#define PLUMB_TUNE_H

#include "search_driver.h"
#include "space.h"
#include "tune_measure.h"

enum { PL_TUNE_REPEATS = 5, PL_TUNE_FINALISTS = 6 };

typedef struct pl_tune_def {
    const pl_plan *plan; /* the problems as asked for, and the seed, of the search too */
    double dt, duration; /* s: asked for of scene files; NAN: their own */
    const pl_tune_space *space;
    const pl_targets *targets;
    int budget; /* settings tried by the search; what is made after it is not counted */
    int jobs;
    pl_limits limits;
    json_t *provenance;
    FILE *progress; /* NULL: nowhere */
} pl_tune_def;

/* What the settings cost on a scenario, and how they meet the targets there. */
typedef struct pl_tune_score {
    double seconds, shipped_seconds; /* CPU time a simulated second, s: medians; NAN: none */
    double ratio;                    /* median of the repeats' ratios; NAN: none */
    pl_target_reading target, shipped_target;
    char outcome[32], shipped_outcome[32];
} pl_tune_score;

/* A parameter moved from the answer, the others where they are. */
typedef struct pl_tune_sensitivity {
    int parameter;
    double value;
    double cost; /* ratio to the answer's; NAN: none */
    double excess;
} pl_tune_sensitivity;

/* The answer on a scenario that it was not tuned on. */
typedef struct pl_tune_check {
    const char *variant;
    int problem;
    char outcome[32];
    pl_target_reading target;
} pl_tune_check;

typedef struct pl_tuning {
    /* Of a trial: it holds where the targets are met on all runs tuned on, and its excess is at
     * most 0 where they are with two standard deviations of ln(value / bound) to spare. */
    pl_search_result found;
    bool met;              /* `answer` meets the targets; else it is the nearest to them */
    bool has_margin;       /* with two standard deviations to spare */
    bool by_instructions;  /* what the search took as cost; else CPU time */
    bool shipped_has_cost; /* else costs are not ratios but seconds a simulated second */
    pl_evaluation best;
    pl_setting setting;    /* the answer's */
    double cost, worst;    /* ratio of CPU time to what is shipped, geometric mean; excess */
    pl_tune_score *scores; /* (problem_count of the plan) */
    pl_tune_sensitivity *sensitivities; /* (sensitivity_count) */
    int sensitivity_count;
    pl_tune_check *checks; /* (check_count): empty where nothing could be changed, or not met */
    int check_count, missed;
    int passed_over; /* finalists before the answer that missed a target in validation */
    long runs;
    int signal_number; /* that ended it; 0: none */
} pl_tuning;

/* Fills *tuning, which the caller frees in any case. PL_UNSUPPORTED: the engine does not do a
 * scenario. PL_NO_MEMORY, PL_IO, PL_BAD_INPUT. */
pl_status pl_tune(const pl_tune_def *def, pl_tuning *tuning, pl_error *error);
void pl_tuning_free(pl_tuning *tuning);

#endif
