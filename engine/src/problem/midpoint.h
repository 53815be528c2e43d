/* The contact problem of a step in the middle of it: what makes smooth motion second order. */
#ifndef PE_PROBLEM_MIDDLE_H
#define PE_PROBLEM_MIDDLE_H

#include "problem_build.h"

/* A contact's force acts, in the mean over the step, where its arms are in the middle of it; with
 * the arms of the start the step is first order. A manifold whose points are fixed in one body, and
 * whose normal in one, since the contacts of the last step (corners on a face), is carried by both
 * to there, with their mean velocities as the warm start has them, and
 *
 *   b = (J_end - J_mid) v' + part of the gap / h     since it is the end that must not approach,
 *   b_t = J_mid (v - v')/2                           where a slip goes on: friction opposes its
 *                                                    mean, while what stops takes that of its end.
 *
 * Impulses of the warm start are turned with the slip. Islands of more than two bodies are left as
 * they are, and those in which something strikes: an impact's impulse acts at the start of the
 * step. So are manifolds that wander over both bodies, as those of spheres do, whose arms turn in
 * another way; and those whose v does not fit to begin with, after an impact or a step without
 * this.
 *
 * `built` is in step with its impulses, and is again afterwards; `manifold`, `point` and
 * `normal_change` are its arrays, `source` (manifold_count) the world's of each manifold. */
pe_status pe_problem_to_midpoint(pe_world *world, const pe_island_problem *built, const int *source,
                                 const pe_free_motion *free, double dt,
                                 pe_solver_manifold *manifold, pe_solver_point *point,
                                 double *normal_change, pe_error *error);

#endif
