/* Newton's method for problems of one or two bodies. */
#include "check.h"
#include "solver/solve.h"
#include "solving.h"

#include <math.h>
#include <string.h>

enum { ISLANDS = 4, PROBLEMS = 1600, ITERATIONS = 16 /* as in a step */ };
static const double TOLERANCE = 1e-8; /* m/s */

/* Which pairs of bodies touch. */
static const struct island {
    int bodies, pair_count;
    int pairs[3][2];
} islands[ISLANDS] = {
    {1, 1, {{PE_STATIC, 0}}},
    {1, 2, {{PE_STATIC, 0}, {PE_STATIC, 0}}},
    {2, 2, {{PE_STATIC, 0}, {0, 1}}},
    {2, 3, {{PE_STATIC, 0}, {PE_STATIC, 1}, {0, 1}}},
};

static void scale_mass(pe_problem_body *body, double factor)
{
    body->mass *= factor;
    for (int k = 0; k < 6; ++k) {
        body->inertia[k] *= factor;
    }
}

/* A random problem that v = 0 satisfies, with masses up to 1e3 apart. It begins without impulses, or
 * every other one with some within the cone. */
static pe_contact_problem *tiny_problem(uint64_t seed, bool smooth)
{
    const struct island *island = &islands[seed % ISLANDS];
    pe_contact_problem *problem =
        problem_of_pairs(seed, island->bodies, island->pairs, island->pair_count);
    check_random random = {seed};
    scale_mass(&problem->bodies[0], pow(10, check_uniform(&random, -1.5, 1.5)));
    if (island->bodies == 2) {
        double ratio = pow(10, check_uniform(&random, -3, 3));
        problem->bodies[1].mass = problem->bodies[0].mass;
        scale_mass(&problem->bodies[1], ratio);
    }
    for (int i = 0; i < problem->manifold_count; ++i) {
        pe_problem_manifold *m = &problem->manifolds[i];
        m->friction = smooth ? 0 : m->friction;
        for (int j = m->first; j < m->first + m->count; ++j) {
            pe_problem_manifold_point *point = &problem->points[j];
            double *p = point->impulse, along = m->friction * fabs(p[0]) / hypot(p[1], p[2]);
            point->bias = fabs(point->bias);
            p[0] = fabs(p[0]);
            p[1] *= fmin(1, along);
            p[2] *= fmin(1, along);
            if (seed / ISLANDS % 2 == 0) {
                memset(p, 0, sizeof point->impulse);
            }
        }
    }
    return problem;
}

/* Begins and solves. Returns whether to the tolerance. */
static bool solve(solving *s, const pe_contact_problem *source)
{
    solving_begin(s, source);
    s->start = pe_problem_residual(&s->problem).max;
    const pe_solve_limits limits = {TOLERANCE, ITERATIONS};
    assert_int_equal(pe_solve_tiny(&s->problem, &limits, s->work, &s->report, NULL), PE_OK);
    assert_true(s->report.iterations <= ITERATIONS);
    assert_int_equal(s->report.stop == PE_STOP_CONVERGED, s->report.residual.max <= TOLERANCE);
    return s->report.stop == PE_STOP_CONVERGED;
}

static void check_cone(const pe_problem *problem)
{
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *m = &problem->manifold[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            const double *p = problem->impulse[j];
            assert_true(p[0] >= 0);
            assert_at_most(hypot(p[1], p[2]), m->friction * p[0] * (1 + 1e-14) + 1e-300);
        }
    }
}

/* Far from the solution Newton's method, which searches along no line, may fail. */
static void test_most_tiny_problems_are_solved_from_afar(void **state)
{
    (void)state;
    int solved = 0;
    double worst = 0;
    for (uint64_t seed = 1; seed <= PROBLEMS; ++seed) {
        solving s;
        pe_contact_problem *source = tiny_problem(seed, false);
        if (solve(&s, source)) {
            solved += 1;
            worst = fmax(worst, solver_problem_fault(source, &s.problem));
        }
        pe_contact_problem_destroy(source);
        solving_end(&s);
    }
    print_message("    %d of %d solved, faults up to %g m/s\n", solved, PROBLEMS, worst);
    assert_true(2 * solved > PROBLEMS);
    assert_at_most(worst, 10 * TOLERANCE);
}

