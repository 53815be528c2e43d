/* From results to rows. */
#ifndef PLUMB_GATE_GATHER_H
#define PLUMB_GATE_GATHER_H

#include "gate_rows.h"
#include "rules.h"

/* A file of results that was read. */
typedef struct pl_gate_file {
    const char *path;
    json_t *results;
} pl_gate_file;

/* Reads FILE, or FILE/results.jsonl where FILE is a directory; "-" is standard input. An incomplete
 * last line is left out and reported on standard error. The caller decrefs file->results. */
pl_status pl_gate_file_read(const char *path, pl_gate_file *file, pl_error *error);

/* Makes one row for each run, sorted; results that are equal in every key count once. Of engines
 * with the same label, the build that ran last counts; results of others are left out, which is
 * said on standard error. `files` must outlive *rows. PL_BAD_INPUT: a result lacks a key that identifies its run. The caller frees
 * *rows, also on failure. */
pl_status pl_gate_gather(const pl_gate_file *files, int count, const pl_gate_tolerances *tolerances,
                         pl_gate_rows *rows, pl_error *error);

#endif
