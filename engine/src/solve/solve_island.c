#include "solve_island.h"

#include "solve_direct.h"
#include "vec.h"

#include <string.h>

/* Part of the tolerance within which a warm start is kept. Impulses that are kept without an
 * iteration leave the same error at every step, and bodies creep by it: a warm start must be far
 * better than a solve. */
static const double ACCEPT_WARM = 0.01;

/* Below this residual, in m/s, of its start an island is quiet: few iterations will do, and if they
 * do not, the whole of the direct solver is worth its price. Elsewhere Newton gets one try. */
static const double QUIET = 1e-3;
enum { QUIET_ITERATIONS = 4, TRIAL_ITERATIONS = 8, ALL_ITERATIONS = 200 };

/* Part of the price of all sweeps that such a try may cost. */
static const double TRIAL_SHARE = 0.25;

/* Costs in nanoseconds, measured once; only their ratios matter. */
static const double NS_PER_FLOP = 0.14, NS_PER_ASSEMBLED_POINT = 150, NS_PER_SWEPT_POINT = 15;

/* Islands of so few bodies are solved whole whatever happens to them. */
enum { TINY = 2 };

enum { LEAST_SWEEPS = 50, MOST_SWEEPS = 2000 };

static double direct_cost(const pe_problem *problem, const pe_pattern *pattern, int iterations)
{
    return iterations *
           (NS_PER_FLOP * pattern->flops + NS_PER_ASSEMBLED_POINT * problem->point_count);
}

static int sweep_limit(const pe_problem *problem, const pe_island_limits *limits)
{
    double most = pe_max(LEAST_SWEEPS, limits->max_updates / problem->point_count);
    return (int)pe_min(MOST_SWEEPS, most);
}

/* Sweeps from where the problem stands; what they find is kept if it is better. */
static pe_status sweep(const pe_problem *problem, const pe_solve_limits *limits, pe_workspace work,
                       pe_solve_report *report, pe_error *error)
{
    pe_solve_report swept = {.history = report->history};
    pe_status status = pe_solve_momentum(problem, limits, work, &swept, error);
    report->iterations += swept.iterations;
    report->residual = swept.residual;
    report->stop = swept.stop;
    return status;
}

pe_status pe_solve_island(const pe_problem *problem, const pe_island_limits *limits,
                          pe_workspace work, pe_island_report *report, pe_error *error)
{
    report->solve.residual = pe_problem_residual(problem);
    double warm = report->solve.residual.max;
    pe_solve_note(&report->solve, 0, warm);
    if (warm <= ACCEPT_WARM * limits->tolerance) {
        report->path = PE_PATH_WARM;
        report->solve.stop = PE_STOP_CONVERGED;
        return PE_OK;
    }
    pe_pattern pattern;
    bool *loaded = pe_take(work, (size_t)problem->patch_count + 1, sizeof *loaded);
    if (loaded == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d manifolds", problem->patch_count);
    }
    bool cold = !pe_has_impulse(problem);
    if (cold) {
        memset(loaded, true, (size_t)problem->patch_count * sizeof *loaded);
    } else {
        pe_pattern_mark_loaded(problem, limits->tolerance, loaded);
    }
    /* What is in upheaval has other pairs at every step. */
    bool keeps = limits->store != NULL && (cold || warm < QUIET);
    pe_status status =
        keeps ? pe_pattern_store_find(limits->store, problem, loaded, work, &pattern, error)
              : pe_pattern_find(problem, loaded, work, &pattern, error);
    if (status != PE_OK) {
        return status;
    }
    int sweeps = sweep_limit(problem, limits);
    double swept_cost = NS_PER_SWEPT_POINT * problem->point_count * sweeps;
    bool whole = cold || problem->body_count <= TINY ||
                 (warm < QUIET && direct_cost(problem, &pattern, QUIET_ITERATIONS) <=
                                      limits->patience * swept_cost);
    bool trial = direct_cost(problem, &pattern, TRIAL_ITERATIONS) <= TRIAL_SHARE * swept_cost;
    report->path = PE_PATH_SWEEPS;
    if (whole || trial) {
        report->path = PE_PATH_DIRECT;
        pe_solve_limits direct = {limits->tolerance, whole ? ALL_ITERATIONS : TRIAL_ITERATIONS};
        status = pe_solve_direct(problem, &pattern, cold, &direct, work, &report->solve, error);
    }
    if (status == PE_OK && report->solve.residual.max > limits->swept_tolerance) {
        report->path = PE_PATH_SWEEPS;
        pe_solve_limits swept = {limits->swept_tolerance, sweeps};
        status = sweep(problem, &swept, work, &report->solve, error);
        if (status == PE_OK && trial && report->solve.residual.max < QUIET) {
            pe_solve_limits polish = {limits->tolerance,
                                      report->solve.iterations + TRIAL_ITERATIONS};
            status =
                pe_solve_direct(problem, &pattern, false, &polish, work, &report->solve, error);
        }
    }
    if (report->solve.residual.max <= limits->tolerance) {
        report->path = PE_PATH_DIRECT;
    }
    return status;
}
