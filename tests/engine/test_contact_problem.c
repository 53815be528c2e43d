/* Contact problems as data: the solutions of all solvers, and the refusal of bad problems. */
#include "check.h"
#include "contact_problem_for_tests.h"
#include "counting_allocator.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const pe_solve_limits TIGHT = {.tolerance = 1e-10, .max_iterations = 20000};

static pe_contact_solution solve(const pe_contact_problem *problem, const char *solver,
                                 const pe_solve_limits *limits)
{
    pe_contact_solution solution;
    pe_error error;
    if (pe_contact_problem_solve(problem, solver, limits, NULL, &solution, &error) != PE_OK) {
        fail_msg("%s: %s", solver, error.message);
    }
    return solution;
}

static const double (*impulses_of(const pe_contact_solution *s))[3]
{
    return (const double(*)[3])s->impulses;
}

static const double (*velocities_of(const pe_contact_solution *s))[6]
{
    return (const double(*)[6])s->velocities;
}

/* Checks a law on the solution of every solver, and destroys the problem. */
static void for_every_solver(pe_contact_problem *problem,
                             void (*law)(const pe_contact_problem *problem,
                                         const pe_contact_solution *solution))
{
    for (int i = 0; i < pe_solver_count(); ++i) {
        pe_contact_solution solution = solve(problem, pe_solver(i).name, &TIGHT);
        if (solution.stop != PE_STOP_CONVERGED) {
            fail_msg("%s: residual %g after %d iterations", pe_solver(i).name,
                     solution.residual.max, solution.iterations);
        }
        law(problem, &solution);
        assert_at_most(coulomb_fault(problem, impulses_of(&solution), velocities_of(&solution)),
                       1e-8);
        pe_contact_solution_free(&solution);
    }
    pe_contact_problem_destroy(problem);
}

/* ---- Solutions ---- */

static void carries_its_weight(const pe_contact_problem *problem,
                               const pe_contact_solution *solution)
{
    double weight = 0, sum = 0;
    for (int i = 0; i < problem->body_count; ++i) {
        weight += problem->bodies[i].mass * GRAVITY * STEP;
        for (int k = 0; k < 6; ++k) {
            assert_close(solution->velocities[i][k], 0, 1e-9, 0);
        }
    }
    for (int k = 0; k < 4; ++k) {
        sum += solution->impulses[k][0];
    }
    assert_close(sum, weight, 1e-8 * weight, 0);
}

static void test_every_solver_carries_a_resting_box(void **state)
{
    (void)state;
    for_every_solver(problem_of_box_on_floor(3, 0.5), carries_its_weight);
    for_every_solver(problem_of_box_on_floor(3, 0), carries_its_weight);
}

static void test_every_solver_carries_a_tower(void **state)
{
    (void)state;
    const double masses[] = {1, 2, 5};
    for_every_solver(problem_of_tower(masses, 3, 0.3), carries_its_weight);
}

static void slows_by_mu_g(const pe_contact_problem *problem, const pe_contact_solution *solution)
{
    double mu = problem->manifolds[0].friction;
    assert_close(solution->velocities[0][0], 2 - mu * GRAVITY * STEP, 1e-9, 0);
    for (int k = 1; k < 6; ++k) {
        assert_close(solution->velocities[0][k], 0, 1e-9, 0);
    }
}

static void test_every_solver_slows_a_sliding_box(void **state)
{
    (void)state;
    pe_contact_problem *problem = problem_of_box_on_floor(3, 0.5);
    problem->bodies[0].free_velocity[0] = 2;
    for_every_solver(problem, slows_by_mu_g);
}

static void leaves_at_the_bias(const pe_contact_problem *problem,
                               const pe_contact_solution *solution)
{
    (void)problem;
    assert_close(solution->velocities[0][2], 0.25, 1e-9, 0);
}

