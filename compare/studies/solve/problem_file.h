/* Files of contact problems, "plumb.contact_problem/1": one problem as a JSON object.
 *
 *   { "schema": "plumb.contact_problem/1",
 *     "source": { "scenario": "tower", "params": { "n": 10 }, "step": 60, ... },   optional, for
 * people "bodies": [ { "mass": 1, "inertia": [xx, xy, xz, yy, yz, zz], "free_velocity": [vx, vy,
 * vz, wx, wy, wz] } ], "manifolds": [ { "a": -1, "b": 0, "friction": 0.5, "frame": [n, t1, t2: nine
 * numbers], "arm_a": [x, y, z], "arm_b": [x, y, z], "points": [ { "offset": [n, t1, t2], "bias": 0,
 * "slip": [t1, t2], "impulse": [n, t1, t2] } ] } ] }
 *
 * What the numbers mean, their units and what must hold of them: plumb/contact_problem.h. -1 stands
 * for what is static; an arm of it may be left out, and so may a slip or an impulse of zero.
 * Numbers are written so that every bit survives. */
#ifndef PLUMB_PROBLEM_FILE_H
#define PLUMB_PROBLEM_FILE_H

#include "plumb/base.h"
#include "plumb/contact_problem.h"

#include <jansson.h>

enum { PL_MAX_PROBLEM_BYTES = 256 << 20 };

/* Reads a file ("-" is standard input) or text, of which `label` stands for the file's name. Any
 * fault is PL_BAD_INPUT with LABEL:LINE:COLUMN: path.to.field: what was expected, what was found.
 * The caller destroys *problem and drops *source, which is NULL where the file has none. */
pl_status pl_problem_read_file(const char *path, pe_contact_problem **problem, json_t **source,
                               pl_error *error);
pl_status pl_problem_read_text(const char *text, size_t length, const char *label,
                               pe_contact_problem **problem, json_t **source, pl_error *error);

/* The problem, which must be valid, as text, malloc'd; `source` is an object or NULL. NULL when out
 * of memory. */
char *pl_problem_to_text(const pe_contact_problem *problem, const json_t *source);

/* Writes it whole or not at all ("-" is standard output). PL_FAILED: the problem is not valid. */
pl_status pl_problem_write_file(const char *path, const pe_contact_problem *problem,
                                const json_t *source, pl_error *error);

/* A status and message of the engine as one of ours. */
pl_status pl_engine_error(pe_status status, const pe_error *from, pl_error *error);

#endif
