/* Files of contact problems, "plumb.contact_problem/1", as `plumb run --capture STEP:FILE` writes
 * them: one problem as a JSON object.
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
 * plumb/contact_problem.h explains the numbers, their units and their constraints. "source" is
 * optional information for people. -1 stands for a static body, whose arm can be left out. A slip
 * or an impulse of zero can be left out too. Numbers are written so that every bit survives. */
#ifndef PLUMB_PROBLEM_FILE_H
#define PLUMB_PROBLEM_FILE_H

#include "plumb/contact_problem.h"

#include <stddef.h>

enum { PROBLEM_MESSAGE_SIZE = 512 };

/* Reads a file. The caller destroys the problem. NULL: the file cannot be read or has a fault, and
 * `message` names the file, the field (or the line and column, where the text is no JSON), what was
 * expected and what was found. */
pe_contact_problem *problem_read_file(const char *path, char message[PROBLEM_MESSAGE_SIZE]);

/* Reads `length` bytes of text as problem_read_file does a file; `label` stands for the file's
 * name. */
pe_contact_problem *problem_read_text(const char *text, size_t length, const char *label,
                                      char message[PROBLEM_MESSAGE_SIZE]);

#endif
