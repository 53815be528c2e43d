/* Gauss-Seidel at a point extrapolated from the last two; momentum.h says how far. */
#include "solve.h"
#include "sweep_solve.h"

pe_status pe_solve_momentum(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error)
{
    return pe_sweep_solve(problem, limits, true, work, report, error);
}
