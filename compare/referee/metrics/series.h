/* Streaming statistics of a number that is seen once a step or more often: mean, largest value, the
 * step of the largest value, and percentiles.
 *
 * Percentiles are by nearest rank, from a histogram with 128 bins an octave over 2^-80 .. 2^48, one
 * bin below and one above. A percentile is the mean of the numbers in its bin. Its error is below
 * 1/128 = 0.8 %, and zero where all numbers in the bin are equal, as small whole numbers are. */
#ifndef PLUMB_SERIES_H
#define PLUMB_SERIES_H

#include "base/arena.h"
#include "metrics.h"

#include <math.h>
#include <stdint.h>

/* A bin of the histogram: how many numbers fell into it, and their sum. */
typedef struct pl_bin {
    uint64_t count;
    double sum;
} pl_bin;

/* A histogram of the values of one metric over the steps, with their sums and maximum. */
typedef struct pl_series {
    pl_bin *bins; /* (PL_SERIES_BINS), of the arena */
    uint64_t count;
    double sum, square_sum, max;
    long worst_step; /* the first step at which max was seen; 0 before any */
    bool applies;    /* its metric has a value, 0, even if none was seen */
} pl_series;

enum { PL_SERIES_BINS = 128 * 128 + 2 }; /* 128 octaves, and the two outer bins */

/* Makes an empty series, with its bins from the arena. */
void pl_series_init(pl_series *series, pl_arena *arena);

/* Adds `value` >= 0, which may be infinite, seen at `step`. A NaN means "not reported" and is not
 * added. */
void pl_series_add(pl_series *series, double value, long step);

/* `value`, or infinity for a NaN that the referee itself computed: a series would take it for "not
 * reported". */
static inline double pl_or_infinity(double value)
{
    return isnan(value) ? HUGE_VAL : value;
}

/* The smallest number that at least the fraction `q` of all numbers do not exceed; 0 of an empty
 * series. */
double pl_series_percentile(const pl_series *series, double q);

/* The metric of a series with these traits: the maximum, mean or root of the mean square, 0 of an empty
 * series, with percentiles and worst step. PL_METRIC_FAILED when it is not finite. */
pl_metric pl_series_metric(const pl_series *series, unsigned traits);

#endif
