/* Evaluates one setting of an engine: measures it on the scenarios, next to the default settings,
 * and derives its cost and its excess. */
#ifndef PLUMB_TUNER_H
#define PLUMB_TUNER_H

#include "tune.h"

/* Repeats of a setting that meets the targets, of which the first does not count. */
enum { PL_TUNER_REPEATS = 4 };

/* ---- Costs and excesses from readings ---- */

/* The median over the repeats from `first` to below `repeats` of the CPU time over that of `other`
 * in the same repeat; with `other` NULL, of the CPU time, in s per simulated second. NAN: none. */
double pl_score_ratio(const pl_reading *reading, const pl_reading *other, int first, int repeats);

/* The excesses of one scenario, as asked for and changed. */
typedef struct pl_spread {
    int count;
    double sum, squares;
} pl_spread;

/* Adds one excess, ln(value / bound). An excess below ln(1 / 20) counts as ln(1 / 20). */
void pl_spread_add(pl_spread *spread, double excess);

/* A bound that one more run is unlikely to exceed: the mean and two standard deviations. Runs that
 * meet the target by more than a factor of 20 count as 20, so that chance among them has no
 * effect. */
double pl_spread_likely(const pl_spread *spread);

/* ---- Measuring ---- */

/* The state of a tuning in progress. */
typedef struct pl_tuner {
    const pl_tune_def *def;
    pl_tuning *tuning;
    pl_progress bar;
    bool shows;
    pl_setting defaults;          /* the default settings */
    pl_spread *spreads;           /* (case_count): of the evaluation in progress */
    double *default_instructions; /* (case_count): per simulated second; NAN: not counted */
    double best_seconds; /* CPU time of the steps in the first runs of the best evaluation */
} pl_tuner;

/* What to measure. */
typedef struct pl_tuner_runs {
    const pl_setting *settings; /* (count) */
    int count;
    const pl_variant *variant; /* of the scenarios; NULL: as asked for */
    int first_repeat, repeats; /* the repeats [first_repeat, repeats); repeats = 0: one */
} pl_tuner_runs;

/* Measures settings on the scenarios, as pl_measure does. Runs that take much longer than those of
 * the best evaluation are cut short. */
pl_status pl_tuner_measure(pl_tuner *t, pl_tuner_runs runs, pl_readings *readings, pl_error *error);

/* The setting at a point of the space. */
pl_setting pl_tuner_setting(const pl_tuner *t, const double *values);

/* The geometric mean over the scenarios of the CPU time over that of the default settings, repeat
 * by repeat from `first` to below `repeats`; INFINITY where there is none. */
double pl_tuner_cost(const pl_tuner *t, const pl_reading *mine, const pl_reading *defaults,
                     int first, int repeats);

/* The largest excess over the scenarios. */
double pl_tuner_excess(const pl_tuner *t, const pl_reading *readings);

/* ---- Evaluations ---- */

/* Measures the default settings once. PL_UNSUPPORTED: the engine does not support a scenario. */
pl_status pl_evaluate_defaults(pl_tuner *t, pl_error *error);

/* Sets `excess` and `holds` from the readings `asked` of the scenarios as asked for, and from runs
 * of the scenarios as the variants change them, up to the first that misses a target. */
pl_status pl_evaluation_judge(pl_tuner *t, const pl_setting *setting, const pl_reading *asked,
                              pl_variants variants, pl_evaluation *evaluation, pl_error *error);

/* pl_search_def.measure, with a pl_tuner as `user`. */
pl_status pl_evaluation_make(void *user, pl_evaluation *evaluation, bool *stop, pl_error *error);

#endif
