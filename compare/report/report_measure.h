/* A metric over the repeats of one run. */
#ifndef PLUMB_MEASURE_H
#define PLUMB_MEASURE_H

#include "referee/metrics/metrics.h"

#include <jansson.h>

/* Texts are borrowed from the results. */
typedef struct pl_measure {
    pl_metric_state state; /* VALUE when any repeat has a number */
    double value;          /* the median of the repeats that have a number */
    double min, max, mad;  /* mad: median of |x - median| */
    int count;             /* repeats that have a number */
    const char *text;      /* state TEXT */
    const char *reason;    /* state FAILED */
    const char *unit;      /* the result's own, or the table's */
    bool disagrees;        /* said to be deterministic, yet repeats differ */
    bool has_percentiles;
    double p50, p95, p99, worst_step; /* medians over repeats */
} pl_measure;

/* `metrics` are the objects of the metric `id` in all `rows` repeats (NULL where absent), which
 * must outlive the measure; `scratch` has room for `rows` numbers. */
pl_measure pl_measure_of(const json_t *const *metrics, int rows, int id, double *scratch);

/* The metric's value as in a table ("–" when there is none), without any mark. */
void pl_measure_text(const pl_measure *measure, char *text, int size);

/* What a tooltip says: the reason, or spread and percentiles; "" when there is nothing to say. */
void pl_measure_note(const pl_measure *measure, char *text, int size);

#endif
