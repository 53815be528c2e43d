/* The verdict on a run as reports show it: its words, its colour, and the bound that it rests on. */
#ifndef PLUMB_CELL_VERDICT_H
#define PLUMB_CELL_VERDICT_H

#include "base/number_format.h"
#include "queries.h"

/* Returns the style of a cell, which pages and terminals colour: "ok" accurate, "poor" inaccurate,
 * "bad" failed, "none" unsupported or not run, "" not judged. */
const char *pl_cell_style(const pl_result_cell *cell);

enum { PL_CELL_VERDICT_SIZE = 96 };

/* Writes "accurate", "inaccurate", "failed: OUTCOME" ("failed" where the outcome is ok),
 * "unsupported", "not judged" or "not run". */
void pl_cell_verdict(const pl_result_cell *cell, char text[PL_CELL_VERDICT_SIZE]);

/* Returns why: of a run that did not end ok the reason of its outcome, else that of its verdict.
 * Borrowed; "" when there is none. */
const char *pl_cell_why(const pl_result_cell *cell);

/* Adds the verdict of a cell that was run as bold Markdown, and how many repeats have its outcome
 * where they differ. */
void pl_cell_badge(const pl_result_cell *cell, pl_text_buffer *out);

/* Writes the largest primary error of an accurate run of the case, with its unit, and in *reason
 * why it is that: borrowed, "" when it is not known. False where no run of the case states one. */
bool pl_case_acceptance(const pl_result_case *test_case, char bound[PL_QUANTITY_SIZE],
                        const char **reason);

#endif
