/* Results to rows. */
#ifndef PLUMB_GATE_GATHER_H
#define PLUMB_GATE_GATHER_H

#include "gate_row.h"
#include "limits.h"

/* A file of results, as read. */
typedef struct pl_gate_file {
    const char *path;
    json_t *results;
} pl_gate_file;

/* Reads FILE, or FILE/results.jsonl where it is a directory, "-" from standard input. A last line
 * that its writer did not finish is told on standard error. The caller decrefs file->results. */
pl_status pl_gate_file_read(const char *path, pl_gate_file *file, pl_error *error);

/* One row for each run, sorted; results that are equal in every key count once. `files` must
 * outlive *rows. PL_BAD_INPUT: a result lacks what tells its run. The caller frees, also on
 * failure. */
pl_status pl_gate_gather(const pl_gate_file *files, int count, const pl_gate_limits *limits,
                         pl_gate_rows *rows, pl_error *error);

#endif
