/* Streaming statistics of one number: mean, largest, where the largest was, and percentiles.
 *
 * Percentiles come from a histogram with 128 bins an octave over 2^-80 .. 2^48 (and one bin below,
 * one above), by nearest rank. Each is the mean of the numbers in its bin, so that it is off by
 * less than 1/128 = 0.8 %, and exact where all numbers of the bin are equal, as small whole numbers
 * are. */
#ifndef PLUMB_SERIES_H
#define PLUMB_SERIES_H

#include "metrics.h"

#include <stdint.h>

typedef struct pl_bin {
    uint64_t count;
    double sum;
} pl_bin;

typedef struct pl_series {
    pl_bin
        *bins; /* (PL_SERIES_BINS), owned by the series; pages of unused bins are never touched */
    uint64_t count;
    double sum, square_sum, max;
    long worst_step; /* the first step at which max was seen; 0 before any */
} pl_series;

enum { PL_SERIES_OCTAVE = 128, PL_SERIES_BINS = 128 * PL_SERIES_OCTAVE + 2 };

/* False when out of memory. */
bool pl_series_init(pl_series *series);
void pl_series_free(pl_series *series);

/* Counts `value` >= 0 (infinity allowed; a NaN is "not reported" and counts nothing) seen at
 * `step`. */
void pl_series_add(pl_series *series, double value, long step);

/* The smallest number that at least the fraction `q` of all do not exceed; 0 of an empty series. */
double pl_series_percentile(const pl_series *series, double q);

double pl_series_mean(const pl_series *series);

/* Root of the mean of the squares. */
double pl_series_rms(const pl_series *series);

/* A metric with `value`, and the series' percentiles and worst step. A value that is not finite
 * makes it PL_METRIC_FAILED and says so. */
pl_metric pl_series_metric(const pl_series *series, double value);

#endif
