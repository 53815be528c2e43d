/* A metric summarised over the repeats of one run. */
#ifndef PLUMB_METRIC_SUMMARY_H
#define PLUMB_METRIC_SUMMARY_H

#include "referee/metrics/metrics.h"

struct pl_result_row;

/* Texts are borrowed from the results. */
typedef struct pl_metric_summary {
    pl_metric_state state; /* VALUE when any repeat has a number */
    double value;          /* the median of the repeats that have a number */
    double min, max, mad;  /* mad: median of |x - median| */
    int count;             /* repeats that have a number */
    const char *text;      /* state TEXT */
    const char *reason;    /* of the first repeat without a value; NULL: there is none */
    const char *unit;      /* the result's own, or the table's */
    int answer;            /* the number of the nearest of several right answers; 0: none */
    bool is_deterministic;
    bool disagrees; /* a deterministic metric whose repeats differ */
    bool has_percentiles;
    double p50, p95, p99, worst_step; /* medians over repeats */
} pl_metric_summary;

enum { PL_METRIC_TEXT_SIZE = 160, PL_METRIC_NOTE_SIZE = 640 };

/* Summarises the metric of that name over the results of one run, which must outlive the summary. */
pl_metric_summary pl_metric_summarise(const struct pl_result_row *rows, int count,
                                      const char *name);

/* Writes the value as in a table; "–" when there is none. */
void pl_metric_text(const pl_metric_summary *summary, char text[PL_METRIC_TEXT_SIZE]);

/* The same, with the spread where repeats differ: "12.3 ± 0.4 µs" has the median and `mad`. */
void pl_metric_spread_text(const pl_metric_summary *summary, char text[PL_METRIC_TEXT_SIZE]);

/* Writes the text of a tooltip: why there is no value, or spread and percentiles; "" where there is
 * nothing to say. */
void pl_metric_note(const pl_metric_summary *summary, char text[PL_METRIC_NOTE_SIZE]);

#endif
