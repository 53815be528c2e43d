#include "solve_island.h"

#include "base/vec3.h"
#include "solve.h"
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
    for (int round = 0;
         round < ROUNDS && best->residual.max > limits->tolerance &&
         report->iterations < limits->max_iterations && pe_solve_may_factor(report, pattern->flops);
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
    if (status == PE_OK && !pe_solve_may_factor(report, pattern.flops)) {
        report->residual = pe_problem_residual(problem);
        report->stop = PE_STOP_ITERATIONS;
        return PE_OK;
    }
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

/* Residuals below this, in m/s, may be rounding: a direct solver that ends there has not failed. */
static const double ROUNDING = 1e-9;

/* Bounds on the iterations of the direct solver from a warm start: so many points in all of them,
 * but at least LEAST_WARM and at most MOST_WARM iterations. An island that takes more changes too
 * much from step to step, and sweeps serve it better. */
enum { WARM_POINTS = 6000, LEAST_WARM = 12, MOST_WARM = 48 };

/* A chain, such as a stack, has at most so many manifolds a body. Its factor is cheap. It may also
 * be about to fall, which a less exact solution would not show: then the energy guard holds it. */
static const double CHAIN = 1.5;

static bool is_chain(const pe_problem *problem)
{
    return problem->body_count > PE_TINY_BODIES &&
           problem->manifold_count <= CHAIN * problem->body_count;
}

/* The most iterations of the direct solver from a warm start. */
static int warm_iterations(const pe_problem *problem)
{
    if (is_chain(problem)) {
        return ALL_ITERATIONS;
    }
    int most = WARM_POINTS / problem->point_count;
    return most > MOST_WARM ? MOST_WARM : most < LEAST_WARM ? LEAST_WARM : most;
}

/* Where the residual is below this, in m/s, a few Newton iterations pay even if the direct solver
 * failed before. */
static const double NEAR = 1e-6;

/* Part of the cost of all sweeps that one try of Newton's method may have. */
static const double TRIAL_SHARE = 0.25;

/* Costs in nanoseconds, measured once; only their ratios matter. */
static const double NS_PER_FLOP = 0.14, NS_PER_ASSEMBLED_POINT = 150, NS_PER_SWEPT_POINT = 15;

/* The patience with an island without impulses to start from. Dense islands of millions of points,
 * such as a step of one second makes of many bodies, would cost minutes. */
static const double COLD_PATIENCE = 16;

/* All iterations of a direct solve may cost this many times what QUIET_ITERATIONS, which it is chosen
 * by, may. */
static const double WHOLE_COST = 8;

/* Of islands of at most PE_TINY_BODIES bodies. One that is not quiet is solved roughly at ROUGH times
 * the tolerance. */
enum { TINY_ITERATIONS = 16, TINY_SWEEPS = 20 };
static const double ROUGH = 100;

/* Sweeps that are allowed with any max_updates, and at most. */
enum { LEAST_SWEEPS = 50, MOST_SWEEPS = 2000 };

static bool is_tiny(const pe_solving *s)
{
    return s->problem->body_count <= PE_TINY_BODIES;
}

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

/* How many times the cost of the allowed sweeps the iterations of a direct solve may have. */
static double patience_of(const pe_solving *s, bool cold, double warm)
{
    return cold ? COLD_PATIENCE : warm < QUIET ? s->limits.patience : 0;
}

static double swept_cost(const pe_problem *problem, int sweeps)
{
    return NS_PER_SWEPT_POINT * problem->point_count * sweeps;
}

static void choose(const pe_solving *s, double flops, pe_island_plan *to)
{
    const pe_problem *problem = s->problem;
    double warm = s->report.solve.residual.max;
    double swept = swept_cost(problem, to->sweeps);
    double patience = patience_of(s, to->cold, warm);
    to->whole = is_tiny(s) || direct_cost(problem, flops, QUIET_ITERATIONS) <= patience * swept;
    to->trial = TRIAL_ITERATIONS * problem->point_count <= WARM_POINTS &&
                direct_cost(problem, flops, TRIAL_ITERATIONS) <= TRIAL_SHARE * swept;
}

/* Whether the direct solver gets no more than a few iterations, and these only near the solution. */
static bool waits(const pe_solving *s)
{
    const bool quiet = s->report.solve.residual.max < QUIET;
    return s->limits.direct_waits && !is_tiny(s) && !(is_chain(s->problem) && quiet);
}

/* Fills s->plan. */
static pe_status make_plan(pe_solving *s, pe_workspace work, pe_error *error)
{
    const pe_problem *problem = s->problem;
    const pe_island_limits *limits = &s->limits;
    pe_island_plan *to = &s->plan;
    double warm = s->report.solve.residual.max;
    *to = (pe_island_plan){.cold = !pe_problem_has_impulse(problem),
                           .sweeps = sweep_limit(problem, limits)};
    if (waits(s) && (warm > NEAR || warm <= limits->tolerance)) {
        return PE_OK;
    }
    choose(s, 0, to);
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
        choose(s, to->pattern.flops, to);
    }
    return status;
}

