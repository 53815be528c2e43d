/* A problem with some of another's manifolds. */
#ifndef PE_PROBLEM_SELECT_H
#define PE_PROBLEM_SELECT_H

#include "base/memory.h"
#include "problem.h"

/* The manifolds with selected[i] (NULL: all), their points packed, impulses copied; bodies and
 * velocities are shared with `problem`. point_of (part->point_count) has each point's index in it.
 */
pe_status pe_problem_select(const pe_problem *problem, const bool *selected, pe_workspace work,
                            pe_problem *part, int **point_of, pe_error *error);

#endif
