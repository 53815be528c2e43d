/* What the repeats of a run say of a metric.
 *
 * Over repeats, a measured number (time, memory) is a median with its median absolute deviation,
 * which a single disturbed repeat does not move. A deterministic one must be the same in every
 * repeat, bit for bit; where it is not, the measure says so instead of averaging the difference
 * away. */
#include "report_measure.h"

#include "base/statistics.h"
#include "quantity.h"
#include "report_row.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The median of one number of a metric over the rows that have it; *count is how many have it. */
static double median_of(const json_t *const *metrics, int rows, const char *key, double *scratch,
                        int *count)
{
    *count = 0;
    for (int i = 0; i < rows; i++) {
        const json_t *value = json_object_get(metrics[i], key);
        if (json_is_number(value))
            scratch[(*count)++] = json_number_value(value);
    }
    return pl_median(scratch, *count);
}

static bool is_deterministic(const json_t *metric, int id)
{
    const json_t *said = json_object_get(metric, "deterministic");
    return json_is_boolean(said) ? json_is_true(said) : pl_metric_table[id].deterministic;
}

pl_measure pl_measure_of(const json_t *const *metrics, int rows, int id, double *scratch)
{
    /* These have the unit that the result says. */
    bool own_unit = id == PL_METRIC_REFERENCE_ERROR || id == PL_METRIC_RESIDUAL_MAX ||
                    id == PL_METRIC_RESIDUAL_RMS;
    pl_measure measure = {.state = PL_METRIC_ABSENT,
                          .unit = own_unit ? "" : pl_metric_table[id].unit};
    const json_t *first = NULL;
    for (int i = 0; i < rows; i++) {
        const json_t *value = json_object_get(metrics[i], "value");
        if (metrics[i] == NULL || value == NULL)
            continue;
        if (first == NULL)
            first = metrics[i];
        if (json_is_string(value) && measure.state != PL_METRIC_TEXT) {
            measure.state = PL_METRIC_TEXT;
            measure.text = json_string_value(value);
        } else if (json_is_null(value) && measure.state == PL_METRIC_ABSENT) {
            measure.state = PL_METRIC_FAILED;
            measure.reason = pl_json_get_text(metrics[i], "reason");
        }
    }
    if (first == NULL)
        return measure;
    if (json_is_string(json_object_get(first, "unit")))
        measure.unit = pl_json_get_text(first, "unit");
    for (int i = 0; is_deterministic(first, id) && i < rows; i++) {
        const json_t *value = json_object_get(metrics[i], "value");
        if (value == NULL || !json_equal(value, json_object_get(first, "value")))
            measure.disagrees = true;
    }

    double value = median_of(metrics, rows, "value", scratch, &measure.count);
    if (measure.count == 0)
        return measure;
    measure.state = PL_METRIC_VALUE;
    measure.value = value;
    measure.min = scratch[0];
    measure.max = scratch[measure.count - 1];
    for (int i = 0; i < measure.count; i++)
        scratch[i] = fabs(scratch[i] - value);
    measure.mad = pl_median(scratch, measure.count);
    int count = 0;
    measure.p50 = median_of(metrics, rows, "p50", scratch, &count);
    measure.has_percentiles = count > 0;
    measure.p95 = median_of(metrics, rows, "p95", scratch, &count);
    measure.p99 = median_of(metrics, rows, "p99", scratch, &count);
    measure.worst_step = median_of(metrics, rows, "worst_step", scratch, &count);
    return measure;
}

void pl_measure_text(const pl_measure *measure, char *text, int size)
{
    char number[PL_QUANTITY_SIZE];
    if (measure->state == PL_METRIC_VALUE) {
        pl_quantity_text(measure->value, measure->unit, number);
        snprintf(text, (size_t)size, "%s", number);
    } else {
        snprintf(text, (size_t)size, "%s",
                 measure->state == PL_METRIC_TEXT ? measure->text : pl_quantity_missing);
    }
}

/* The reason why there is no number; "" when there is one. */
static const char *reason_of(const pl_measure *measure)
{
    if (measure->state == PL_METRIC_ABSENT)
        return "does not apply, or the engine does not report it";
    if (measure->state != PL_METRIC_FAILED)
        return "";
    return measure->reason[0] != '\0' ? measure->reason : "no value and no reason given";
}

void pl_measure_note(const pl_measure *measure, char *text, int size)
{
    enum { PART_SIZE = 4 * PL_QUANTITY_SIZE };
    char spread[PART_SIZE] = "", steps[PART_SIZE] = "", worst[PL_QUANTITY_SIZE] = "";
    char a[PL_QUANTITY_SIZE], b[PL_QUANTITY_SIZE], c[PL_QUANTITY_SIZE];
    bool has_value = measure->state == PL_METRIC_VALUE;
    if (has_value && measure->count > 1) {
        pl_quantity_text(measure->min, measure->unit, a);
        pl_quantity_text(measure->max, measure->unit, b);
        pl_quantity_text(measure->mad, measure->unit, c);
        snprintf(spread, sizeof spread, "median of %d repeats, %s to %s, MAD %s. ", measure->count,
                 a, b, c);
    }
    if (has_value && measure->has_percentiles) {
        pl_quantity_text(measure->p50, measure->unit, a);
        pl_quantity_text(measure->p95, measure->unit, b);
        pl_quantity_text(measure->p99, measure->unit, c);
        snprintf(steps, sizeof steps, "over steps: p50 %s, p95 %s, p99 %s", a, b, c);
        if (isfinite(measure->worst_step))
            snprintf(worst, sizeof worst, ", worst at step %.0f", measure->worst_step);
    }
    snprintf(text, (size_t)size, "%s%s%s%s%s", reason_of(measure),
             measure->disagrees ? "not deterministic: repeats differ. " : "", spread, steps, worst);
}
