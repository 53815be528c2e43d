/* The law of baselines, for every target that has rows. */
#ifndef PLUMB_FUZZ_ROWS_H
#define PLUMB_FUZZ_ROWS_H

#include "fuzz_file.h"

#include "gate/gate.h"

/* Writes rows and reads them again into *read. */
static inline void fuzz_write_and_read(const pl_gate_rows *rows, pl_gate_rows *read)
{
    pl_error error = {.message = ""};
    char path[FUZZ_PATH_SIZE];
    snprintf(path, sizeof path, "/dev/shm/plumb-fuzz-%ld.json", (long)getpid());
    fuzz_check(pl_gate_baseline_write(path, rows, &error) == PL_OK, "a baseline is written");
    fuzz_check(pl_gate_baseline_read(path, read, &error) == PL_OK, "what was written is read");
    unlink(path);
}

/* Rows that are written and read are the same rows; integers among their numbers become real ones. */
static inline void fuzz_rows_survive(const pl_gate_rows *rows)
{
    pl_gate_rows second = {.count = 0}, third = {.count = 0};
    fuzz_write_and_read(rows, &second);
    fuzz_write_and_read(&second, &third);
    fuzz_check(second.count == rows->count && third.count == rows->count, "no row is lost");
    for (int i = 0; i < rows->count; ++i) {
        fuzz_check(strcmp(second.items[i].key, rows->items[i].key) == 0, "a key stays the same");
        fuzz_check(json_equal(second.items[i].json, third.items[i].json), "a row stays the same");
    }
    pl_gate_rows_free(&second);
    pl_gate_rows_free(&third);
}

#endif
