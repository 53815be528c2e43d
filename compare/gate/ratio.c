/* Ratios of times, and how well they are known.
 *
 * Engines take turns from repeat to repeat, so that a ratio within one repeat is free of what
 * slowed the machine in it. The bounds of the median are two order statistics, whatever the
 * distribution (W. R. Thompson 1936): with the k-th value from either end they hold the true median
 * except with a probability of 2 P(B < k), B binomial of n and 1/2. At most 1/16 is allowed, which
 * five repeats just reach. */
#include "gate.h"

#include "base/heap.h"
#include "base/json_field.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double miss_allowed = 1.0 / 16;

const char *pl_gate_label_of(const pl_gate_rows *rows, const pl_result_cell *cell)
{
    return rows->results->configurations[cell->configuration].label;
}

static const pl_result_cell *find_cell(const pl_gate_rows *rows, const pl_gate_row *row,
                                       const char *label)
{
    const pl_result_case *test_case = &rows->results->cases[row->cell->test_case];
    for (int i = 0; i < test_case->count; ++i) {
        if (strcmp(pl_gate_label_of(rows, &test_case->cells[i]), label) == 0) {
            return &test_case->cells[i];
        }
    }
    return NULL;
}

const pl_result_cell *pl_gate_reference_of(const pl_gate_rows *rows, const pl_gate_row *row,
                                           const char *label)
{
    const pl_result_cell *reference = find_cell(rows, row, label != NULL ? label : "bullet:si");
    if (label == NULL && reference == NULL) {
        reference = find_cell(rows, row, "ode:quick");
    }
    return reference == row->cell ? NULL : reference;
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

pl_gate_ratio pl_gate_ratio_measure(const pl_result_cell *cell, const pl_result_cell *reference,
                                    const char *metric)
{
    int count = 0;
    double *values = pl_heap_new((size_t)cell->count, sizeof *values);
    for (int i = 0; i < cell->count; ++i) {
        const pl_result_row *own = &cell->rows[i];
        for (int k = 0; reference != NULL && k < reference->count; ++k) {
            const pl_result_row *other = &reference->rows[k];
            const double value =
                pl_result_metric(own->result, metric) / pl_result_metric(other->result, metric);
            if (own->file == other->file && own->repeat == other->repeat && isfinite(value) &&
                value > 0) {
                values[count++] = value;
                break;
            }
        }
    }
    const pl_gate_ratio ratio = summarise(values, count);
    free(values);
    return ratio;
}

void pl_gate_ratios_add(pl_gate_rows *rows, const char *label)
{
    for (int i = 0; i < rows->count; ++i) {
        const pl_gate_row *row = &rows->items[i];
        const pl_result_cell *reference = pl_gate_reference_of(rows, row, label);
        for (int c = 0; pl_gate_row_is_ok(row) && c < PL_METRIC_COUNT; ++c) {
            const pl_metric_info *cost = &pl_metric_table[c];
            const pl_gate_ratio ratio = pl_gate_ratio_measure(
                row->cell, cost->ratio == NULL ? NULL : reference, cost->name);
            if (ratio.repeats > 0) {
                json_object_set_new(row->json, cost->ratio,
                                    json_pack("{s:s, s:f, s:f, s:f, s:i}", "reference",
                                              pl_gate_label_of(rows, reference), "value",
                                              ratio.value, "low", ratio.low, "high", ratio.high,
                                              "repeats", ratio.repeats));
            }
        }
    }
}

pl_gate_ratio pl_gate_ratio_of_json(const json_t *json)
{
    return (pl_gate_ratio){.repeats = (int)pl_json_get_number(json, "repeats"),
                           .value = pl_json_get_number(json, "value"),
                           .low = pl_json_get_number(json, "low"),
                           .high = pl_json_get_number(json, "high")};
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
