#include "solve_direct.h"

#include "base/vec3.h"
#include "solve_interior_point.h"
#include "solve_newton.h"

#include <math.h>
#include <string.h>

enum {
    FIRST_ITERATIONS = 8,
    MOST_UPDATES = 60,
    ROUNDS = 3,
    INTERIOR_ITERATIONS = 60,
    POLISH_ITERATIONS = 30
};

/* The compliance r of a point, as a part of its own effective one, from which a chain of D bodies
 * over each other converges in a few multiplier updates: about a tenth of (pi/2D)^2, and less where
 * the lighter carries the heavier; softer by ten
 * in the first. Harder than 1e-8 rounding shows. */
pe_newton_settings pe_newton_settings_for(const pe_pattern *pattern, pe_newton_form form,
                                          double enough)
{
    double depth = pattern->depth;
    double softness = pe_max(1e-8, pe_min(1e-4, 1e-3 * pattern->mass_ratio / (depth * depth)));
    return (pe_newton_settings){form, softness, pe_max(1e-8, 0.1 * softness), MOST_UPDATES, enough};
}

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

void pe_solve_shifts(const pe_problem *problem, double *shift)
{
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        double q[6], u[3];
        pe_solver_manifold_twist(manifold, (const double(*)[6])problem->velocity, q);
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            pe_point_velocity(&problem->point[j], q, u);
            shift[j] = manifold->friction * sqrt(u[1] * u[1] + u[2] * u[2]);
        }
    }
}

bool pe_has_impulse(const pe_problem *problem)
{
    for (int j = 0; j < problem->point_count; ++j) {
        if (problem->impulse[j][0] > 0) {
            return true;
        }
    }
    return false;
}

static const double INTERIOR_ENOUGH = 1e-4; /* m/s: what the polish starts from */

/* So many iterations more, but never past the caller's bound. */
static int bound(const pe_solve_report *report, int more, const pe_solve_limits *limits)
{
    int most = report->iterations + more;
    return most < limits->max_iterations ? most : limits->max_iterations;
}

/* Rounds of the interior point method, each from the shift of the best so far, then the polish. */
static pe_status solve_by_interior(keeper *best, const pe_pattern *pattern,
                                   const pe_solve_limits *limits, pe_workspace work,
                                   pe_solve_report *report, pe_error *error)
{
    const pe_problem *problem = best->problem;
    pe_newton_settings polish = {PE_NEWTON_TRESCA, 1e-3, 1e-7, MOST_UPDATES, limits->tolerance};
    double *shift = pe_take(work, (size_t)problem->point_count + 1, sizeof *shift);
    if (shift == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %d contact points",
                       problem->point_count);
    }
    restore(best);
    for (int round = 0; round < ROUNDS && best->residual.max > limits->tolerance &&
                        report->iterations < limits->max_iterations;
         ++round) {
        pe_solve_shifts(problem, shift);
        pe_solve_limits inner = {INTERIOR_ENOUGH, bound(report, INTERIOR_ITERATIONS, limits)};
        pe_status status =
            pe_interior_point(problem, pattern->counted, shift, &inner, work, report, error);
        if (status != PE_OK) {
            return status;
        }
        keep_if_better(best, report->residual);
        /* The next round's shift is that of this round, whatever the polish finds. */
        pe_solve_shifts(problem, shift);
        inner = (pe_solve_limits){limits->tolerance, bound(report, POLISH_ITERATIONS, limits)};
        status = pe_newton(problem, pattern, &polish, &inner, work, report, error);
        if (status != PE_OK) {
            return status;
        }
        keep_if_better(best, report->residual);
    }
    return PE_OK;
}

static pe_status run_newton(keeper *best, const pe_pattern *pattern, pe_newton_form form,
                            const pe_solve_limits *limits, pe_workspace work,
                            pe_solve_report *report, pe_error *error)
{
    pe_newton_settings settings = pe_newton_settings_for(pattern, form, limits->tolerance);
    /* Solved deeper than is asked for: what is kept without a step would else drift by it. */
    pe_solve_limits inner = {1e-3 * limits->tolerance, bound(report, FIRST_ITERATIONS, limits)};
    pe_status status = pe_newton(best->problem, pattern, &settings, &inner, work, report, error);
    if (status == PE_OK) {
        keep_if_better(best, report->residual);
    }
    return status;
}

pe_status pe_solve_direct(const pe_problem *problem, const pe_pattern *pattern, bool cold,
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
    pe_status status = run_newton(&best, pattern, cold ? PE_NEWTON_CONE : PE_NEWTON_TRESCA, limits,
                                  work, report, error);
    if (status == PE_OK && best.residual.max > limits->tolerance) {
        status = solve_by_interior(&best, pattern, limits, work, report, error);
    }
    restore(&best);
    report->residual = best.residual;
    if (best.residual.max <= limits->tolerance) {
        report->stop = PE_STOP_CONVERGED;
    } else {
        report->stop =
            report->iterations >= limits->max_iterations ? PE_STOP_ITERATIONS : PE_STOP_STALLED;
    }
    return status;
}
