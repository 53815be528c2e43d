/* From results to rows. */
#ifndef PLUMB_GATE_GATHER_H
#define PLUMB_GATE_GATHER_H

#include "gate_rows.h"
#include "rules.h"

/* Reads FILE, or FILE/results.jsonl where FILE is a directory; "-" is standard input. An incomplete
 * last line is left out and reported on standard error. The caller decrefs *results. */
pl_status pl_gate_read(const char *path, json_t **results, pl_error *error);

/* Makes a row of each cell of the table, sorted. The table must outlive *rows, which the caller frees. */
void pl_gate_gather(const pl_result_table *results, const pl_gate_tolerances *tolerances,
                    pl_gate_rows *rows);

#endif
