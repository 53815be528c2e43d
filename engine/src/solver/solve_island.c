#include "solve_island.h"

#include "base/vec3.h"
#include "solve_interior_point.h"

#include <math.h>
#include <string.h>

/* ---- The direct solver ---- */

enum { FIRST_ITERATIONS = 8, ROUNDS = 3, INTERIOR_ITERATIONS = 60, REFINE_ITERATIONS = 30 };

/* The best impulses so far. */
typedef struct keeper {
    const pe_problem *problem;
    double (*impulse)[3];
    pe_residual residual;
} keeper;

static void keep_if_better(keeper *best, pe_residual residual)
{
    if (residual.max < best->residual.max) {
        best->residual = residual;
        memcpy(best->impulse, best->problem->impulse,
               (size_t)best->problem->point_count * sizeof *best->impulse);
    }
}

static void restore(const keeper *best)
{
    memcpy(best->problem->impulse, best->impulse,
           (size_t)best->problem->point_count * sizeof *best->impulse);
    pe_problem_rebuild_velocity(best->problem);
}

static const double INTERIOR_ENOUGH = 1e-4; /* m/s: where the refinement starts */

/* The limit of iterations for `more` of them, within the caller's. */
static int bound(const pe_solve_report *report, int more, const pe_solve_limits *limits)
{
    int most = report->iterations + more;
    return most < limits->max_iterations ? most : limits->max_iterations;
}

/* Rounds of the interior point method, each with the shift of the last one and then refined. */
static pe_status solve_by_interior(keeper *best, const pe_pattern *pattern,
                                   const pe_solve_limits *limits, pe_workspace work,
                                   pe_solve_report *report, pe_error *error)
{
    const pe_problem *problem = best->problem;
    pe_newton_settings refine = {pattern, PE_NEWTON_TRESCA,  1e-3,
                                 1e-7,    PE_NEWTON_UPDATES, limits->tolerance};
    double *shift = pe_take(work, (size_t)problem->point_count + 1, sizeof *shift);
    if (shift == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %d contact points",
                       problem->point_count);
    }
    restore(best);
    for (int round = 0; round < ROUNDS && best->residual.max > limits->tolerance &&
                        report->iterations < limits->max_iterations;
         ++round) {
        pe_problem_find_shifts(problem, shift);
        pe_solve_limits inner = {INTERIOR_ENOUGH, bound(report, INTERIOR_ITERATIONS, limits)};
        pe_status status = pe_interior_point(problem, &(pe_convex_form){pattern->counted, shift},
                                             &inner, work, report, error);
        if (status != PE_OK) {
            return status;
        }
        keep_if_better(best, report->residual);
        /* The next round's shift is that of this round, with any outcome of the refinement. */
        pe_problem_find_shifts(problem, shift);
        inner = (pe_solve_limits){limits->tolerance, bound(report, REFINE_ITERATIONS, limits)};
        status = pe_newton(problem, &refine, &inner, work, report, error);
        if (status != PE_OK) {
            return status;
        }
        keep_if_better(best, report->residual);
    }
    return PE_OK;
}

pe_status pe_solve_direct(const pe_problem *problem, const pe_newton_settings *settings,
                          const pe_solve_limits *limits, pe_workspace work, pe_solve_report *report,
                          pe_error *error)
{
    keeper best = {
        .problem = problem,
        .impulse = pe_take(work, (size_t)problem->point_count + 1, sizeof *best.impulse),
        .residual.max = HUGE_VAL,
    };
    if (best.impulse == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %d contact points",
                       problem->point_count);
    }
    memcpy(best.impulse, problem->impulse, (size_t)problem->point_count * sizeof *best.impulse);
    keep_if_better(&best, pe_problem_residual(problem));
    /* The tolerance is tighter than asked for, so that impulses which later steps keep do not
     * drift. */
    pe_solve_limits inner = {1e-3 * limits->tolerance, bound(report, FIRST_ITERATIONS, limits)};
    pe_status status = pe_newton(problem, settings, &inner, work, report, error);
    if (status == PE_OK) {
        keep_if_better(&best, report->residual);
        if (best.residual.max > limits->tolerance) {
            status = solve_by_interior(&best, settings->pattern, limits, work, report, error);
        }
    }
    restore(&best);
    report->residual = best.residual;
    report->stop = best.residual.max <= limits->tolerance         ? PE_STOP_CONVERGED
                   : report->iterations >= limits->max_iterations ? PE_STOP_ITERATIONS
                                                                  : PE_STOP_STALLED;
    return status;
}

pe_status pe_solve_combined(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error)
{
    pe_pattern pattern;
    pe_newton_settings settings;
    pe_status status = pe_newton_prepare(problem, limits, work, &pattern, &settings, error);
    return status != PE_OK ? status
                           : pe_solve_direct(problem, &settings, limits, work, report, error);
}