static void test_negative_bias_is_the_bounce_speed(void **state)
{
    (void)state;
    pe_contact_problem *problem = problem_of_box_on_floor(3, 0);
    for (int k = 0; k < 4; ++k) {
        problem->points[k].bias = -0.25;
    }
    for_every_solver(problem, leaves_at_the_bias);
}

static void test_without_contacts_velocities_stay_free(void **state)
{
    (void)state;
    pe_contact_problem *problem = problem_at_random(1, 3, 0);
    pe_contact_solution s = solve(problem, pe_solver(0).name, &TIGHT);
    assert_int_equal(s.stop, PE_STOP_CONVERGED);
    assert_int_equal(s.iterations, 0);
    for (int i = 0; i < 3; ++i) {
        assert_memory_equal(s.velocities[i], problem->bodies[i].free_velocity,
                            sizeof s.velocities[i]);
    }
    pe_contact_solution_free(&s);
    pe_contact_problem_destroy(problem);
}

static void test_velocities_follow_from_impulses_by_independent_formulas(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        pe_contact_problem *problem = problem_at_random(seed, 6, 10);
        double v[6][6];
        pe_contact_solution s = solve(problem, pe_solver(0).name, &(pe_solve_limits){1e-6, 50});
        reference_velocities(problem, impulses_of(&s), v);
        for (int i = 0; i < 6; ++i) {
            for (int k = 0; k < 6; ++k) {
                assert_close(s.velocities[i][k], v[i][k], 1e-11, 1e-11);
            }
        }
        pe_contact_solution_free(&s);
        pe_contact_problem_destroy(problem);
    }
}

static void test_history_has_the_start_and_the_end(void **state)
{
    (void)state;
    const double masses[] = {1, 1, 1, 1, 1, 1};
    for (int i = 0; i < pe_solver_count(); ++i) {
        pe_contact_problem *problem = problem_of_tower(masses, 6, 0.5);
        pe_contact_solution s = solve(problem, pe_solver(i).name, &TIGHT);
        assert_true(s.history_count >= 2);
        assert_int_equal(s.history[0].iterations, 0);
        assert_true(s.history[0].residual == s.start.max);
        assert_int_equal(s.history[s.history_count - 1].iterations, s.iterations);
        assert_true(s.history[s.history_count - 1].residual == s.residual.max);
        for (int k = 1; k < s.history_count; ++k) {
            assert_true(s.history[k].iterations >= s.history[k - 1].iterations);
        }
        assert_at_most(s.residual.rms, s.residual.max);
        pe_contact_solution_free(&s);
        pe_contact_problem_destroy(problem);
    }
}

static void test_solution_as_warm_start_needs_no_iteration(void **state)
{
    (void)state;
    const double masses[] = {1, 3, 2};
    pe_contact_problem *problem = problem_of_tower(masses, 3, 0.5);
    pe_contact_solution first = solve(problem, pe_solver(0).name, &TIGHT);
    for (int j = 0; j < problem->point_count; ++j) {
        memcpy(problem->points[j].impulse, first.impulses[j], sizeof first.impulses[j]);
    }
    for (int i = 0; i < pe_solver_count(); ++i) {
        pe_contact_solution s = solve(problem, pe_solver(i).name, &TIGHT);
        assert_int_equal(s.iterations, 0);
        assert_memory_equal(s.impulses, first.impulses,
                            (size_t)problem->point_count * sizeof *s.impulses);
        pe_contact_solution_free(&s);
    }
    pe_contact_solution_free(&first);
    pe_contact_problem_destroy(problem);
}

static void test_zero_iterations_leave_the_warm_start(void **state)
{
    (void)state;
    pe_contact_problem *problem = problem_of_box_on_floor(3, 0.5);
    problem->points[2].impulse[0] = 0.125;
    for (int i = 0; i < pe_solver_count(); ++i) {
        pe_contact_solution s = solve(problem, pe_solver(i).name, &(pe_solve_limits){1e-9, 0});
        assert_int_equal(s.stop, PE_STOP_ITERATIONS);
        assert_int_equal(s.iterations, 0);
        assert_at_most(s.residual.max, s.start.max);
        pe_contact_solution_free(&s);
    }
    pe_contact_problem_destroy(problem);
}

