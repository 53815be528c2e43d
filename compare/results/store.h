/* results.jsonl: one result a line, appended as runs end, so that a killed job loses at most the
 * run in progress. One process at a time may write a file. */
#ifndef PLUMB_STORE_H
#define PLUMB_STORE_H

#include "base/text_buffer.h"
#include "plumb/base.h"

#include <jansson.h>
#include <stdbool.h>

/* Reads a file of results into a new array. `whole`, when not NULL, gets the length in bytes up to
 * the end of the last complete line: text after it is a line that its writer did not finish, and is
 * ignored. PL_BAD_INPUT: FILE:LINE:COLUMN of a complete line that is no plumb.result/1. PL_IO:
 * not readable. */
pl_status pl_results_read(const char *path, json_t **results, long long *whole, pl_error *error);

/* Writes text to `path` ("-" is standard output): to a temporary name next to it, renamed when
 * complete and on the disk. An existing path that is no regular file (a pipe, a device) is written directly. */
pl_status pl_write_text(const char *path, const char *text, size_t length, pl_error *error);

/* pl_write_text of a buffer, which is empty then. */
pl_status pl_write_buffer(const char *path, pl_text_buffer *text, pl_error *error);

/* Whether `path`, which may be NULL, is "-". */
bool pl_is_stdout(const char *path);

/* PL_BAD_INPUT where `path` is a file that is not empty, which a command is to replace only with
 * `force`. NULL, "-" and a path that is no regular file are accepted. */
pl_status pl_output_check(const char *path, bool force, pl_error *error);

/* Writes JSON as text in the same way; nothing where `path` is NULL. */
pl_status pl_results_write_json(const char *path, const json_t *value, pl_error *error);

/* Makes a directory and its parents, where they are missing. */
pl_status pl_make_directories(const char *directory, pl_error *error);

/* What becomes of a file of results that has some already. */
typedef enum pl_store_mode {
    PL_STORE_NEW,    /* it is refused */
    PL_STORE_RESUME, /* they stay, and an unfinished last line is cut off */
    PL_STORE_REPLACE /* it stays under the name FILE.replaced until pl_store_finish */
} pl_store_mode;

/* The mode of --resume and --force; PL_STORE_NEW without. */
pl_store_mode pl_store_mode_of(bool resume, bool force);

/* An open file of results. */
typedef struct pl_store pl_store;

/* Opens DIRECTORY/results.jsonl, making the directory where it is missing. PL_BAD_INPUT, which
 * changes nothing: a line that is no result, or, with PL_STORE_NEW, any result or one of the files
 * `others` of the directory, names up to a NULL (NULL: none). PL_IO also when another process has it
 * open for writing. */
pl_status pl_store_open(const char *directory, pl_store_mode mode, const char *const *others,
                        pl_store **store, pl_error *error);

/* The file is complete: one that it replaces is removed. */
void pl_store_finish(pl_store *store);

/* Closes the file; NULL is allowed. A file that it should replace comes back if nothing was written. */
void pl_store_close(pl_store *store);

/* All results of the file, oldest first. Borrowed until the store is closed. */
json_t *pl_store_results(pl_store *store);

/* Its results by the hashes of their runs, an object. Borrowed until the store is closed. */
const json_t *pl_store_runs(const pl_store *store);

/* The first result of the file of this run, by its `run` hash; NULL: none. Borrowed until the store is closed. */
json_t *pl_store_find(const pl_store *store, const char *run);

/* Appends one result by one write and flushes it to the disk. When that fails the file is cut back
 * to the lines it had. Keeps its own reference. */
pl_status pl_store_append(pl_store *store, json_t *result, pl_error *error);

#endif
