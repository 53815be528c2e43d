#include "solve_island.h"

#include "base/vec3.h"
#include "solve_direct.h"

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

/* The same of an island with no impulses to start from. Dense ones of millions of points, as where
 * a step of a second brings every body near every other, cost minutes. */
static const double COLD_PATIENCE = 16;

/* Islands of so few bodies are solved whole whatever happens to them. */
enum { TINY = 2 };

enum { LEAST_SWEEPS = 50, MOST_SWEEPS = 2000 };

/* Of so many iterations with a factor of so many flops. */
static double direct_cost(const pe_problem *problem, double flops, int iterations)
{
    return iterations * (NS_PER_FLOP * flops + NS_PER_ASSEMBLED_POINT * problem->point_count);
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

/* What an island gets of the direct solver: all of it, or a few Newton iterations about the sweeps.
 */
typedef struct plan {
    bool cold, whole, trial;
    int sweeps; /* at most */
    pe_pattern pattern;
} plan;

static void choose(const pe_problem *problem, const pe_island_limits *limits, double warm,
                   double flops, plan *to)
{
    double swept = NS_PER_SWEPT_POINT * problem->point_count * to->sweeps;
    double patience = to->cold ? COLD_PATIENCE : warm < QUIET ? limits->patience : 0;
    to->whole = problem->body_count <= TINY ||
                direct_cost(problem, flops, QUIET_ITERATIONS) <= patience * swept;
    to->trial = direct_cost(problem, flops, TRIAL_ITERATIONS) <= TRIAL_SHARE * swept;
}

static pe_status make_plan(const pe_problem *problem, const pe_island_limits *limits, double warm,
                           pe_workspace work, plan *to, pe_error *error)
{
    to->cold = !pe_has_impulse(problem);
    to->sweeps = sweep_limit(problem, limits);
    choose(problem, limits, warm, 0, to);
    if (!to->whole && !to->trial) {
        return PE_OK; /* not even with a factor for nothing */
    }
    bool *loaded = pe_take(work, (size_t)problem->manifold_count + 1, sizeof *loaded);
    if (loaded == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d manifolds", problem->manifold_count);
    }
    if (to->cold) {
        memset(loaded, true, (size_t)problem->manifold_count * sizeof *loaded);
    } else {
        pe_pattern_mark_loaded(problem, limits->tolerance, loaded);
    }
    /* What is in upheaval has other pairs at every step. */
    bool keeps = limits->store != NULL && (to->cold || warm < QUIET);
    pe_status status =
        keeps ? pe_pattern_store_find(limits->store, problem, loaded, work, &to->pattern, error)
              : pe_pattern_find(problem, loaded, work, &to->pattern, error);
    if (status == PE_OK) {
        choose(problem, limits, warm, to->pattern.flops, to);
    }
    return status;
}

static int fewer(int a, int b)
{
    return a < b ? a : b;
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
    plan chosen;
    report->path = PE_PATH_SWEEPS;
    pe_status status = make_plan(problem, limits, warm, work, &chosen, error);
    if (status == PE_OK && (chosen.whole || chosen.trial)) {
        int most = chosen.whole ? ALL_ITERATIONS : TRIAL_ITERATIONS;
        pe_solve_limits direct = {limits->tolerance, fewer(most, limits->max_iterations)};
        status = pe_solve_direct(problem, &chosen.pattern, chosen.cold, &direct, work,
                                 &report->solve, error);
        report->path = PE_PATH_DIRECT;
    }
    int left = limits->max_iterations - report->solve.iterations;
    if (status == PE_OK && left > 0 && report->solve.residual.max > limits->swept_tolerance) {
        report->path = PE_PATH_SWEEPS;
        pe_solve_limits swept = {limits->swept_tolerance, fewer(chosen.sweeps, left)};
        status = sweep(problem, &swept, work, &report->solve, error);
        if (status == PE_OK && chosen.trial && report->solve.residual.max < QUIET) {
            int most = report->solve.iterations + TRIAL_ITERATIONS;
            pe_solve_limits polish = {limits->tolerance, fewer(most, limits->max_iterations)};
            status = pe_solve_direct(problem, &chosen.pattern, false, &polish, work, &report->solve,
                                     error);
        }
    }
    if (report->solve.residual.max <= limits->tolerance) {
        report->path = PE_PATH_DIRECT;
    }
    return status;
}
