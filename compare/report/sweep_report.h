/* The report of a sweep: from results to files for people and programs. */
#ifndef PLUMB_REPORT_SWEEP_REPORT_H
#define PLUMB_REPORT_SWEEP_REPORT_H

#include "studies/sweep/analysis.h"

#include <stdio.h>

/* Writes sweep.html (one self-contained page) and sweep.json (plumb.sweep/1) into `directory`,
 * which must exist; each is renamed into its place when whole. PL_IO: one cannot be written.
 * PL_NO_MEMORY. */
pl_status pl_sweep_report_write(const char *directory, const pl_sweep_analysis *analysis,
                                pl_error *error);

/* Prints tables as UTF-8 text: where plumb loses first. Control characters are shown as '?'. */
void pl_sweep_report_print(FILE *out, const pl_sweep_analysis *analysis);

#endif
