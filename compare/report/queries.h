/* Questions of reports to a table of results, and the verdict on a run as reports show it. */
#ifndef PLUMB_REPORT_QUERIES_H
#define PLUMB_REPORT_QUERIES_H

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

#endif
