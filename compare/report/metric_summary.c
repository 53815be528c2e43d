/* A measured number (time, memory) becomes a median with its median absolute deviation, which a
 * single disturbed repeat does not move. A deterministic number must be the same in every repeat,
 * bit for bit; where it is not, the summary is marked. */
#include "metric_summary.h"

#include "base/statistics.h"
#include "number_format.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Returns the object of a metric in a result; NULL where it is absent. */
static const json_t *metric_in(const json_t *result, int id)
{
    return json_object_get(json_object_get(result, "metrics"), pl_metric_table[id].name);
}

/* Returns the median of one number of a metric over the *count results that have it. */
static double median_of(const json_t *const *results, int repeats, int id, const char *key,
                        double *scratch, int *count)
{
    *count = 0;
    for (int i = 0; i < repeats; ++i) {
        const json_t *value = json_object_get(metric_in(results[i], id), key);
        if (json_is_number(value)) {
            scratch[(*count)++] = json_number_value(value);
        }
    }
    return pl_median(scratch, *count);
}

pl_metric_summary pl_metric_summarise(const json_t *const *results, int repeats, int id,
                                      double *scratch)
{
    pl_metric_summary summary = {.state = PL_METRIC_ABSENT, .unit = pl_metric_table_unit(id)};
    const json_t *first = NULL;
    for (int i = 0; i < repeats; ++i) {
        const json_t *metric = metric_in(results[i], id);
        const json_t *value = json_object_get(metric, "value");
        if (value == NULL) {
            continue;
        }
        if (first == NULL) {
            first = metric;
        }
        if (json_is_string(value) && summary.state != PL_METRIC_TEXT) {
            summary.state = PL_METRIC_TEXT;
            summary.text = json_string_value(value);
        } else if (json_is_null(value) && summary.state == PL_METRIC_ABSENT) {
            summary.state = PL_METRIC_FAILED;
            summary.reason = pl_json_get_text(metric, "reason");
        }
    }
    if (first == NULL) {
        return summary;
    }
    if (json_is_string(json_object_get(first, "unit"))) {
        summary.unit = pl_json_get_text(first, "unit");
    }
    summary.answer = (int)json_integer_value(json_object_get(first, "answer"));
    for (int i = 0; pl_metric_is_deterministic(first, id) && i < repeats; ++i) {
        const json_t *value = json_object_get(metric_in(results[i], id), "value");
        if (value == NULL || !json_equal(value, json_object_get(first, "value"))) {
            summary.disagrees = true;
        }
    }

    double value = median_of(results, repeats, id, "value", scratch, &summary.count);
    if (summary.count == 0) {
        return summary;
    }
    summary.state = PL_METRIC_VALUE;
    summary.value = value;
    summary.min = scratch[0];
    summary.max = scratch[summary.count - 1];
    for (int i = 0; i < summary.count; ++i) {
        scratch[i] = fabs(scratch[i] - value);
    }
    summary.mad = pl_median(scratch, summary.count);
    int count = 0;
    summary.p50 = median_of(results, repeats, id, "p50", scratch, &count);
    summary.has_percentiles = count > 0;
    summary.p95 = median_of(results, repeats, id, "p95", scratch, &count);
    summary.p99 = median_of(results, repeats, id, "p99", scratch, &count);
    summary.worst_step = median_of(results, repeats, id, "worst_step", scratch, &count);
    return summary;
}

void pl_metric_text(const pl_metric_summary *summary, char text[PL_METRIC_TEXT_SIZE])
{
    char number[PL_NUMBER_SIZE] = "";
    if (summary->state == PL_METRIC_VALUE) {
        pl_format_number(summary->value, summary->unit, number);
    }
    snprintf(text, PL_METRIC_TEXT_SIZE, "%s",
             summary->state == PL_METRIC_VALUE  ? number
             : summary->state == PL_METRIC_TEXT ? summary->text
                                                : pl_no_number);
}

void pl_metric_spread_text(const pl_metric_summary *summary, char text[PL_METRIC_TEXT_SIZE])
{
    pl_metric_text(summary, text);
    if (summary->state == PL_METRIC_VALUE && summary->max > summary->min) {
        char number[PL_NUMBER_SIZE];
        pl_format_spread(summary->value, summary->mad, summary->unit, number);
        snprintf(text, PL_METRIC_TEXT_SIZE, "%s", number);
    }
}

/* Returns why there is no number; "" when there is one. */
static const char *reason_of(const pl_metric_summary *summary)
{
    if (summary->state == PL_METRIC_ABSENT) {
        return "does not apply, or the engine does not report it";
    }
    if (summary->state != PL_METRIC_FAILED) {
        return "";
    }
    return summary->reason[0] != '\0' ? summary->reason : "no value and no reason given";
}

void pl_metric_note(const pl_metric_summary *summary, char text[PL_METRIC_NOTE_SIZE])
{
    enum { PART_SIZE = 4 * PL_NUMBER_SIZE };
    char spread[PART_SIZE] = "", steps[PART_SIZE] = "", worst[PL_NUMBER_SIZE] = "";
    char answer[PART_SIZE] = "";
    char a[PL_NUMBER_SIZE], b[PL_NUMBER_SIZE], c[PL_NUMBER_SIZE];
    bool has_value = summary->state == PL_METRIC_VALUE;
    if (has_value && summary->count > 1) {
        pl_format_number(summary->min, summary->unit, a);
        pl_format_number(summary->max, summary->unit, b);
        pl_format_number(summary->mad, summary->unit, c);
        snprintf(spread, sizeof spread, "median of %d repeats, %s to %s, MAD %s. ", summary->count,
                 a, b, c);
    }
    if (has_value && summary->has_percentiles) {
        pl_format_number(summary->p50, summary->unit, a);
        pl_format_number(summary->p95, summary->unit, b);
        pl_format_number(summary->p99, summary->unit, c);
        snprintf(steps, sizeof steps, "over steps: p50 %s, p95 %s, p99 %s", a, b, c);
        if (isfinite(summary->worst_step)) {
            snprintf(worst, sizeof worst, ", worst at step %.0f", summary->worst_step);
        }
    }
    if (has_value && summary->answer > 0) {
        snprintf(answer, sizeof answer, "nearest right answer: %d. ", summary->answer);
    }
    snprintf(text, PL_METRIC_NOTE_SIZE, "%s%s%s%s%s%s", reason_of(summary),
             summary->disagrees ? "not deterministic: repeats differ. " : "", answer, spread, steps,
             worst);
}