/* An island whose residual is within the tolerance of sweeps gets a few in each step, down to this
 * (m/s): at rest every step continues the last one. */
static const double SETTLED = 1e-7;
enum { SETTLING_SWEEPS = 10 };
static const double SETTLING_GAIN = 0.99;

static int fewer(int a, int b)
{
    return a < b ? a : b;
}

/* At most `most` iterations of the direct solver, and no more than may be paid for. */
static pe_status solve_directly(pe_solving *s, int most, pe_newton_form form, pe_workspace work,
                                pe_error *error)
{
    pe_solve_report *solve = &s->report.solve;
    const pe_island_plan *plan = &s->plan;
    const double tolerance = s->limits.tolerance;
    const double patience = pe_max(1, patience_of(s, plan->cold, s->warm));
    const double cost = WHOLE_COST * patience * swept_cost(s->problem, plan->sweeps);
    const double affordable = cost / direct_cost(s->problem, plan->pattern.flops, 1);
    most = affordable < most ? (int)affordable : most;
    most += solve->iterations;
    solve->most_flops = solve->factor_flops + cost / NS_PER_FLOP;
    pe_solve_limits direct = {tolerance, fewer(most, s->limits.max_iterations)};
    pe_newton_settings settings = pe_newton_settings_for(&s->plan.pattern, form, tolerance);
    return pe_solve_direct(s->problem, &settings, &direct, work, solve, error);
}

/* Plans the island, and runs the direct solver where the plan has it; if `brief`, as a trial. */
static pe_status try_directly(pe_solving *s, bool brief, pe_workspace work, pe_error *error)
{
    const pe_island_plan *plan = &s->plan;
    pe_status status = make_plan(s, work, error);
    if (status != PE_OK || !(plan->whole || plan->trial)) {
        return status;
    }
    int most = waits(s)                ? QUIET_ITERATIONS
               : !plan->whole || brief ? TRIAL_ITERATIONS
               : plan->cold            ? ALL_ITERATIONS
                                       : warm_iterations(s->problem);
    return solve_directly(s, most, plan->cold ? PE_NEWTON_CONE : PE_NEWTON_TRESCA, work, error);
}

static pe_status solve_tiny(pe_solving *s, pe_workspace work, pe_error *error)
{
    pe_solve_report *solve = &s->report.solve;
    pe_solve_limits limits = {s->limits.tolerance,
                              fewer(solve->iterations + TINY_ITERATIONS, s->limits.max_iterations)};
    return pe_solve_tiny(s->problem, &limits, work, solve, error);
}

/* Asks for at most `most` sweeps, to `enough` (m/s). */
static void ask_for_sweeps(pe_solving *s, int most, double enough)
{
    s->sweeps = fewer(most, s->limits.max_iterations - s->report.solve.iterations);
    s->before = s->report.solve.residual.max;
    s->enough = enough;
}

/* Newton's method with friction, then a trial of the direct solver. */
static pe_status begin_tiny(pe_solving *s, pe_workspace work, pe_error *error)
{
    const pe_solve_report *solve = &s->report.solve;
    const double tolerance = s->limits.tolerance;
    const bool rough = s->limits.rough && !(solve->residual.max < QUIET);
    const double near = rough ? ROUGH * tolerance : tolerance;
    s->least_aim = rough ? s->limits.swept_tolerance : tolerance;
    pe_status status = solve_tiny(s, work, error);
    if (status == PE_OK && solve->residual.max > near) {
        status = try_directly(s, true, work, error);
    }
    if (solve->residual.max > near) {
        ask_for_sweeps(s, TINY_SWEEPS, tolerance);
    }
    return status;
}

/* The direct solver as planned. */
static pe_status begin_larger(pe_solving *s, pe_workspace work, pe_error *error)
{
    const pe_island_limits *limits = &s->limits;
    pe_status status = try_directly(s, false, work, error);
    const double left = s->report.solve.residual.max;
    if (left > limits->swept_tolerance) {
        ask_for_sweeps(s, fewer(s->plan.sweeps, limits->most_sweeps), limits->swept_tolerance);
    } else if (left > pe_max(SETTLED, limits->tolerance) && !limits->settling_waits) {
        ask_for_sweeps(s, SETTLING_SWEEPS, SETTLED);
    }
    return status;
}

