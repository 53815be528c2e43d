/* Finds the cheapest settings of an engine that meet targets on scenarios: it searches, measures
 * the best points again, varies each parameter of the best, and validates it on scenarios that the
 * search did not use. */
#ifndef PLUMB_TUNE_H
#define PLUMB_TUNE_H

#include "runner/execute.h"
#include "studies/study.h"
#include "studies/tunable.h"
#include "tune_search.h"

/* ---- Targets: METRIC<=VALUE or METRIC<VALUE ---- */

enum { PL_TUNE_MOST_TARGETS = 8 };

/* An upper bound on a metric. */
typedef struct pl_target {
    int metric;   /* pl_metric_id */
    double bound; /* > 0, in the metric's unit */
    bool strict;  /* < */
} pl_target;

/* The bounds that all runs of a setting must keep. */
typedef struct pl_targets {
    pl_target items[PL_TUNE_MOST_TARGETS];
    int count;
} pl_targets;

/* Parses a target and adds it. PL_BAD_INPUT: an unknown metric (the message suggests the nearest),
 * a metric that is better when higher, another comparison, a bound that is not positive, or too
 * many targets. */
pl_status pl_target_add(pl_targets *targets, const char *text, pl_error *error);

/* The target as pl_target_add reads it. */
void pl_target_text(const pl_target *target, char text[96]);

/* The largest ln(value / bound) of a plumb.result/1 over the targets: they are met if it is <= 0. It is at most
 * PL_SEARCH_WORST, the excess of a missing value or result (NULL). It is larger where the run's outcome is
 * not ok. */
double pl_targets_excess(const pl_targets *targets, const json_t *result);

/* The values of the targets' metrics of a result, by their names: null where one is missing. A new reference. */
json_t *pl_targets_values(const pl_targets *targets, const json_t *result);

/* ---- Parameters: an engine's tunable options, which the user can restrict and extend, and the time step ---- */

/* The parameters of a search, and the values of what is not searched. */
typedef struct pl_tune_space {
    pl_engine_choice base; /* the values of all options that are not tuned */
    double dt;             /* s: the time step where "dt" is not tuned; NAN: it is tuned */
    pl_tune_parameter parameters[PL_TUNE_MAX_PARAMETERS];
    int parameter_count;
} pl_tune_space;

/* What a user asks for. */
typedef struct pl_tune_request {
    const pl_engine_choice *engine; /* options that differ from their defaults are not tuned */
    double dt;                      /* s: where "dt" begins; NAN: 1/60 s */
    const char *const *varied;      /* (varied_count): KEY=LOW..HIGH of an option or "dt" */
    int varied_count;
    const char *const *fixed; /* (fixed_count): KEY=VALUE */
    int fixed_count;
} pl_tune_request;

/* Makes the space. Numbers may be fractions. PL_BAD_INPUT: an unknown key (the message suggests the
 * nearest), a value out of the option's range, an empty range, a key given twice, a command
 * that is too long for a SPEC with all options. */
pl_status pl_tune_space_make(const pl_tune_request *request, pl_tune_space *space, pl_error *error);

/* The values of a point as a user writes them, of "dt" in s: an array. A new reference. */
json_t *pl_tune_values(const pl_tune_space *space, const double *values);

/* The engine and its time step with such values. */
pl_setting pl_tune_setting(const pl_tune_space *space, const json_t *values);

/* ---- The study ---- */

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
