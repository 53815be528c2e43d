/* The law of baselines, for every target that has rows. */
#ifndef PLUMB_FUZZ_ROWS_H
#define PLUMB_FUZZ_ROWS_H

#include "fuzz_file.h"

#include "gate/baseline.h"

/* Rows that are written and read are the same rows. */
static inline void fuzz_rows_survive(const pl_gate_rows *rows)
{
    pl_error error = {.message = ""};
    pl_gate_rows again = {.count = 0};
    char path[FUZZ_PATH_SIZE];
    snprintf(path, sizeof path, "/dev/shm/plumb-fuzz-%ld.json", (long)getpid());
    fuzz_check(pl_gate_baseline_write(path, rows, &error) == PL_OK, "a baseline is written");
    fuzz_check(pl_gate_baseline_read(path, &again, &error) == PL_OK, "what was written is read");
    fuzz_check(again.count == rows->count, "there are as many rows");
    for (int i = 0; i < again.count; ++i) {
        fuzz_check(json_equal(again.items[i].json, rows->items[i].json), "a row stays the same");
    }
    unlink(path);
    pl_gate_rows_free(&again);
}

#endif
