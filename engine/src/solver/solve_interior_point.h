/* Primal-dual interior point method on the convex cone problem: the robust path. */
#ifndef PE_SOLVE_INTERIOR_POINT_H
#define PE_SOLVE_INTERIOR_POINT_H

#include "solve.h"
#include "sparse/factor.h"

/* Solves min 1/2 |v - v*|_M^2 subject to u + shift n in K*, cold, over the manifolds with
 * loaded[i] (NULL: all; the others get no impulse), with Nesterov and Todd's scaling
 * and Mehrotra's predictor and corrector: one factorisation and two solves an iteration. `shift`
 * (point_count), m/s, is held fixed: mu |u_t| of a former answer makes the answer true Coulomb,
 * where it repeats itself. Random problems of
 * a few bodies are solved to 1e-4 m/s, some not to 1e-6: it is there to find the active set. The
 * limits' tolerance is on the natural map of this convex problem, but
 * the report's residual is that of the true one. (Nesterov and Todd 1997; Mehrotra 1992; in the
 * form of Vandenberghe, The CVXOPT linear and quadratic cone program solvers, 2010.) */
pe_status pe_interior_point(const pe_problem *problem, const bool *loaded, const double *shift,
                            const pe_solve_limits *limits, pe_workspace work,
                            pe_solve_report *report, pe_error *error);

#endif