static double ticks(void)
{
    return 1;
}

static void test_the_problem_is_not_changed_by_solving(void **state)
{
    (void)state;
    pe_contact_problem *problem = problem_at_random(5, 4, 6);
    pe_contact_problem *same = problem_at_random(5, 4, 6);
    for (int i = 0; i < pe_solver_count(); ++i) {
        pe_contact_solution s;
        assert_int_equal(pe_contact_problem_solve(problem, pe_solver(i).name,
                                                  &(pe_solve_limits){1e-6, 100}, ticks, &s, NULL),
                         PE_OK);
        assert_true(s.seconds == 0);
        pe_contact_solution_free(&s);
    }
    assert_memory_equal(problem->points, same->points,
                        (size_t)same->point_count * sizeof *same->points);
    pe_contact_problem_destroy(problem);
    pe_contact_problem_destroy(same);
}

/* ---- Bad calls ---- */

static void check_refused(const pe_contact_problem *problem, const char *solver,
                          pe_solve_limits limits, const char *part)
{
    pe_contact_solution solution;
    pe_error error = {.message = ""};
    assert_int_equal(pe_contact_problem_solve(problem, solver, &limits, NULL, &solution, &error),
                     PE_BAD_ARGUMENT);
    assert_int_equal(error.status, PE_BAD_ARGUMENT);
    assert_contains(error.message, part);
}

static void test_bad_calls_are_refused_with_what_was_expected(void **state)
{
    (void)state;
    pe_contact_problem *problem = problem_of_box_on_floor(1, 0.5);
    check_refused(problem, "magic", TIGHT, "no solver \"magic\"");
    check_refused(problem, "gauss_seidel", (pe_solve_limits){0, 10}, "tolerance");
    check_refused(problem, "gauss_seidel", (pe_solve_limits){(double)NAN, 10}, "tolerance");
    check_refused(problem, "gauss_seidel", (pe_solve_limits){1e-6, -1}, "max_iterations");
    problem->bodies[0].mass = 0;
    check_refused(problem, "gauss_seidel", TIGHT, "bodies[0].mass: expected");
    pe_contact_problem_destroy(problem);
}

/* One number of a valid problem that makes it invalid. */
typedef struct spoil {
    const char *field; /* "list[index].field" */
    void (*spoil)(pe_contact_problem *problem);
} spoil;

