/* Everything that a report says of results, and its summary as Markdown. */
#ifndef PLUMB_REPORT_PAGE_OF_RESULTS_H
#define PLUMB_REPORT_PAGE_OF_RESULTS_H

#include "findings.h"
#include "losses.h"
#include "verdict_counts.h"

/* Everything that a report says of results. */
typedef struct pl_report {
    const pl_result_table *results;
    pl_verdict_counts verdicts;
    pl_losses losses;
    pl_engine_findings findings;
} pl_report;

/* Finds what is to be said of results, which must outlive *report. Errors as of pl_engine_findings_find. The caller
 * frees *report, also on failure. */
pl_status pl_report_build(const pl_result_table *results, pl_report *report, pl_error *error);

/* Frees the report. */
void pl_report_free(pl_report *report);

/* Adds the report as Markdown with GitHub's tables, for the summary of a CI job: first the verdicts on
 * each engine, and where the home engine loses. */
void pl_report_summary(const pl_report *report, pl_text_buffer *out);

#endif
