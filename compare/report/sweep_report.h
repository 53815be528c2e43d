/* The report of a sweep: pages for people and data for programs. */
#ifndef PLUMB_REPORT_SWEEP_REPORT_H
#define PLUMB_REPORT_SWEEP_REPORT_H

#include "base/text_buffer.h"
#include "studies/sweep/analysis.h"

#include <stdio.h>

/* The analysis as plumb.sweep/2, with what is said of it in words: a new reference. */
json_t *pl_sweep_report_json(const pl_sweep_analysis *analysis);

/* Writes sweep.html and sweep.json (plumb.sweep/2) into `directory`, which must exist; each file is
 * renamed to its place when it is complete. PL_IO: one cannot be written. */
pl_status pl_sweep_report_write(const char *directory, const pl_sweep_analysis *analysis,
                                pl_error *error);

/* Prints tables as UTF-8 text, first where plumb loses. Control characters are shown as '?'. */
void pl_sweep_report_print(FILE *stream, const pl_sweep_analysis *analysis);

#endif