/* ---- The choice ---- */

/* Part of the tolerance within which a warm start is kept. Impulses that are kept without an
 * iteration leave the same error at every step, and bodies creep by it: a warm start must be far
 * better than a solve. */
static const double ACCEPT_WARM = 0.01;

/* An island is quiet if the residual of its warm start is below this, in m/s. Few iterations are
 * then enough; if not, the whole direct solver is worth its cost. Otherwise Newton's method gets
 * one try. */
static const double QUIET = 1e-3;
enum { QUIET_ITERATIONS = 4, TRIAL_ITERATIONS = 8, ALL_ITERATIONS = 200 };

/* Part of the cost of all sweeps that such a try may have. */
static const double TRIAL_SHARE = 0.25;

/* Costs in nanoseconds, measured once; only their ratios matter. */
static const double NS_PER_FLOP = 0.14, NS_PER_ASSEMBLED_POINT = 150, NS_PER_SWEPT_POINT = 15;

/* The patience with an island without impulses to start from. Dense islands of millions of points,
 * such as a step of one second makes of many bodies, would cost minutes. */
static const double COLD_PATIENCE = 16;

/* Islands of so few bodies always get the whole direct solver. */
enum { TINY = 2 };

enum { LEAST_SWEEPS = 50, MOST_SWEEPS = 2000 };

/* Predicted cost of iterations with a factor of so many flops. */
static double direct_cost(const pe_problem *problem, double flops, int iterations)
{
    return iterations * (NS_PER_FLOP * flops + NS_PER_ASSEMBLED_POINT * problem->point_count);
}

static int sweep_limit(const pe_problem *problem, const pe_island_limits *limits)
{
    double most = pe_max(LEAST_SWEEPS, limits->max_updates / problem->point_count);
    return (int)pe_min(MOST_SWEEPS, most);
}

typedef struct plan {
    bool cold;  /* no impulse to start from */
    bool whole; /* the whole direct solver */
    bool trial; /* a few Newton iterations before and after the sweeps */
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
    to->cold = !pe_problem_has_impulse(problem);
    to->sweeps = sweep_limit(problem, limits);
    choose(problem, limits, warm, 0, to);
    if (!to->whole && !to->trial) {
        return PE_OK; /* too expensive even if the factor were free */
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
    /* An island that is not quiet has other pairs at every step. */
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
    pe_solve_report *solve = &report->solve;
    solve->residual = pe_problem_residual(problem);
    double warm = solve->residual.max;
    pe_solve_note(solve, 0, warm);
    if (warm <= ACCEPT_WARM * limits->tolerance) {
        report->path = PE_PATH_WARM;
        solve->stop = PE_STOP_CONVERGED;
        return PE_OK;
    }
    plan chosen;
    report->path = PE_PATH_SWEEPS;
    pe_status status = make_plan(problem, limits, warm, work, &chosen, error);
    if (status == PE_OK && (chosen.whole || chosen.trial)) {
        int most = chosen.whole ? ALL_ITERATIONS : TRIAL_ITERATIONS;
        pe_solve_limits direct = {limits->tolerance, fewer(most, limits->max_iterations)};
        pe_newton_settings settings = pe_newton_settings_for(
            &chosen.pattern, chosen.cold ? PE_NEWTON_CONE : PE_NEWTON_TRESCA, limits->tolerance);
        status = pe_solve_direct(problem, &settings, &direct, work, solve, error);
        report->path = PE_PATH_DIRECT;
    }
    int left = limits->max_iterations - solve->iterations;
    if (status == PE_OK && left > 0 && solve->residual.max > limits->swept_tolerance) {
        report->path = PE_PATH_SWEEPS;
        pe_solve_limits swept = {limits->swept_tolerance, fewer(chosen.sweeps, left)};
        pe_solve_report sweeps = {.history = solve->history};
        status = pe_solve_momentum(problem, &swept, work, &sweeps, error);
        solve->iterations += sweeps.iterations;
        solve->residual = sweeps.residual;
        solve->stop = sweeps.stop;
        if (status == PE_OK && chosen.trial && solve->residual.max < QUIET) {
            int most = solve->iterations + TRIAL_ITERATIONS;
            pe_solve_limits refine = {limits->tolerance, fewer(most, limits->max_iterations)};
            pe_newton_settings settings =
                pe_newton_settings_for(&chosen.pattern, PE_NEWTON_TRESCA, limits->tolerance);
            status = pe_solve_direct(problem, &settings, &refine, work, solve, error);
        }
    }
    if (solve->residual.max <= limits->tolerance) {
        report->path = PE_PATH_DIRECT;
    }
    return status;
}
