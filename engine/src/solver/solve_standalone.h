/* The methods that the engine combines, each alone: for experiments on captured problems. */
#ifndef PE_SOLVE_ALONE_H
#define PE_SOLVE_ALONE_H

#include "solve.h"

/* Newton in the Tresca form, or in the cone form when there is no impulse to start from. */
pe_status pe_solve_newton(const pe_problem *problem, const pe_solve_limits *limits,
                          pe_workspace work, pe_solve_report *report, pe_error *error);

/* The interior point method, cold, with De Saxce's shift renewed until it repeats itself: a fixed
 * point that not every problem has within reach. */
pe_status pe_solve_interior_point(const pe_problem *problem, const pe_solve_limits *limits,
                                  pe_workspace work, pe_solve_report *report, pe_error *error);

/* pe_solve_direct: both, as the engine chooses between them. */
pe_status pe_solve_combined(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error);

#endif