pe_status pe_solving_begin(pe_solving *s, pe_workspace work, pe_error *error)
{
    pe_solve_report *solve = &s->report.solve;
    solve->residual = pe_problem_residual(s->problem);
    pe_solve_note(solve, 0, solve->residual.max);
    s->sweeps = 0;
    s->warm = solve->residual.max;
    if (solve->residual.max <= ACCEPT_WARM * s->limits.tolerance) {
        s->report.path = PE_PATH_WARM;
        solve->stop = PE_STOP_CONVERGED;
        return PE_OK;
    }
    s->report.path = PE_PATH_SWEEPS;
    return is_tiny(s) ? begin_tiny(s, work, error) : begin_larger(s, work, error);
}

pe_status pe_solving_sweep(pe_solving *const *islands, int count, pe_workspace work,
                           pe_error *error)
{
    const pe_problem **problems = pe_take(work, (size_t)count, sizeof(void *));
    pe_solve_report *reports = pe_take(work, (size_t)count, sizeof *reports);
    if (problems == NULL || reports == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to sweep %d islands", count);
    }
    for (int i = 0; i < count; ++i) {
        problems[i] = islands[i]->problem;
        reports[i] = (pe_solve_report){.history = islands[i]->report.solve.history};
    }
    const pe_solve_limits limits = {islands[0]->enough, islands[0]->sweeps};
    /* Momentum takes more sweeps than these to begin to pay. */
    const bool with_momentum = limits.max_iterations > SETTLING_SWEEPS;
    pe_status status =
        pe_solve_together(problems, count, &limits, with_momentum, work, reports, error);
    for (int i = 0; i < count && status == PE_OK; ++i) {
        pe_solve_report *solve = &islands[i]->report.solve;
        solve->iterations += reports[i].iterations;
        solve->residual = reports[i].residual;
        solve->stop = reports[i].stop;
    }
    return status;
}

/* Newton's method from where the sweeps ended, and where that fails, too, the direct solver. */
static pe_status finish_tiny(pe_solving *s, pe_workspace work, pe_error *error)
{
    const pe_solve_report *solve = &s->report.solve;
    pe_status status = PE_OK;
    if (solve->residual.max > s->limits.tolerance) {
        status = solve_tiny(s, work, error);
    }
    if (status == PE_OK && solve->residual.max > s->least_aim) {
        status = try_directly(s, false, work, error);
    }
    return status;
}

/* Within the tolerance the direct solver is in vain if it leaves more of the residual: that is
 * rounding. */
static const double DIRECT_GAIN = 0.5;

/* Whether the direct solver does not pay for this island. That a chain could not be solved is no
 * reason to give up on it. */
static bool direct_failed(const pe_solving *s)
{
    const pe_island_plan *plan = &s->plan;
    const pe_solve_report *solve = &s->report.solve;
    const bool gives_up = !(plan->whole && is_chain(s->problem));
    const double near = pe_max(s->limits.tolerance, plan->whole ? ROUNDING : NEAR);
    const bool too_long = !plan->cold && solve->iterations >= warm_iterations(s->problem);
    const bool in_vain =
        s->warm <= s->limits.tolerance && solve->residual.max > DIRECT_GAIN * s->warm;
    return (plan->whole || plan->trial) &&
           ((gives_up && solve->residual.max > near) || too_long || in_vain);
}

pe_status pe_solving_finish(pe_solving *s, pe_workspace work, pe_error *error)
{
    pe_solve_report *solve = &s->report.solve;
    pe_status status = PE_OK;
    if (s->sweeps > 0 && is_tiny(s)) {
        status = finish_tiny(s, work, error);
    } else if (s->sweeps > SETTLING_SWEEPS && s->plan.trial && solve->residual.max < QUIET) {
        status = solve_directly(s, TRIAL_ITERATIONS, PE_NEWTON_TRESCA, work, error);
    }
    const bool solved = solve->residual.max <= s->limits.tolerance;
    if (s->report.path != PE_PATH_WARM && solved) {
        s->report.path = PE_PATH_DIRECT;
    }
    s->report.direct_failed = direct_failed(s);
    s->report.settling_failed = s->sweeps > 0 && s->sweeps <= SETTLING_SWEEPS &&
                                solve->residual.max > SETTLING_GAIN * s->before;
    return status;
}

pe_status pe_solve_island(const pe_problem *problem, const pe_island_limits *limits,
                          pe_workspace work, pe_island_report *report, pe_error *error)
{
    pe_solving s = {.problem = problem, .limits = *limits, .report = *report};
    pe_solving *alone = &s;
    pe_status status = pe_solving_begin(&s, work, error);
    if (status == PE_OK && s.sweeps > 0) {
        status = pe_solving_sweep(&alone, 1, work, error);
    }
    if (status == PE_OK) {
        status = pe_solving_finish(&s, work, error);
    }
    *report = s.report;
    return status;
}
