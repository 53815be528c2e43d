/* Projected Gauss-Seidel with a round friction cone (Jourdan, Alart, Jean 1998), plain and with
 * momentum: with momentum a sweep starts at a point extrapolated from the last two. */
#include "solve.h"

#include "kernels.h"

/* ---- Momentum ---- */

/* Momentum at the start, and the rates and bounds at which 1 - beta adapts. */
static const double FIRST_BETA = 0.9;
static const double REST_GROWTH = 1.7, REST_DECAY = 0.7, MOST_REST = 0.5, LEAST_REST = 0.02;

/* A probe is a run of sweeps without momentum. It starts after so many sweeps without a gain, or
 * when the residual is so many times the best. */
enum { PROBE_SWEEPS = 20, PATIENCE_SWEEPS = 100 };
static const double GAIN = 0.9, DIVERGED = 30;

/* A probe shows that momentum was to blame if the residual falls below the first part of what it
 * was, and not to blame if it stays above the second. */
static const double TO_BLAME = 0.5, NOT_TO_BLAME = 0.8;

pe_momentum pe_momentum_begin(double residual)
{
    return (pe_momentum){.beta = FIRST_BETA, .best = residual};
}

double pe_momentum_next(pe_momentum *m)
{
    double nesterov = (double)m->sweeps / (m->sweeps + 3);
    m->sweeps += 1;
    return m->probe_left > 0 ? 0 : nesterov < m->beta ? nesterov : m->beta;
}

static void end_probe(pe_momentum *m, double residual)
{
    if (residual < TO_BLAME * m->before_probe) {
        double rest = REST_GROWTH * (1 - m->beta);
        m->beta = 1 - (rest < MOST_REST ? rest : MOST_REST);
    } else if (residual > NOT_TO_BLAME * m->before_probe) {
        double rest = REST_DECAY * (1 - m->beta);
        m->beta = 1 - (rest > LEAST_REST ? rest : LEAST_REST);
    }
    m->best = residual;
    m->since_gain = 0;
}

void pe_momentum_look(pe_momentum *m, int sweeps, double residual)
{
    if (m->probe_left > 0) {
        m->probe_left -= sweeps;
        if (m->probe_left <= 0) {
            m->probe_left = 0;
            end_probe(m, residual);
        }
    } else if (residual < GAIN * m->best) {
        m->best = residual;
        m->since_gain = 0;
    } else {
        m->since_gain += sweeps;
        if (m->since_gain >= PATIENCE_SWEEPS || residual > DIVERGED * m->best) {
            m->probe_left = PROBE_SWEEPS;
            m->before_probe = residual;
        }
    }
}

/* ---- The solvers ---- */

/* Sweeps between two evaluations of the residual, which costs half a sweep. The first ones come
 * sooner, so that problems which a few sweeps solve stop early. */
enum { LOOK_INTERVAL = 10 };

static bool is_look(int sweeps)
{
    return sweeps % LOOK_INTERVAL == 0 || sweeps == 1 || sweeps == LOOK_INTERVAL / 2;
}

/* Sweeps until the limits are met, and leaves the best iterate that was evaluated, the start
 * included. */
static pe_status solve(const pe_problem *problem, const pe_solve_limits *limits, bool with_momentum,
                       pe_workspace work, pe_solve_report *report, pe_error *error)
{
    pe_sweep sweep;
    report->iterations = 0;
    report->factor_flops = 0;
    pe_status status = pe_sweep_create(problem, pe_kernels_for(0)->sweep, work, &sweep, error);
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
    /* The sweeps add up rounding errors in the velocities. The impulses give them afresh. */
    pe_problem_rebuild_velocity(problem);
    report->residual = pe_problem_residual(problem);
    report->stop =
        report->residual.max <= limits->tolerance ? PE_STOP_CONVERGED : PE_STOP_ITERATIONS;
    return PE_OK;
}

pe_status pe_solve_gauss_seidel(const pe_problem *problem, const pe_solve_limits *limits,
                                pe_workspace work, pe_solve_report *report, pe_error *error)
{
    return solve(problem, limits, false, work, report, error);
}

pe_status pe_solve_momentum(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error)
{
    return solve(problem, limits, true, work, report, error);
}
