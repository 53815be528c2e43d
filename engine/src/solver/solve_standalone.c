#include "solve_standalone.h"

#include "solve_direct.h"
#include "solve_interior_point.h"
#include "solve_newton.h"

#include <math.h>
#include <string.h>

pe_status pe_solve_newton(const pe_problem *problem, const pe_solve_limits *limits,
                          pe_workspace work, pe_solve_report *report, pe_error *error)
{
    pe_pattern pattern;
    pe_status status = pe_pattern_find(problem, NULL, work, &pattern, error);
    if (status != PE_OK) {
        return status;
    }
    const pe_newton_settings settings = pe_newton_settings_for(
        &pattern, pe_has_impulse(problem) ? PE_NEWTON_TRESCA : PE_NEWTON_CONE, limits->tolerance);
    return pe_newton(problem, &pattern, &settings, limits, work, report, error);
}

/* Rounds without a new best before the fixed point counts as lost. */
enum { MAX_WORSE = 4 };

pe_status pe_solve_interior_point(const pe_problem *problem, const pe_solve_limits *limits,
                                  pe_workspace work, pe_solve_report *report, pe_error *error)
{
    size_t points = (size_t)problem->point_count;
    double *shift = pe_take(work, points + 1, sizeof *shift);
    double(*best)[3] = pe_take(work, points + 1, sizeof *best);
    if (shift == NULL || best == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %zu contact points", points);
    }
    pe_residual least = pe_problem_residual(problem);
    memcpy(best, problem->impulse, points * sizeof *best);
    memset(shift, 0, points * sizeof *shift);
    for (int worse = 0; worse < MAX_WORSE && least.max > limits->tolerance &&
                        report->iterations < limits->max_iterations;) {
        pe_status status = pe_interior_point(problem, NULL, shift, limits, work, report, error);
        if (status != PE_OK) {
            return status;
        }
        pe_solve_shifts(problem, shift);
        ++worse;
        if (report->residual.max < least.max) {
            worse = 0;
            least = report->residual;
            memcpy(best, problem->impulse, points * sizeof *best);
        }
    }
    memcpy(problem->impulse, best, points * sizeof *best);
    pe_problem_rebuild_velocity(problem);
    report->residual = least;
    report->stop = least.max <= limits->tolerance                 ? PE_STOP_CONVERGED
                   : report->iterations >= limits->max_iterations ? PE_STOP_ITERATIONS
                                                                  : PE_STOP_STALLED;
    return PE_OK;
}

pe_status pe_solve_combined(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error)
{
    pe_pattern pattern;
    pe_status status = pe_pattern_find(problem, NULL, work, &pattern, error);
    return status != PE_OK ? status
                           : pe_solve_direct(problem, &pattern, !pe_has_impulse(problem), limits,
                                             work, report, error);
}
