/* Ratios of times, and how well they are known.
 *
 * Engines take turns from repeat to repeat, so that a ratio within one repeat is free of what
 * slowed the machine in it. The bounds of the median are two order statistics, whatever the
 * distribution (W. R. Thompson 1936): with the k-th value from either end they hold the true median
 * except with a probability of 2 P(B < k), B binomial of n and 1/2. At most 1/16 is allowed, which
 * five repeats just reach. */
#include "ratio.h"

#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double miss_allowed = 1.0 / 16;

int pl_gate_cost_of(const char *name)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[i];
        if (info->ratio != NULL &&
            (strcmp(info->name, name) == 0 || strcmp(info->ratio, name) == 0)) {
            return i;
        }
    }
    return -1;
}

const pl_gate_row *pl_gate_reference_of(const pl_gate_rows *rows, const pl_gate_row *row,
                                        const char *label)
{
    static const char *const defaults[] = {"bullet:si", "ode:quick"};
    const pl_gate_row *reference = NULL;
    if (label != NULL) {
        reference = pl_gate_rows_same_case(rows, row, label);
    }
    for (size_t i = 0;
         label == NULL && reference == NULL && i < sizeof defaults / sizeof defaults[0]; ++i) {
        reference = pl_gate_rows_same_case(rows, row, defaults[i]);
    }
    return reference == row ? NULL : reference;
}

/* Returns the largest k for which the k-th values from both ends, from 1, bound the median. */
static int bound_rank(int count)
{
    double term = pow(0.5, count), below = term; /* P(B = 0), P(B < 1) */
    int rank = 1;
    for (int k = 1; k < count / 2; ++k) {
        term *= (double)(count - k + 1) / k;
        below += term;
        if (2 * below > miss_allowed) {
            break;
        }
        rank = k + 1;
    }
    return rank;
}

static pl_gate_ratio summarise(double *values, int count)
{
    if (count == 0) {
        return (pl_gate_ratio){0};
    }
    const double median = pl_median(values, count);
    int rank = bound_rank(count);
    return (pl_gate_ratio){
        .repeats = count, .value = median, .low = values[rank - 1], .high = values[count - rank]};
}

/* Returns NAN where there is no number. */
static double number_in(const pl_gate_sample *sample, const char *metric)
{
    const json_t *value = json_object_get(json_object_get(sample->metrics, metric), "value");
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

pl_status pl_gate_ratio_measure(const pl_gate_row *row, const pl_gate_row *reference,
                                const char *metric, pl_gate_ratio *ratio, pl_error *error)
{
    int count = 0;
    double *values = calloc((size_t)row->sample_count + 1, sizeof *values);
    if (values == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d repeats", row->sample_count);
    }
    for (int i = 0; i < row->sample_count; ++i) {
        const pl_gate_sample *ours = &row->samples[i];
        for (int k = 0; k < reference->sample_count; ++k) {
            const pl_gate_sample *theirs = &reference->samples[k];
            double value = number_in(ours, metric) / number_in(theirs, metric);
            if (ours->file == theirs->file && ours->repeat == theirs->repeat && isfinite(value) &&
                value > 0) {
                values[count++] = value;
                break;
            }
        }
    }
    *ratio = summarise(values, count);
    free(values);
    return PL_OK;
}

static pl_status add_ratio(const pl_gate_row *row, const pl_gate_row *reference, int cost,
                           pl_error *error)
{
    pl_gate_ratio ratio = {0};
    pl_status status =
        pl_gate_ratio_measure(row, reference, pl_metric_table[cost].name, &ratio, error);
    if (status != PL_OK || ratio.repeats == 0) {
        return status;
    }
    json_t *json =
        json_pack("{s:s, s:f, s:f, s:f, s:i}", "reference", reference->label, "value", ratio.value,
                  "low", ratio.low, "high", ratio.high, "repeats", ratio.repeats);
    return json_object_set_new(row->json, pl_metric_table[cost].ratio, json) == 0
               ? PL_OK
               : pl_fail(error, PL_NO_MEMORY, "out of memory for a ratio");
}

pl_status pl_gate_ratios_add(pl_gate_rows *rows, const char *label, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < rows->count; ++i) {
        const pl_gate_row *row = &rows->items[i];
        const pl_gate_row *reference = pl_gate_reference_of(rows, row, label);
        bool has_costs = reference != NULL && pl_gate_row_is_ok(row);
        for (int cost = 0; has_costs && status == PL_OK && cost < PL_METRIC_COUNT; ++cost) {
            if (pl_metric_table[cost].ratio != NULL) {
                status = add_ratio(row, reference, cost, error);
            }
        }
    }
    return status;
}

pl_gate_ratio pl_gate_ratio_of_json(const json_t *json)
{
    return (pl_gate_ratio){.repeats = (int)json_number_value(json_object_get(json, "repeats")),
                           .value = json_number_value(json_object_get(json, "value")),
                           .low = json_number_value(json_object_get(json, "low")),
                           .high = json_number_value(json_object_get(json, "high"))};
}

/* Returns half the width of the bounds, over the value. */
static double spread_of(const pl_gate_ratio *ratio)
{
    return 0.5 * (ratio->high - ratio->low) / ratio->value;
}

pl_gate_trend pl_gate_ratio_trend(const pl_gate_ratio *before, const pl_gate_ratio *now,
                                  double limit, double *growth, double *noise)
{
    *growth = now->value / before->value - 1;
    /* Both are disturbed independently of each other. */
    *noise = now->value / before->value * hypot(spread_of(now), spread_of(before));
    if (now->repeats < PL_GATE_FEWEST_REPEATS || before->repeats < PL_GATE_FEWEST_REPEATS) {
        return PL_GATE_FEW;
    }
    if (*growth > limit + *noise) {
        return PL_GATE_SLOWER;
    }
    if (*noise > limit || *growth > limit) {
        return PL_GATE_NOISY;
    }
    return *growth < -limit - *noise ? PL_GATE_FASTER : PL_GATE_STEADY;
}
