/* The file that results are held against: plumb.baseline/1 (SCHEMA.md). */
#ifndef PLUMB_GATE_BASELINE_H
#define PLUMB_GATE_BASELINE_H

#include "gate_row.h"

enum { PL_GATE_BASELINE_MOST_BYTES = 64 << 20 };

/* Rows, sorted. PL_BAD_INPUT: FILE:LINE:COLUMN: field: what was expected, what was found; also
 * where there is no such file. The caller frees, also on failure. */
pl_status pl_gate_baseline_read(const char *path, pl_gate_rows *rows, pl_error *error);

/* Writes all rows as they are, to a temporary name that is renamed when the file is whole. */
pl_status pl_gate_baseline_write(const char *path, const pl_gate_rows *rows, pl_error *error);

#endif
