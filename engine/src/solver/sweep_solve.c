#include "sweep_solve.h"

#include "momentum.h"
#include "sweep.h"

/* Sweeps between two looks at the residual: a look costs a half of a sweep. What a few sweeps solve
 * is seen to be solved sooner. */
enum { LOOK_INTERVAL = 10 };

static bool is_look(int sweeps)
{
    return sweeps % LOOK_INTERVAL == 0 || sweeps == 1 || sweeps == LOOK_INTERVAL / 2;
}

pe_status pe_sweep_solve(const pe_problem *problem, const pe_solve_limits *limits,
                         bool with_momentum, pe_workspace work, pe_solve_report *report,
                         pe_error *error)
{
    pe_sweep sweep;
    report->iterations = 0;
    report->factor_flops = 0;
    pe_status status = pe_sweep_create(problem, pe_sweep_kernel_for(0), work, &sweep, error);
    if (status != PE_OK) {
        return status;
    }
    double best = pe_sweep_residual(&sweep);
    pe_momentum momentum = pe_momentum_begin(best);
    for (int seen = 0; best > limits->tolerance && report->iterations < limits->max_iterations;) {
        pe_sweep_cones(&sweep, with_momentum ? pe_momentum_next(&momentum) : 0);
        int sweeps = ++report->iterations;
        if (is_look(sweeps) || sweeps == limits->max_iterations) {
            double residual = pe_sweep_residual(&sweep);
            pe_solve_note(report, sweeps, residual);
            pe_momentum_look(&momentum, sweeps - seen, residual);
            seen = sweeps;
            if (residual < best) {
                best = residual;
                pe_sweep_store(&sweep);
            }
        }
    }
    /* Rounding has gathered in the velocities: what counts is what the impulses give. */
    pe_problem_rebuild_velocity(problem);
    report->residual = pe_problem_residual(problem);
    report->stop =
        report->residual.max <= limits->tolerance ? PE_STOP_CONVERGED : PE_STOP_ITERATIONS;
    return PE_OK;
}