/* Begins and solves by the direct solver. */
static bool solve_by_another(solving *s, const pe_contact_problem *source)
{
    solving_begin(s, source);
    const pe_solve_limits limits = {0.1 * TOLERANCE, SOLVING_ITERATIONS};
    assert_int_equal(pe_solve_combined(&s->problem, &limits, s->work, &s->report, NULL), PE_OK);
    return s->report.stop == PE_STOP_CONVERGED;
}

/* As from step to step: a solution is the warm start, and the free velocities have changed by
 * a hundredth. */
static void test_nine_in_ten_are_solved_from_warm_starts(void **state)
{
    (void)state;
    int begun = 0, solved = 0;
    for (uint64_t seed = 1; seed <= PROBLEMS; ++seed) {
        solving s, next;
        pe_contact_problem *source = tiny_problem(seed, false);
        if (solve_by_another(&s, source)) {
            begun += 1;
            for (int j = 0; j < source->point_count; ++j) {
                memcpy(source->points[j].impulse, s.problem.impulse[j], sizeof *s.problem.impulse);
            }
            for (int i = 0; i < source->body_count; ++i) {
                for (int k = 0; k < 6; ++k) {
                    source->bodies[i].free_velocity[k] *= 1.01;
                }
            }
            solved += solve(&next, source);
            solving_end(&next);
        }
        pe_contact_problem_destroy(source);
        solving_end(&s);
    }
    print_message("    %d of %d solved\n", solved, begun);
    assert_true(solved >= 0.9 * begun);
}

static void test_tiny_impulses_give_the_reported_residual(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= PROBLEMS; ++seed) {
        solving s;
        pe_contact_problem *source = tiny_problem(seed, false);
        solve(&s, source);
        check_cone(&s.problem);
        assert_at_most(s.report.residual.max, s.start);
        double velocity[PE_TINY_BODIES][6];
        size_t size = (size_t)s.problem.body_count * sizeof *velocity;
        memcpy(velocity, s.problem.velocity, size);
        pe_problem_rebuild_velocity(&s.problem);
        assert_memory_equal(velocity, s.problem.velocity, size);
        pe_residual left = pe_problem_residual(&s.problem);
        assert_close(s.report.residual.max, left.max, 0, 0);
        assert_close(s.report.residual.rms, left.rms, 0, 0);
        pe_contact_problem_destroy(source);
        solving_end(&s);
    }
}

/* Without friction the velocities are unique. */
static void test_smooth_tiny_problems_have_the_same_velocities(void **state)
{
    (void)state;
    int compared = 0;
    double worst = 0;
    for (uint64_t seed = 1; seed <= PROBLEMS; ++seed) {
        solving s, other;
        pe_contact_problem *source = tiny_problem(seed, true);
        bool solved = solve(&s, source);
        if (solve_by_another(&other, source) && solved) {
            compared += 1;
            for (int i = 0; i < source->body_count; ++i) {
                const double *v = solving_velocity(&s, i), *w = solving_velocity(&other, i);
                for (int k = 0; k < 6; ++k) {
                    worst = fmax(worst, fabs(v[k] - w[k]));
                }
            }
        }
        pe_contact_problem_destroy(source);
        solving_end(&other);
        solving_end(&s);
    }
    print_message("    %d of %d compared, %g m/s apart at most\n", compared, PROBLEMS, worst);
    assert_true(compared > 0.8 * PROBLEMS);
    assert_at_most(worst, 10 * TOLERANCE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_most_tiny_problems_are_solved_from_afar),
        cmocka_unit_test(test_nine_in_ten_are_solved_from_warm_starts),
        cmocka_unit_test(test_tiny_impulses_give_the_reported_residual),
        cmocka_unit_test(test_smooth_tiny_problems_have_the_same_velocities),
    };
    return cmocka_run_group_tests_name("engine_tiny", tests, NULL, NULL);
}
