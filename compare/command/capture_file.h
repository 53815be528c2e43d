/* plumb run --capture STEP:FILE: the contact problems that an engine hands out at a step, as files
 * of the format that engine/tools/problem_file.h describes. */
#ifndef PLUMB_CAPTURE_FILE_H
#define PLUMB_CAPTURE_FILE_H

#include "plumb/base.h"
#include "plumb/contact_problem.h"

#include <jansson.h>

/* The destination of a capture. */
typedef struct pl_capture_target {
    const char *path; /* "{}" in it stands for the island's number */
    long step;        /* from 1 */
    json_t *source;   /* of the problem file; step, island and islands are added to it */
} pl_capture_target;

/* Parses STEP:FILE; false for anything else. `path` is borrowed from `text`. */
bool pl_capture_parse(const char *text, long *step, const char **path);

/* The path of that island, from 1: its "{}" is replaced by the number. The caller frees it. */
char *pl_capture_path(const char *path, int number);

/* Writes the island with the most contact points to the target's path; or, where the path has a
 * "{}", every island to its own file, numbered from 1 in the engine's order. PL_FAILED: there are
 * no contacts. It serves as a pl_capture's `take`, with a pl_capture_target as `user`, and destroys
 * the problems. */
pl_status pl_capture_write(void *user, pe_contact_problem **problems, int count, pl_error *error);

/* A valid problem as text, which the caller frees; `source` is an object or NULL. */
char *pl_capture_text(const pe_contact_problem *problem, const json_t *source);

#endif
