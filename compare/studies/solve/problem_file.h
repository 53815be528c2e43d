/* Files of contact problems, "plumb.contact_problem/1": one problem as a JSON object.
 *
 *   { "schema": "plumb.contact_problem/1",
 *     "source": { "scenario": "tower", "params": { "n": 10 }, "step": 60, ... },
 *     "bodies": [ { "mass": 1, "inertia": [xx, xy, xz, yy, yz, zz],
 *                   "free_velocity": [vx, vy, vz, wx, wy, wz] } ],
 *     "manifolds": [ { "a": -1, "b": 0, "friction": 0.5, "frame": [n, t1, t2: nine numbers],
 *                      "arm_a": [x, y, z], "arm_b": [x, y, z],
 *                      "points": [ { "offset": [n, t1, t2], "bias": 0, "slip": [t1, t2],
 *                                    "impulse": [n, t1, t2] } ] } ] }
 *
 * plumb/contact_problem.h says what the numbers mean, their units and their constraints. "source"
 * is optional information for people. -1 stands for a static body. The arm of a static body may be
 * left out, and so may a slip or an impulse of zero. Numbers are written so that every bit
 * survives. */
#ifndef PLUMB_PROBLEM_FILE_H
#define PLUMB_PROBLEM_FILE_H

#include "plumb/base.h"
#include "plumb/contact_problem.h"

#include <jansson.h>

enum { PL_MAX_PROBLEM_BYTES = 256 << 20 };

/* Reads a file ("-" is standard input). PL_BAD_INPUT says FILE:LINE:COLUMN: path.to.field: what was
 * expected, what was found. The caller
 * destroys *problem and releases *source, which is NULL where the file has none. */
pl_status pl_problem_read_file(const char *path, pe_contact_problem **problem, json_t **source,
                               pl_error *error);

/* Reads text as pl_problem_read_file does a file; `label` stands for the file's name in messages.
 */
pl_status pl_problem_read_text(const char *text, size_t length, const char *label,
                               pe_contact_problem **problem, json_t **source, pl_error *error);

/* A valid problem as malloc'd text; `source` is an object or NULL. NULL when out of memory. */
char *pl_problem_to_text(const pe_contact_problem *problem, const json_t *source);

/* Writes the whole file or nothing ("-" is standard output). PL_FAILED: the problem is invalid. */
pl_status pl_problem_write_file(const char *path, const pe_contact_problem *problem,
                                const json_t *source, pl_error *error);

/* ---- Captures: contact problems that an engine hands out at a step ---- */

/* The destination of a capture. */
typedef struct pl_capture_target {
    const char *path; /* "{}" in it stands for the island's number */
    long step;        /* from 1 */
    json_t *source;   /* of the problem file; step, island and islands are added to it */
} pl_capture_target;

/* Parses STEP:FILE; false for anything else. `path` is borrowed from `text`. */
bool pl_capture_parse(const char *text, long *step, const char **path);

/* The path of that island, from 1, malloc'd: its "{}" is replaced by the number. NULL for a NULL path
 * and when out of memory. */
char *pl_capture_path(const char *path, int number);

/* Writes the island with the most contact points to the target's path; or, where the path has a
 * "{}", every island to its own file, numbered from 1 in the engine's order. PL_FAILED: there are
 * no contacts. It serves as a pl_capture's `take`, with a pl_capture_target as `user`, and destroys
 * the problems. */
pl_status pl_capture_write(void *user, pe_contact_problem **problems, int count, pl_error *error);

/* The index of the problem with the most points, the first of several; -1 when there is none. */
int pl_capture_largest(pe_contact_problem *const *problems, int count);

#endif
