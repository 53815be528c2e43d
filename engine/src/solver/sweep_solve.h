/* What Gauss-Seidel with and without momentum share. */
#ifndef PE_SWEEP_SOLVE_H
#define PE_SWEEP_SOLVE_H

#include "solve.h"

/* Sweeps until the limits are met, looking at the residual now and then, and leaves the best
 * iterate that was looked at, the start included. */
pe_status pe_sweep_solve(const pe_problem *problem, const pe_solve_limits *limits,
                         bool with_momentum, pe_workspace work, pe_solve_report *report,
                         pe_error *error);

#endif
