/* The sections of a report's document, each of which is left out where there is nothing to say. */
#ifndef PLUMB_REPORT_SECTIONS_H
#define PLUMB_REPORT_SECTIONS_H

#include "base/document.h"
#include "results/result_table.h"

/* The blanks before a table that stands below a line of its own on a terminal. */
enum { PL_SECTION_INDENT = 2 };

/* Adds the verdicts on each engine, of several cases. */
void pl_section_verdicts(const pl_result_table *results, pl_document *document);

/* Adds the results for a terminal: each case with a row for each engine. */
void pl_section_cases(const pl_result_table *results, pl_document *document);

/* Adds the results in short: a row for each case, with a column for each engine. */
void pl_section_matrix(const pl_result_table *results, pl_document *document);

/* Adds the numbers that others published, for suites of which every case was run: its scenario and parameters, with any
 * time step and duration, which publications leave open. */
void pl_section_published(const pl_result_table *results, pl_document *document);

#endif
