/* Primal-dual interior point method on the convex cone problem: robust from a cold start. (Nesterov
 * and Todd 1997; Mehrotra 1992.) */
#ifndef PE_SOLVE_INTERIOR_POINT_H
#define PE_SOLVE_INTERIOR_POINT_H

#include "solve.h"

/* The convex problem: min 1/2 |v - v*|_M^2 subject to u + shift n in K*. */
typedef struct pe_convex_form {
    const bool *loaded;  /* (manifold_count): those that take part; NULL: all */
    const double *shift; /* (point_count), m/s, held fixed. mu |u_t| of the answer before makes the
                            answer true Coulomb friction, once it repeats itself. */
} pe_convex_form;

/* Solves the convex problem from a cold start: one factorisation and two solves an iteration.
 * Random problems of a few bodies are solved to 1e-4 m/s, some not to 1e-6: the method is there to
 * find the active set. The limits' tolerance is on the natural map of the convex problem, but the
 * report's residual is that of the true one. */
pe_status pe_interior_point(const pe_problem *problem, const pe_convex_form *form,
                            const pe_solve_limits *limits, pe_workspace work,
                            pe_solve_report *report, pe_error *error);

#endif
