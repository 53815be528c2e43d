/* Newton's method with Coulomb friction for problems of one or two bodies. */
#ifndef PE_SOLVE_TINY_H
#define PE_SOLVE_TINY_H

#include "solve.h"

enum { PE_TINY_BODIES = 2 };

/* Solves from problem->impulse a problem of at most PE_TINY_BODIES bodies by the proximal augmented
 * Lagrangian of solve_newton.h, with the friction bounded by mu times the normal impulse of the
 * iterate. That couples friction to the normal impulse in the derivative, which is then not
 * symmetric: of twelve rows at most, dense, and solved by elimination with pivots. (Alart and
 * Curnier 1991.) Iterations are eliminations, at most limits->max_iterations. The best impulses are
 * left. The caller sets report->residual to that of problem->impulse. */
pe_status pe_solve_tiny(const pe_problem *problem, const pe_solve_limits *limits, pe_workspace work,
                        pe_solve_report *report, pe_error *error);

#endif
