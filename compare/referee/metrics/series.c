/* A logarithmic histogram. The bin of a number follows from the exponent and the leading seven bits
 * of the mantissa of its IEEE 754 double, without a logarithm and without rounding. Source: the
 * idea of HdrHistogram (Tene 2012). */
#include "modules.h"

#include <math.h>
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

void pl_series_init(pl_series *series, pl_arena *arena)
{
    *series = (pl_series){.bins = pl_arena_take(arena, PL_SERIES_BINS, sizeof *series->bins)};
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
    /* 0.07 x 20000 rounds to more than 1400, which would give rank 1401. */
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

pl_metric pl_series_metric(const pl_series *series, unsigned traits)
{
    const double count = series->count > 0 ? (double)series->count : 1;
    const double value = (traits & PL_TRAIT_MEAN) != 0  ? series->sum / count
                         : (traits & PL_TRAIT_RMS) != 0 ? sqrt(series->square_sum / count)
                                                        : series->max;
    if (!isfinite(value)) {
        return pl_metric_failed("not finite at step %ld", series->worst_step);
    }
    return (pl_metric){.state = PL_METRIC_VALUE,
                       .value = value,
                       .has_percentiles = true,
                       .p50 = pl_series_percentile(series, 0.50),
                       .p95 = pl_series_percentile(series, 0.95),
                       .p99 = pl_series_percentile(series, 0.99),
                       .worst_step = series->worst_step};
}

/* ---- The metrics over steps ---- */

static int series_count(int id)
{
    return !pl_metric_is(id, PL_TRAIT_OVER_STEPS)     ? 0
           : pl_metric_is(id, PL_TRAIT_BY_INTEGRATOR) ? PL_POSITION_RULE_COUNT
                                                      : 1;
}

void pl_make_series(pl_run_view *view, pl_arena *arena)
{
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        const int count = series_count(id);
        view->series[id] = pl_arena_take(arena, (size_t)count, sizeof *view->series[id]);
        for (int k = 0; k < count; ++k) {
            pl_series_init(&view->series[id][k], arena);
        }
    }
}

void pl_see_value_by(const pl_run_view *view, pl_metric_id id, pl_position_rule rule, double value)
{
    pl_series_add(&view->series[id][rule], value, view->step.number);
}

void pl_see_value(const pl_run_view *view, pl_metric_id id, double value)
{
    pl_see_value_by(view, id, (pl_position_rule)0, value);
}

void pl_series_metrics(const pl_run_view *view, bool has_impulses, pl_metric *item)
{
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        const int count = series_count(id);
        const pl_series *all = view->series[id];
        const pl_series *series = count > 1 ? &all[view->integrator] : all;
        const bool is_known = has_impulses || !pl_metric_is(id, PL_TRAIT_IMPULSES);
        if (count > 0 && is_known && (series->count > 0 || all->applies)) {
            item[id] = pl_series_metric(series, pl_metric_table[id].traits);
        }
    }
}
