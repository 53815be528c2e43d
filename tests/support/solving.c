#include "solving.h"

#include "check.h"

#include <math.h>
#include <stdlib.h>

pe_status solve_by_newton(solving *s, pe_newton_form form, const pe_solve_limits *limits,
                          pe_error *error)
{
    pe_newton_settings settings = pe_newton_settings_for(&s->pattern, form, limits->tolerance);
    s->start = pe_problem_residual(&s->problem).max;
    return pe_newton(&s->problem, &settings, limits, s->work, &s->report, error);
}

static pe_status solve_cone(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    return solve_by_newton(s, PE_NEWTON_CONE, limits, error);
}

static pe_status solve_direct(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    s->start = pe_problem_residual(&s->problem).max;
    pe_newton_settings settings = pe_newton_settings_for(
        &s->pattern, pe_problem_has_impulse(&s->problem) ? PE_NEWTON_TRESCA : PE_NEWTON_CONE,
        limits->tolerance);
    return pe_solve_direct(&s->problem, &settings, limits, s->work, &s->report, error);
}

/* The convex problem without a shift. */
static pe_status solve_convex(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    double *shift = calloc((size_t)s->problem.point_count + 1, sizeof *shift);
    assert_non_null(shift);
    pe_status status = pe_interior_point(&s->problem, &(pe_convex_form){NULL, shift}, limits,
                                         s->work, &s->report, error);
    free(shift);
    return status;
}

/* The Tresca form bounds friction by impulses and needs some near the solution: those of the convex
 * problem, as in the engine. */
static pe_status solve_tresca(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    pe_status status = PE_OK;
    if (!pe_problem_has_impulse(&s->problem)) {
        const pe_solve_limits rough = {1e-4, SOLVING_ITERATIONS};
        status = solve_convex(s, &rough, error);
        s->report.iterations = 0;
        s->report.factor_flops = 0;
    }
    return status == PE_OK ? solve_by_newton(s, PE_NEWTON_TRESCA, limits, error) : status;
}

pe_status solve_by_island(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    const pe_island_limits island = {.tolerance = limits->tolerance,
                                     .swept_tolerance = 5e-5,
                                     .max_updates = 1e6,
                                     .max_iterations = 100000,
                                     .patience = 4};
    pe_island_report report = {.path = PE_PATH_NONE};
    pe_status status = pe_solve_island(&s->problem, &island, s->work, &report, error);
    s->report = report.solve;
    return status;
}

const named_solver SOLVERS[ALL_SOLVERS] = {{"newton, cone", solve_cone, 1e-11, 1e-9},
                                           {"newton, tresca", solve_tresca, 1e-11, 1e-9},
                                           {"direct", solve_direct, 1e-11, 1e-9},
                                           {"interior point", solve_convex, 1e-8, 1e-6}};

void solving_begin(solving *s, const pe_contact_problem *source)
{
    *s = (solving){.source = source};
    s->work = test_memory_begin(&s->memory);
    s->problem = solver_problem(source, s->work);
    assert_int_equal(pe_pattern_find(&s->problem, NULL, s->work, &s->pattern, NULL), PE_OK);
}

void solve_to(solving *s, const pe_contact_problem *source, const named_solver *by,
              double tolerance)
{
    solving_begin(s, source);
    pe_solve_limits limits = {tolerance, SOLVING_ITERATIONS};
    assert_int_equal(by->solve(s, &limits, NULL), PE_OK);
    if (s->report.stop != PE_STOP_CONVERGED) {
        fail_msg("%s: stopped by %d at %g m/s after %d iterations", by->name, (int)s->report.stop,
                 s->report.residual.max, s->report.iterations);
    }
}

void solving_end(solving *s)
{
    test_memory_end(&s->memory);
}

const double *solving_velocity(const solving *s, int i)
{
    pe_problem_rebuild_velocity(&s->problem);
    return s->problem.velocity[i];
}

void tilt_gravity(pe_contact_problem *problem, double angle)
{
    for (int i = 0; i < problem->body_count; ++i) {
        problem->bodies[i].free_velocity[0] = STEP * GRAVITY * sin(angle);
        problem->bodies[i].free_velocity[2] = -STEP * GRAVITY * cos(angle);
    }
}

pe_contact_problem *problem_of_box_on_slope(double mass, double friction, double angle)
{
    pe_contact_problem *problem = problem_of_box_on_floor(mass, friction);
    tilt_gravity(problem, angle);
    return problem;
}

pe_contact_problem *problem_of_uniform_tower(int count, double friction)
{
    double masses[100];
    for (int i = 0; i < count; ++i) {
        masses[i] = 1;
    }
    return problem_of_tower(masses, count, friction);
}
