#include "solve.h"
#include "sweep_solve.h"

pe_status pe_solve_gauss_seidel(const pe_problem *problem, const pe_solve_limits *limits,
                                pe_workspace work, pe_solve_report *report, pe_error *error)
{
    return pe_sweep_solve(problem, limits, false, work, report, error);
}
