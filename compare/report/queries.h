/* Questions of reports to a table of results. */
#ifndef PLUMB_REPORT_QUERIES_H
#define PLUMB_REPORT_QUERIES_H

#include "base/text_buffer.h"
#include "results/result_table.h"

/* Whether the metric is the case's primary error, so that reference_error is the same. */
bool pl_case_primary_is(const pl_result_case *test_case, int metric);

/* Whether the case is that of a suite's entry: its scenario and parameters, with any time step and
 * duration, which publications leave open. */
bool pl_case_is_entry(const pl_result_case *test_case, const pl_suite_entry *entry);

enum { PL_CELL_TIME_SIZE = 2 * PL_METRIC_TEXT_SIZE + 8 };

/* Writes the time of a step by `write`, pl_metric_text or pl_metric_spread_text; of a configuration that
 * asks for several threads the elapsed time too: "12.3 ms, wall 6.8 ms". */
void pl_cell_time_text(const pl_result_configuration *configuration, const pl_result_cell *cell,
                       void (*write)(const pl_metric_summary *summary,
                                     char text[PL_METRIC_TEXT_SIZE]),
                       char text[PL_CELL_TIME_SIZE]);

/* Returns the least time of a step over native engines whose outcome is ok; INFINITY without any. */
double pl_case_least_time(const pl_result_table *results, const pl_result_case *test_case);

/* Adds the names of the configurations of the home engine, or of the others, separated by commas. */
void pl_add_engine_names(const pl_result_table *results, bool home, pl_text_buffer *out);

/* Adds the settings of a configuration's engine, as "name = value", in plain text: those of its first run.
 * The time step and the duration, which belong to the case, are left out. */
void pl_add_settings(const pl_result_table *results, int configuration, pl_text_buffer *out);

#endif
