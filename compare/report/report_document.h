/* Everything that a report says of results, as a document for each reader. */
#ifndef PLUMB_REPORT_DOCUMENT_H
#define PLUMB_REPORT_DOCUMENT_H

#include "findings.h"
#include "losses.h"

/* Where losses and findings are, beyond the results themselves. */
typedef struct pl_report {
    const pl_result_table *results;
    pl_losses losses;
    pl_all_findings findings;
} pl_report;

/* Finds what is to be said of results, which must outlive the report. The caller frees it. */
pl_report pl_report_build(const pl_result_table *results);

/* Frees the report. */
void pl_report_free(pl_report *report);

/* Who reads a document. */
typedef enum pl_reader {
    PL_READER_TERMINAL, /* each case with all of its runs; the verdicts last, above the prompt */
    PL_READER_SUMMARY,  /* of a CI job: the verdicts first, and a row for each case */
    PL_READER_PAGE      /* what a page does not draw itself */
} pl_reader;

/* Fills a document with what a reader is to know of results. The caller frees it. */
void pl_report_document(const pl_report *report, pl_reader reader, pl_document *document);

#endif
