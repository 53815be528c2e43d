/* Findings: where an engine is wrong, and what in it causes that. */
#ifndef PLUMB_FINDINGS_H
#define PLUMB_FINDINGS_H

#include "base/document.h"
#include "known_causes.h"
#include "queries.h"

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

/* Finds the findings in results, which must outlive *findings. The caller frees *findings. */
void pl_findings_find(const pl_result_table *results, pl_all_findings *findings);

/* Frees the findings. */
void pl_findings_free(pl_all_findings *findings);

/* Adds how many runs of the home engine (`home`) are not accurate, and a table of them, in which `shown` rows are shown
 * at first (0: all). Of the others as a section, with what is known of their adapters and how causes were found.
 * `is_short`: without experiments and reasons. Nothing where no run was judged. */
void pl_findings_describe(const pl_all_findings *findings, bool home, int shown, bool is_short,
                          pl_document *document);

#endif
