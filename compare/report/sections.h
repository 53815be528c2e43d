/* What reports ask a table of results, and the sections of a report's document. */
#ifndef PLUMB_REPORT_SECTIONS_H
#define PLUMB_REPORT_SECTIONS_H

#include "base/document.h"
#include "base/number_format.h"
#include "results/result_table.h"

/* Whether the metric is the case's primary error, so that reference_error is the same. */
bool pl_case_primary_is(const pl_result_case *test_case, int metric);

/* Returns the names of the configurations of the home engine, or of the others, separated by commas. The caller
 * frees. */
char *pl_engine_names(const pl_result_table *results, bool home);

/* Returns the style of a cell, which pages and terminals colour: "ok" accurate, "poor" inaccurate,
 * "bad" failed, "none" unsupported or not run, "" not judged. */
const char *pl_cell_style(const pl_result_cell *cell);

enum { PL_CELL_VERDICT_SIZE = 128 };

/* Writes "accurate", "inaccurate", "failed: OUTCOME" ("failed" where the outcome is ok),
 * "unsupported", "not judged" or "not run"; where the outcomes of repeats differ also how many have not ended ok:
 * "failed: crashed in 1 of 3". */
void pl_cell_verdict(const pl_result_cell *cell, char text[PL_CELL_VERDICT_SIZE]);

/* Returns why: of a run that did not end ok the reason of its outcome, else that of its verdict.
 * Borrowed; "" when there is none. */
const char *pl_cell_why(const pl_result_cell *cell);

/* Returns the largest primary error of an accurate run of the case, and writes it with its unit; NAN where no run of
 * the case states one. */
double pl_case_bound(const pl_result_case *test_case, char text[PL_QUANTITY_SIZE]);

/* ---- Sections. One that has nothing to say is left out ---- */

/* The blanks before a table that stands below a line of its own on a terminal. */
enum { PL_SECTION_INDENT = 2 };

/* Adds the verdicts on each engine, of several cases. */
void pl_section_verdicts(const pl_result_table *results, pl_document *document);

/* Adds the results for a terminal: each case with a row for each engine. */
void pl_section_cases(const pl_result_table *results, pl_document *document);

/* Adds the results in short: a row for each case, with a column for each engine. */
void pl_section_matrix(const pl_result_table *results, pl_document *document);

/* Adds the numbers that others published, for suites whose every case was run: its scenario and parameters, with any
 * time step and duration, which publications leave open. */
void pl_section_published(const pl_result_table *results, pl_document *document);

/* ---- What is known of adapters: reports claim no more than that ---- */

/* Returns a run of the configuration on the first case that it has. */
const pl_result_row *pl_first_run(const pl_result_table *results, int configuration);

/* Returns what is known of a configuration's conformance: "conformance passed (31 checks, plumb 0.9.0)",
 * "conformance FAILED: 2 of 31 checks", or "not verified: run plumb check-engine SPEC". Checks are
 * made with a profile's default options: where its label is not that of the profile alone,
 * the text names the profile. The caller frees. */
char *pl_conformance_text(const pl_result_table *results, int configuration);

/* Adds, in words, which numbers were read back from the engines of the configurations that are marked in `listed`
 * (configuration_count), and which were not. */
void pl_describe_read_back(const pl_result_table *results, const bool *listed,
                           pl_document *document);

#endif
