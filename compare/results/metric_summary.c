/* A measured number (time, memory) becomes a median with its median absolute deviation, which a
 * single disturbed repeat does not move. A deterministic number must be the same in every repeat,
 * bit for bit; otherwise the summary is marked. */

#include "base/heap.h"
#include "base/number_format.h"
#include "base/statistics.h"
#include "result_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The metric in each repeat (NULL: absent), and room for a number of each. */
typedef struct repeats {
    const json_t **metrics; /* (count) */
    double *numbers;        /* (count) */
    int count;
} repeats;

/* Returns the median of one number of a metric over the *known repeats that have it. */
static double median_of(const repeats *r, const char *key, int *known)
{
    *known = 0;
    for (int i = 0; i < r->count; ++i) {
        const json_t *value = json_object_get(r->metrics[i], key);
        if (json_is_number(value)) {
            r->numbers[(*known)++] = json_number_value(value);
        }
    }
    return pl_median(r->numbers, *known);
}

/* Sets the state to the best of the repeats, and text and reason. Returns the metric of the first repeat that has
 * it; NULL: none. */
static const json_t *find_state(const repeats *r, pl_metric_summary *summary)
{
    const json_t *first = NULL;
    for (int i = 0; i < r->count; ++i) {
        const json_t *value = json_object_get(r->metrics[i], "value");
        first = first == NULL && value != NULL ? r->metrics[i] : first;
        if (json_is_string(value) && summary->state != PL_METRIC_TEXT) {
            summary->state = PL_METRIC_TEXT;
            summary->text = json_string_value(value);
        } else if (json_is_null(value) && summary->reason == NULL) {
            summary->state = summary->state == PL_METRIC_ABSENT ? PL_METRIC_FAILED : summary->state;
            summary->reason = pl_json_get_text(r->metrics[i], "reason");
        }
    }
    return first;
}

static bool disagree(const repeats *r, const json_t *first)
{
    bool found = false;
    for (int i = 0; i < r->count; ++i) {
        const json_t *value = json_object_get(r->metrics[i], "value");
        found |= value == NULL || !json_equal(value, json_object_get(first, "value"));
    }
    return found;
}

static void find_numbers(const repeats *r, pl_metric_summary *summary)
{
    const double value = median_of(r, "value", &summary->count);
    int known = 0;
    if (summary->count == 0) {
        return;
    }
    summary->state = PL_METRIC_VALUE;
    summary->value = value;
    summary->min = r->numbers[0];
    summary->max = r->numbers[summary->count - 1];
    for (int i = 0; i < summary->count; ++i) {
        r->numbers[i] = fabs(r->numbers[i] - value);
    }
    summary->mad = pl_median(r->numbers, summary->count);
    summary->p50 = median_of(r, "p50", &known);
    summary->has_percentiles = known > 0;
    summary->p95 = median_of(r, "p95", &known);
    summary->p99 = median_of(r, "p99", &known);
    summary->worst_step = median_of(r, "worst_step", &known);
}

pl_metric_summary pl_metric_summarise(const pl_result_row *rows, int count, const char *name)
{
    const int id = pl_metric_by_name(name);
    const repeats r = {.metrics = pl_heap_new((size_t)count, sizeof(const json_t *)),
                       .numbers = pl_heap_new((size_t)count, sizeof(double)),
                       .count = count};
    pl_metric_summary summary = {.state = PL_METRIC_ABSENT, .unit = pl_metric_table_unit(id)};
    for (int i = 0; i < count; ++i) {
        r.metrics[i] = json_object_get(rows[i].metrics, name);
    }
    const json_t *first = find_state(&r, &summary);
    if (first != NULL) {
        const char *unit = json_string_value(json_object_get(first, "unit"));
        summary.unit = unit != NULL ? unit : summary.unit;
        summary.answer = (int)json_integer_value(json_object_get(first, "answer"));
        summary.is_deterministic = pl_metric_is_deterministic(first, id);
        summary.disagrees = summary.is_deterministic && disagree(&r, first);
        find_numbers(&r, &summary);
    }
    free(r.metrics);
    free(r.numbers);
    return summary;
}

void pl_metric_text(const pl_metric_summary *summary, char text[PL_METRIC_TEXT_SIZE])
{
    if (summary->state == PL_METRIC_VALUE) {
        pl_format_number(summary->value, summary->unit, text);
    } else {
        snprintf(text, PL_METRIC_TEXT_SIZE, "%s",
                 summary->state == PL_METRIC_TEXT ? summary->text : pl_no_number);
    }
}

void pl_metric_spread_text(const pl_metric_summary *summary, char text[PL_METRIC_TEXT_SIZE])
{
    if (summary->state == PL_METRIC_VALUE && summary->max > summary->min) {
        pl_format_spread(summary->value, summary->mad, summary->unit, text);
    } else {
        pl_metric_text(summary, text);
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

char *pl_metric_note(const pl_metric_summary *summary)
{
    const bool has_value = summary->state == PL_METRIC_VALUE;
    char a[PL_QUANTITY_SIZE], b[PL_QUANTITY_SIZE], c[PL_QUANTITY_SIZE];
    pl_text_buffer note = {0};
    pl_text_add(&note, reason_of(summary));
    pl_text_add(&note, summary->disagrees ? "not deterministic: repeats differ. " : "");
    if (has_value && summary->answer > 0) {
        pl_text_format(&note, "nearest right answer: %d. ", summary->answer);
    }
    if (has_value && summary->count > 1) {
        pl_format_number(summary->min, summary->unit, a);
        pl_format_number(summary->max, summary->unit, b);
        pl_format_number(summary->mad, summary->unit, c);
        pl_text_format(&note, "median of %d repeats, %s to %s, MAD %s. ", summary->count, a, b, c);
    }
    if (has_value && summary->has_percentiles) {
        pl_format_number(summary->p50, summary->unit, a);
        pl_format_number(summary->p95, summary->unit, b);
        pl_format_number(summary->p99, summary->unit, c);
        pl_text_format(&note, "over steps: p50 %s, p95 %s, p99 %s", a, b, c);
    }
    if (has_value && summary->has_percentiles && isfinite(summary->worst_step)) {
        pl_text_format(&note, ", worst at step %.0f", summary->worst_step);
    }
    return pl_text_take(&note);
}
