/* Everything that a report says of results, as a document for each reader: where the home engine is worse than another,
 * where an engine is wrong, and what in it causes that. */
#ifndef PLUMB_REPORT_DOCUMENT_H
#define PLUMB_REPORT_DOCUMENT_H

#include "base/document.h"
#include "results/result_table.h"

/* ---- Losses: where the home engine is worse than another ---- */

/* The kinds of loss. */
typedef enum pl_loss_kind {
    PL_LOSS_OUTCOME,  /* the home engine failed, another did not */
    PL_LOSS_NO_VALUE, /* the home engine has no value, another has one */
    PL_LOSS_VALUE     /* that of the home engine is larger */
} pl_loss_kind;

/* One loss. */
typedef struct pl_loss {
    pl_loss_kind kind;
    const pl_result_cell *home,
        *best;    /* of one case; best: of the other engines whose outcome is ok */
    int metric;   /* of the two kinds that have one */
    double ratio; /* home / the larger of best and the metric's floor; INFINITY for other kinds */
    bool near_rounding; /* PL_LOSS_VALUE: neither value is large enough to matter */
} pl_loss;

/* All losses of a report. */
typedef struct pl_losses {
    const pl_result_table *results; /* borrowed */
    pl_loss *items; /* failures; the primary error and the time of a step; other metrics; values
                       near rounding; in each a missing value first, then by falling ratio */
    int count;
    int comparisons; /* pairs of its run and a metric that were compared with another engine */
    int cases;       /* with both a run of it and an ok run of another engine */
} pl_losses;

/* Finds the losses in results, which must outlive *losses. The caller frees its items. */
void pl_losses_find(const pl_result_table *results, pl_losses *losses);

/* Adds where the home engine loses: how many losses in how many comparisons, a table of them, in which `shown` rows are
 * shown at first, and unless `is_short` which metrics count, and which differences do not. Nothing without a home
 * engine. */
void pl_losses_describe(const pl_losses *losses, int shown, bool is_short, pl_document *document);

/* ---- Known causes of errors: the statements of known_causes.json ---- */

/* The file of known causes, which is part of the program: a new reference. */
json_t *pl_known_causes(void);

/* Returns the first statement of such a file that is about a plumb.result/1, borrowed; NULL where there is none.
 * Engine, version, profile, outcome and scenario must be those of the statement; each parameter must lie in
 * its range, and a parameter without a range must have its default. No statement is about a run
 * with options other than its profile's. */
const json_t *pl_known_cause_find(const json_t *causes, const json_t *result);

/* ---- Findings: where an engine is wrong ---- */

/* A run that is not accurate: it is inaccurate or failed, or its primary error has no value. A scene
 * that the engine does not support is no finding. */
typedef struct pl_engine_finding {
    const pl_result_cell *cell;
    const json_t *cause; /* of known_causes.json; NULL: nothing is known of this run */
} pl_engine_finding;

/* The findings about the home engine, or about the others. */
typedef struct pl_engine_findings {
    pl_engine_finding *items; /* (count), case by case, in the order of the report */
    int count;
    int runs; /* of them that were judged, or have no value */
} pl_engine_findings;

/* All findings of a report. */
typedef struct pl_all_findings {
    const pl_result_table *results; /* borrowed */
    pl_engine_findings home, others;
    json_t *causes; /* owned */
} pl_all_findings;

/* Finds the findings in results, which must outlive *findings. The caller frees what they own. */
void pl_findings_find(const pl_result_table *results, pl_all_findings *findings);

/* Adds how many runs of the home engine (`home`) are not accurate, and a table of them, in which `shown` rows are shown
 * at first (0: all). Of the others as a section, with what is known of their adapters and how causes were found.
 * `is_short`: without experiments and reasons. Nothing where no run was judged. */
void pl_findings_describe(const pl_all_findings *all, bool home, int shown, bool is_short,
                          pl_document *document);

/* ---- The document ---- */

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
