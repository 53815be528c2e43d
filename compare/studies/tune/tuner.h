/* What the parts of tuning share: the scenarios as asked for, how settings are measured on them,
 * and what a measurement says. */
#ifndef PLUMB_TUNE_TUNER_H
#define PLUMB_TUNE_TUNER_H

#include "score.h"

/* Repeats of a setting that meets the targets, of which the first does not count. */
enum { PL_TUNER_REPEATS = 4 };

typedef struct pl_tuner {
    const pl_tune_def *def;
    pl_tuning *tuning;
    pl_progress bar;
    bool shows;
    pl_setting shipped;
    pl_spread *spreads;           /* (problem_count): of the trial in progress */
    double *shipped_instructions; /* (problem_count): per simulated second; NAN: not counted */
    double best_seconds;          /* wall time of the first runs of the best trial */
} pl_tuner;

/* Settings on the scenarios as `variant` changes them, as pl_measure does it; the repeats below
 * first_repeat have been made. What takes many times as long as the best trial is cut short. */
pl_status pl_tuner_measure(pl_tuner *t, const pl_variant *variant, const pl_setting *settings,
                           int count, int first_repeat, int repeats, pl_readings *readings,
                           pl_error *error);

/* The setting at a point of the space. */
pl_setting pl_tuner_setting(const pl_tuner *t, const double *values);

/* By the CPU time beside that of what is shipped, repeat by repeat, from `first` to below
 * `repeats`, or by instructions: geometric means over the scenarios; INFINITY where there is none.
 */
double pl_tuner_cost(const pl_tuner *t, const pl_reading *mine, const pl_reading *shipped,
                     int first, int repeats);
double pl_tuner_instructions(const pl_tuner *t, const pl_reading *mine);

/* The largest over the scenarios. */
double pl_tuner_excess(const pl_tuner *t, const pl_reading *readings);

/* Whether a cost may turn out to be the lower one when both are measured again. */
bool pl_tuner_is_near(double cost, double best);

#endif
