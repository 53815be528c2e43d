/* The baseline that results are compared with: a file of plumb.baseline/1 (SCHEMA.md). */
#ifndef PLUMB_GATE_BASELINE_H
#define PLUMB_GATE_BASELINE_H

#include "gate_rows.h"

enum { PL_GATE_BASELINE_MOST_BYTES = 64 << 20 };

/* Reads the rows, sorted. PL_BAD_INPUT: FILE:LINE:COLUMN: field: what was expected, what was found;
 * also where there is no such file. The caller frees *rows, also on failure. */
pl_status pl_gate_baseline_read(const char *path, pl_gate_rows *rows, pl_error *error);

/* Writes all rows under a temporary name, and renames the file when it is complete. */
pl_status pl_gate_baseline_write(const char *path, const pl_gate_rows *rows, pl_error *error);

#endif
