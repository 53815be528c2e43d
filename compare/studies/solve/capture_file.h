/* Contact problems on their way from an engine to files. */
#ifndef PLUMB_CAPTURE_H
#define PLUMB_CAPTURE_H

#include "problem_file.h"

/* Where a capture is to go. */
typedef struct pl_capture_target {
    const char *path; /* "{}" in it stands for the island's number */
    long step;        /* from 1 */
    json_t *source;   /* of the problem file; gets step, island and islands besides */
} pl_capture_target;

/* Parses STEP:FILE; false where it is none. `path` is borrowed from `text`. */
bool pl_capture_parse(const char *text, long *step, const char **path);

/* Writes the island with the most contact points to the target's path, or where that has a "{}",
 * every island to its own file, numbered from 1 in the engine's order. PL_FAILED: there are no
 * contacts. A pl_capture's `take`: `user` is a pl_capture_target. Destroys the problems. */
pl_status pl_capture_write(void *user, pe_contact_problem **problems, int count, pl_error *error);

/* The index of the problem with the most points, the first of several; -1 when there is none. */
int pl_capture_largest(pe_contact_problem *const *problems, int count);

#endif
