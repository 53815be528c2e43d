/* results.jsonl: one result a line, appended as runs end, so that a killed job loses at most the
 * run in progress. One process at a time may write a file. */
#ifndef PLUMB_STORE_H
#define PLUMB_STORE_H

#include "plumb/base.h"

#include <jansson.h>
#include <stdbool.h>

/* Reads a file of results into a new array. `whole`, when not NULL, gets the length in bytes up to
 * the end of the last complete line: text after it is a line that its writer did not finish, and is
 * ignored. PL_BAD_INPUT: FILE:LINE:COLUMN of a complete line that is no plumb.result/1. PL_IO:
 * not readable. */
pl_status pl_results_read(const char *path, json_t **results, long long *whole, pl_error *error);

/* Writes text to `path` ("-" is standard output): to a temporary name next to it, renamed when
 * complete. An existing path that is no regular file (a pipe, a device) is written directly. */
pl_status pl_write_text(const char *path, const char *text, size_t length, pl_error *error);

/* Whether `path`, which may be NULL, is "-". */
bool pl_is_stdout(const char *path);

/* Writes JSON as text in the same way; nothing where `path` is NULL. */
pl_status pl_results_write_json(const char *path, const json_t *value, pl_error *error);

/* Makes a directory and its parents, where they are missing. */
pl_status pl_make_directories(const char *directory, pl_error *error);

/* An open file of results. */
typedef struct pl_store pl_store;

/* Opens DIRECTORY/results.jsonl, making the directory where it is missing. With `resume`, the
 * results there stay and an unfinished last line is cut off; PL_BAD_INPUT changes nothing. Without,
 * the file begins empty. PL_IO also when another process has it open for writing. */
pl_status pl_store_open(const char *directory, bool resume, pl_store **store, pl_error *error);

/* Closes the file; NULL is allowed. */
void pl_store_close(pl_store *store);

/* All results of the file, oldest first. Borrowed until the store is closed. */
json_t *pl_store_results(pl_store *store);

/* Whether the file has a result of this run, by its `run` hash. */
bool pl_store_has(const pl_store *store, const char *run);

/* Appends one result by one write and flushes it to the disk. When that fails the file is cut back
 * to the lines it had. Keeps its own reference. */
pl_status pl_store_append(pl_store *store, json_t *result, pl_error *error);

#endif
