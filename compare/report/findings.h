/* Findings: where an engine is wrong, and what in it causes that. */
#ifndef PLUMB_FINDINGS_H
#define PLUMB_FINDINGS_H

#include "known_causes.h"
#include "queries.h"

/* A run that is not accurate: it is inaccurate or failed, or its primary error has no value. A scene
 * that the engine does not support is no finding. */
typedef struct pl_engine_finding {
    const pl_result_case *test_case;
    const pl_result_configuration *configuration;
    const pl_result_cell *cell;  /* of the configuration on the case */
    const pl_known_cause *cause; /* NULL: nothing is known of this run */
} pl_engine_finding;

/* All findings of a report. */
typedef struct pl_engine_findings {
    pl_engine_finding *
        items; /* of engines other than the home engine, case by case, in the order of the report */
    int count;
    int runs;                 /* of them that were judged, or have no value */
    pl_text_buffer statement; /* in words: how many of how many, and how many causes are known */
    pl_engine_finding *home;  /* the same of the home engine */
    int home_count, home_runs;
    pl_text_buffer home_statement;
    /* In words, of the engines in `items`; empty without any. */
    pl_text_buffer adapters;  /* whether their conformance was verified */
    pl_text_buffer read_back; /* what was read back from them */
    pl_text_buffer origin;    /* how the causes were found */
    pl_known_causes causes;
} pl_engine_findings;

/* Finds the findings in results, which must outlive *findings. PL_BAD_INPUT: the file of known causes is
 * malformed. The caller frees *findings, also on failure. */
pl_status pl_engine_findings_find(const pl_result_table *results, pl_engine_findings *findings,
                                  pl_error *error);

/* Frees the findings. */
void pl_engine_findings_free(pl_engine_findings *findings);

/* The size of the error text of a finding, in bytes. */
enum { PL_FINDING_TEXT_SIZE = 256 };

/* Writes the texts of a finding, the same in every format: "inaccurate, 74 % (value_error)" or
 * "failed: collapsed, 0.764 m (rest_position_error)". `cause` and `evidence` are borrowed and never
 * empty. */
void pl_engine_finding_texts(const pl_engine_finding *finding, char error[PL_FINDING_TEXT_SIZE],
                             const char **cause, const char **evidence);

#endif
