/* A logarithmic histogram whose bin is read off the bits of the number: the exponent and the
 * leading seven bits of the mantissa of an IEEE 754 double, with no logarithm and no rounding.
 * Source: the idea is that of HdrHistogram (Tene 2012). */
#include "series.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double LEAST = 0x1p-80; /* lower end of the first octave */

/* 52 mantissa bits less the seven that count. */
enum { DROPPED_BITS = 45 };

static uint64_t leading_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits >> DROPPED_BITS;
}

static int bin_of(double value)
{
    if (!(value >= LEAST)) {
        return 0;
    }
    uint64_t index = leading_bits(value) - leading_bits(LEAST) + 1;
    return index < PL_SERIES_BINS - 1 ? (int)index : PL_SERIES_BINS - 1;
}

bool pl_series_init(pl_series *series)
{
    *series = (pl_series){.bins = malloc(PL_SERIES_BINS * sizeof *series->bins)};
    if (series->bins != NULL) {
        /* Writes every page now, which calloc would leave to first use: the referee's memory must
         * not look like growth of the engine's. Unlike memset after malloc, it is never made a
         * calloc. */
        explicit_bzero(series->bins, PL_SERIES_BINS * sizeof *series->bins);
    }
    return series->bins != NULL;
}

void pl_series_free(pl_series *series)
{
    free(series->bins);
    series->bins = NULL;
}

void pl_series_add(pl_series *series, double value, long step)
{
    if (isnan(value)) {
        return;
    }
    pl_bin *bin = &series->bins[bin_of(value)];
    bin->count += 1;
    bin->sum += value;
    series->count += 1;
    series->sum += value;
    series->square_sum += value * value;
    if (series->count == 1 || value > series->max) {
        series->max = value;
        series->worst_step = step;
    }
}

double pl_series_percentile(const pl_series *series, double q)
{
    /* 0.07 x 20000 rounds to more than 1400, and would ask for number 1401. */
    uint64_t rank = (uint64_t)ceil(q * (double)series->count * (1 - 1e-12)), seen = 0;
    for (int i = 0; i < PL_SERIES_BINS; ++i) {
        const pl_bin *bin = &series->bins[i];
        seen += bin->count;
        if (bin->count > 0 && seen >= rank) {
            return bin->sum / (double)bin->count;
        }
    }
    return 0;
}

double pl_series_mean(const pl_series *series)
{
    return series->count > 0 ? series->sum / (double)series->count : 0;
}

double pl_series_rms(const pl_series *series)
{
    return series->count > 0 ? sqrt(series->square_sum / (double)series->count) : 0;
}

pl_metric pl_series_metric(const pl_series *series, double value)
{
    pl_metric metric = {.state = PL_METRIC_VALUE,
                        .value = value,
                        .has_percentiles = true,
                        .p50 = pl_series_percentile(series, 0.50),
                        .p95 = pl_series_percentile(series, 0.95),
                        .p99 = pl_series_percentile(series, 0.99),
                        .worst_step = series->worst_step};
    if (!isfinite(value)) {
        metric = (pl_metric){.state = PL_METRIC_FAILED};
        (void)snprintf(metric.reason, sizeof metric.reason, "not finite at step %ld",
                       series->worst_step);
    }
    return metric;
}
