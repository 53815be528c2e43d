/* Costs from readings: medians of repeats, and of ratios repeat by repeat. */
#ifndef PLUMB_TUNE_SCORE_H
#define PLUMB_TUNE_SCORE_H

#include "tune.h"

/* The median over the repeats from `first` to below `repeats` of the CPU time over the other's in
 * the same repeat; with `other` NULL, of the CPU time itself, s a simulated second. NAN: none. */
double pl_score_ratio(const pl_reading *reading, const pl_reading *other, int first, int repeats);

/* The geometric mean of that, or of the first repeat's instructions, over the problems. */
double pl_score_mean_ratio(const pl_reading *readings, const pl_reading *others, int problem_count,
                           int repeats, bool by_instructions);

pl_tune_score pl_score_of(const pl_reading *reading, const pl_reading *shipped, int repeats);

/* Excesses of a scenario as asked for and changed. */
typedef struct pl_spread {
    int count;
    double sum, squares;
} pl_spread;

void pl_spread_add(pl_spread *spread, double excess);

/* What one more run is likely not to exceed: the mean and two standard deviations. Runs that meet
 * the target with much to spare count as if by a factor of 20, so that chance among them does not
 * matter. */
double pl_spread_likely(const pl_spread *spread);

#endif