static void no_mass(pe_contact_problem *p)
{
    p->bodies[1].mass = 0;
}
static void negative_mass(pe_contact_problem *p)
{
    p->bodies[1].mass = -1;
}
static void infinite_mass(pe_contact_problem *p)
{
    p->bodies[1].mass = (double)INFINITY;
}
static void no_inertia(pe_contact_problem *p)
{
    memset(p->bodies[1].inertia, 0, sizeof p->bodies[1].inertia);
}
static void indefinite_inertia(pe_contact_problem *p)
{
    p->bodies[1].inertia[1] = 10; /* xy is above the root of xx yy */
}
static void flat_inertia(pe_contact_problem *p)
{
    const double flat[6] = {1, 0, 0, 1, 1, 1}; /* yz = yy = zz: singular */
    memcpy(p->bodies[1].inertia, flat, sizeof flat);
}
static void nan_inertia(pe_contact_problem *p)
{
    p->bodies[1].inertia[4] = (double)NAN;
}
static void nan_velocity(pe_contact_problem *p)
{
    p->bodies[1].free_velocity[5] = (double)NAN;
}
static void a_too_high(pe_contact_problem *p)
{
    p->manifolds[1].a = 2;
}
static void b_too_low(pe_contact_problem *p)
{
    p->manifolds[1].b = -2;
}
static void same_body(pe_contact_problem *p)
{
    p->manifolds[1].a = p->manifolds[1].b;
}
static void both_static(pe_contact_problem *p)
{
    p->manifolds[1].a = p->manifolds[1].b = PE_STATIC;
}
static void gap_in_points(pe_contact_problem *p)
{
    p->manifolds[1].first += 1;
}
static void no_points(pe_contact_problem *p)
{
    p->manifolds[1].count = 0;
}
static void too_many_points(pe_contact_problem *p)
{
    p->manifolds[1].count = 5;
}
static void huge_count(pe_contact_problem *p)
{
    p->manifolds[1].count = 2147483647;
}
static void negative_friction(pe_contact_problem *p)
{
    p->manifolds[1].friction = -1e-300;
}
static void nan_friction(pe_contact_problem *p)
{
    p->manifolds[1].friction = (double)NAN;
}
static void long_normal(pe_contact_problem *p)
{
    p->manifolds[1].frame[0][2] = 1 + 1e-8;
}
static void skew_frame(pe_contact_problem *p)
{
    p->manifolds[1].frame[1][2] = 1e-8;
}
static void left_handed(pe_contact_problem *p)
{
    p->manifolds[1].frame[2][1] = -1;
}
static void nan_frame(pe_contact_problem *p)
{
    p->manifolds[1].frame[2][2] = (double)NAN;
}
static void nan_arm(pe_contact_problem *p)
{
    p->manifolds[1].arm_a[0] = (double)NAN;
}
static void infinite_offset(pe_contact_problem *p)
{
    p->points[5].offset[0] = (double)INFINITY;
}
static void nan_bias(pe_contact_problem *p)
{
    p->points[5].bias = (double)NAN;
}
static void nan_impulse(pe_contact_problem *p)
{
    p->points[5].impulse[2] = (double)NAN;
}
static void point_of_none(pe_contact_problem *p)
{
    p->manifolds[1].count = 3;
}

static const spoil SPOILS[] = {{"bodies[1].mass", no_mass},
                               {"bodies[1].mass", negative_mass},
                               {"bodies[1].mass", infinite_mass},
                               {"bodies[1].inertia", no_inertia},
                               {"bodies[1].inertia", indefinite_inertia},
                               {"bodies[1].inertia", flat_inertia},
                               {"bodies[1].inertia", nan_inertia},
                               {"bodies[1].free_velocity", nan_velocity},
                               {"manifolds[1].a", a_too_high},
                               {"manifolds[1].b", b_too_low},
                               {"manifolds[1].b", same_body},
                               {"manifolds[1].b", both_static},
                               {"manifolds[1].first", gap_in_points},
                               {"manifolds[1].count", no_points},
                               {"manifolds[1].count", too_many_points},
                               {"manifolds[1].count", huge_count},
                               {"manifolds[1].friction", negative_friction},
                               {"manifolds[1].friction", nan_friction},
                               {"manifolds[1].frame", long_normal},
                               {"manifolds[1].frame", skew_frame},
                               {"manifolds[1].frame", left_handed},
                               {"manifolds[1].frame", nan_frame},
                               {"manifolds[1].arm_a", nan_arm},
                               {"points[5].offset", infinite_offset},
                               {"points[5].bias", nan_bias},
                               {"points[5].impulse", nan_impulse},
                               {"points[7].impulse", point_of_none}};

static void test_every_bad_number_is_found_and_named(void **state)
{
    (void)state;
    const double masses[] = {1, 1};
    for (size_t i = 0; i < sizeof SPOILS / sizeof SPOILS[0]; ++i) {
        pe_contact_problem *problem = problem_of_tower(masses, 2, 0.5);
        pe_problem_fault fault;
        assert_true(pe_contact_problem_is_valid(problem, &fault));
        SPOILS[i].spoil(problem);
        assert_false(pe_contact_problem_is_valid(problem, NULL));
        assert_false(pe_contact_problem_is_valid(problem, &fault));
        char found[64];
        snprintf(found, sizeof found, "%s[%d].%s", fault.list, fault.index, fault.field);
        assert_string_equal(found, SPOILS[i].field);
        assert_contains(fault.text, "expected");
        assert_contains(fault.text, "found");
        pe_contact_problem_destroy(problem);
    }
}

