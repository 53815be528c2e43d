/* How many runs of each engine are accurate, inaccurate or failed. */
#ifndef PLUMB_VERDICT_COUNTS_H
#define PLUMB_VERDICT_COUNTS_H

#include "base/table.h"
#include "queries.h"

/* The verdicts on one engine configuration. The repeats of a run count once, by the worst. */
typedef struct pl_verdict_count {
    const pl_result_configuration *configuration;
    int runs[PL_VERDICT_COUNT]; /* of each verdict; those unsupported are not among them */
    int unsupported, not_run;   /* cases */
} pl_verdict_count;

/* The verdicts on all engine configurations of a report. */
typedef struct pl_verdict_counts {
    pl_verdict_count *items; /* more accurate runs first, then fewer that failed, then fewer that
                                are inaccurate, then by name */
    int count;
    int cases;
    bool any_judged;      /* some run has a verdict */
    pl_text_buffer order; /* in words: what is counted, and how the engines are ordered */
} pl_verdict_counts;

/* Counts the verdicts of results, which must outlive *counts. The caller frees *counts. */
void pl_verdict_counts_make(const pl_result_table *results, pl_verdict_counts *counts);

/* Frees the counts. */
void pl_verdict_counts_free(pl_verdict_counts *counts);

/* Makes a table with a row for each engine. Counts of cases that are unsupported, not judged or not
 * run have a column where some engine has any. The caller frees. */
pl_table pl_verdict_counts_table(const pl_verdict_counts *counts);

#endif
