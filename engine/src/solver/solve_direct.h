/* The direct solver: what stands, slides or is nearly so is solved to rounding. */
#ifndef PE_SOLVE_DIRECT_H
#define PE_SOLVE_DIRECT_H

#include "solve.h"
#include "solve_newton.h"
#include "sparse/factor.h"

/* From the warm start, in this order, until the residual is met:
 *
 * 1. Newton in the Tresca form, or from nothing (`cold`) in the cone form;
 * 2. the interior point method on the convex problem, with De Saxce's shift renewed between rounds,
 *    each polished by Newton in the Tresca form.
 *
 * Iterations are factorisations. The best iterate of all is what is left. `pattern` counts the
 * manifolds that are expected to carry. */
pe_status pe_solve_direct(const pe_problem *problem, const pe_pattern *pattern, bool cold,
                          const pe_solve_limits *limits, pe_workspace work, pe_solve_report *report,
                          pe_error *error);

/* What it combines, for a problem of this depth. */
pe_newton_settings pe_newton_settings_for(const pe_pattern *pattern, pe_newton_form form,
                                          double enough);

/* De Saxce's shift mu |u_t| of each point at the velocities as they stand: shift (point_count),
 * m/s.
 */
void pe_solve_shifts(const pe_problem *problem, double *shift);

/* Whether there is any impulse to start from. */
bool pe_has_impulse(const pe_problem *problem);

#endif