static void test_arm_of_a_static_body_is_ignored(void **state)
{
    (void)state;
    pe_contact_problem *problem = problem_of_box_on_floor(1, 0.5);
    problem->manifolds[0].arm_a[1] = (double)NAN;
    assert_true(pe_contact_problem_is_valid(problem, NULL));
    pe_contact_problem_destroy(problem);
}

static void test_negative_counts_are_refused(void **state)
{
    (void)state;
    pe_contact_problem *problem = NULL;
    pe_error error;
    assert_int_equal(pe_contact_problem_create(-1, 0, 0, NULL, &problem, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, "-1 bodies");
    assert_int_equal(pe_contact_problem_create(0, 0, -5, NULL, &problem, &error), PE_BAD_ARGUMENT);
    assert_null(problem);
    pe_contact_problem_destroy(NULL);
    pe_contact_problems_destroy(NULL, 0);
}

/* ---- Memory ---- */

static void test_failed_allocation_is_reported_without_leak(void **state)
{
    (void)state;
    for (int solver = 0; solver < pe_solver_count(); ++solver) {
        bool done = false;
        for (int k = 0; !done; ++k) {
            counter c = {.fail_at = k};
            const pe_allocator allocator = {count_allocate, count_release, &c};
            const double masses[] = {1, 1};
            pe_contact_problem *model = problem_of_tower(masses, 2, 0.5), *problem = NULL;
            pe_contact_solution solution;
            pe_error error = {.message = ""};
            pe_status status = pe_contact_problem_create(2, 2, 8, &allocator, &problem, &error);
            if (status == PE_OK) {
                memcpy(problem->bodies, model->bodies, 2 * sizeof *model->bodies);
                memcpy(problem->manifolds, model->manifolds, 2 * sizeof *model->manifolds);
                memcpy(problem->points, model->points, 8 * sizeof *model->points);
                status = pe_contact_problem_solve(problem, pe_solver(solver).name, &TIGHT, NULL,
                                                  &solution, &error);
                done = status == PE_OK;
                if (done) {
                    pe_contact_solution_free(&solution);
                }
                pe_contact_problem_destroy(problem);
            }
            if (!done) {
                assert_int_equal(status, PE_NO_MEMORY);
                assert_contains(error.message, "no memory");
            }
            assert_int_equal(c.living, 0);
            pe_contact_problem_destroy(model);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_solver_carries_a_resting_box),
        cmocka_unit_test(test_every_solver_carries_a_tower),
        cmocka_unit_test(test_every_solver_slows_a_sliding_box),
        cmocka_unit_test(test_negative_bias_is_the_bounce_speed),
        cmocka_unit_test(test_without_contacts_velocities_stay_free),
        cmocka_unit_test(test_velocities_follow_from_impulses_by_independent_formulas),
        cmocka_unit_test(test_history_has_the_start_and_the_end),
        cmocka_unit_test(test_solution_as_warm_start_needs_no_iteration),
        cmocka_unit_test(test_zero_iterations_leave_the_warm_start),
        cmocka_unit_test(test_the_problem_is_not_changed_by_solving),
        cmocka_unit_test(test_bad_calls_are_refused_with_what_was_expected),
        cmocka_unit_test(test_every_bad_number_is_found_and_named),
        cmocka_unit_test(test_arm_of_a_static_body_is_ignored),
        cmocka_unit_test(test_negative_counts_are_refused),
        cmocka_unit_test(test_failed_allocation_is_reported_without_leak),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
