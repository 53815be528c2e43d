/* The direct solvers at their limits: iterations, NaN, memory. */
#include "check.h"
#include "solving.h"

#include <math.h>
#include <string.h>

/* A problem that takes many iterations: a pushed tower with heavy boxes on light ones. */
static pe_contact_problem *hard_problem(void)
{
    double masses[20];
    for (int i = 0; i < 20; ++i) {
        masses[i] = 1 + 10 * i;
    }
    pe_contact_problem *problem = problem_of_tower(masses, 20, 0.3);
    problem->bodies[10].free_velocity[0] = 0.5;
    problem->bodies[3].free_velocity[5] = 2;
    return problem;
}

static void test_one_iteration_is_too_few_best_is_left(void **state)
{
    (void)state;
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        solving s;
        pe_contact_problem *source = hard_problem();
        solving_begin(&s, source);
        const pe_solve_limits limits = {1e-10, 1};
        assert_int_equal(SOLVERS[k].solve(&s, &limits, NULL), PE_OK);
        assert_int_equal(s.report.stop, PE_STOP_ITERATIONS);
        assert_int_equal(s.report.iterations, 1);
        assert_true(s.report.factor_flops > 0);
        const double *last = s.problem.velocity[19];
        double before[6];
        memcpy(before, last, sizeof before);
        pe_problem_rebuild_velocity(&s.problem);
        assert_memory_equal(before, last, sizeof before); /* in step with the impulses */
        assert_close(s.report.residual.max, pe_problem_residual(&s.problem).max, 1e-15, 1e-9);
        assert_true(s.report.residual.max > 1e-10);
        if (k < COULOMB_SOLVERS) {
            assert_at_most(s.report.residual.max, s.start);
        }
        pe_contact_problem_destroy(source);
        solving_end(&s);
    }
}

static void test_iteration_limits_hold_and_start_is_never_worsened(void **state)
{
    (void)state;
    for (int k = 0; k < COULOMB_SOLVERS; ++k) {
        for (int most = 0; most <= 60; ++most) {
            solving s;
            pe_contact_problem *source = hard_problem();
            for (int j = 0; j < source->point_count; ++j) {
                source->points[j].impulse[0] = 1; /* something to start from, for every form */
            }
            solving_begin(&s, source);
            const pe_solve_limits limits = {1e-10, most};
            assert_int_equal(SOLVERS[k].solve(&s, &limits, NULL), PE_OK);
            assert_at_most(s.report.iterations, most);
            pe_problem_rebuild_velocity(&s.problem);
            double left = pe_problem_residual(&s.problem).max;
            assert_at_most(left, s.start);
            assert_close(s.report.residual.max, left, 1e-15, 1e-9);
            assert_int_equal(s.report.stop == PE_STOP_CONVERGED, left <= 1e-10);
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

/* A quiet island that no impulses solve; its warm start is off by less than 1e-3 m/s. */
static pe_contact_problem *quiet_problem(uint64_t seed, int bodies)
{
    pe_contact_problem *problem = problem_at_random(seed, bodies, 3 * bodies);
    for (int i = 0; i < bodies; ++i) {
        for (int k = 0; k < 6; ++k) {
            problem->bodies[i].free_velocity[k] *= 1e-5;
        }
    }
    for (int j = 0; j < problem->point_count; ++j) {
        problem->points[j].bias *= 1e-5;
        for (int k = 0; k < 3; ++k) {
            problem->points[j].impulse[k] *= 1e-5;
        }
    }
    return problem;
}

/* Where no sweeps are allowed all iterations are those of the direct solver: 6000 over the number of
 * points, but at least 12 and at most 48. */
static void test_warm_islands_get_few_direct_iterations(void **state)
{
    (void)state;
    static const int sizes[] = {8, 15, 25, 40, 80};
    for (int k = 0; k < 5; ++k) {
        int reached = 0;
        for (uint64_t seed = 1; seed <= 4; ++seed) {
            solving s;
            pe_contact_problem *source = quiet_problem(seed, sizes[k]);
            solving_begin(&s, source);
            const pe_island_limits limits = {.tolerance = 1e-10,
                                             .swept_tolerance = 1e-10,
                                             .max_updates = 1e6,
                                             .max_iterations = 100000,
                                             .patience = 1e9};
            assert_at_most(pe_problem_residual(&s.problem).max, 1e-3);
            pe_island_report report = {.path = PE_PATH_NONE};
            assert_int_equal(pe_solve_island(&s.problem, &limits, s.work, &report, NULL), PE_OK);
            int most = 6000 / source->point_count;
            most = most < 12 ? 12 : most > 48 ? 48 : most;
            assert_in_range(report.solve.iterations, 1, most);
            if (report.solve.iterations == most) {
                reached += 1;
                assert_true(report.direct_failed);
            }
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
        print_message("    %d bodies: %d of 4 use all iterations\n", sizes[k], reached);
        assert_true(reached > 0);
    }
}

/* No solver makes a factorisation that would exceed the flops that it may make. */
static void test_flops_are_bounded(void **state)
{
    (void)state;
    static const double parts[] = {0.5, 1, 3.5, 20};
    static const pe_solve_function solvers[] = {pe_solve_newton, pe_solve_interior_point,
                                                pe_solve_combined};
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 4; ++i) {
            solving s;
            pe_contact_problem *source = quiet_problem(5, 20);
            solving_begin(&s, source);
            const pe_solve_limits limits = {1e-12, 100};
            const double most = parts[i] * s.pattern.flops;
            pe_solve_report report = {.most_flops = most};
            assert_int_equal(solvers[k](&s.problem, &limits, s.work, &report, NULL), PE_OK);
            assert_at_most(report.factor_flops, most);
            assert_true(report.iterations == (int)parts[i] || parts[i] > 4);
            assert_true(report.stop != PE_STOP_CONVERGED);
            if (parts[i] < 1) {
                assert_true(solvers[k] != pe_solve_combined || report.stop == PE_STOP_ITERATIONS);
                for (int j = 0; j < source->point_count; ++j) {
                    assert_memory_equal(s.problem.impulse[j], source->points[j].impulse,
                                        sizeof source->points[j].impulse);
                }
            }
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

/* An island without impulses whose factor is dense, and which no impulses solve. All iterations together
 * cost at most 8 x 16 times what the allowed sweeps do: 50 sweeps at 15 ns a point, against 0.14 ns a
 * flop and 150 ns a point and iteration. */
static void test_new_islands_are_bounded_by_the_cost_of_sweeps(void **state)
{
    (void)state;
    int bounded = 0;
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        solving s;
        pe_contact_problem *source = problem_at_random(seed, 70, 1000);
        for (int j = 0; j < source->point_count; ++j) {
            memset(source->points[j].impulse, 0, sizeof source->points[j].impulse);
        }
        solving_begin(&s, source);
        const pe_island_limits limits = {.tolerance = 1e-10,
                                         .swept_tolerance = 1e9,
                                         .max_updates = 1,
                                         .most_sweeps = 30,
                                         .max_iterations = 100000,
                                         .patience = 1,
                                         .settling_waits = true};
        pe_island_report report = {.path = PE_PATH_NONE};
        assert_int_equal(pe_solve_island(&s.problem, &limits, s.work, &report, NULL), PE_OK);
        const double points = source->point_count;
        const double swept = 15 * points * 50, one = 0.14 * s.pattern.flops + 150 * points;
        assert_true(report.solve.iterations >= 20);
        assert_at_most(report.solve.iterations * one, 8 * 16 * swept);
        bounded += (report.solve.iterations + 1) * one > 8 * 16 * swept;
        pe_contact_problem_destroy(source);
        solving_end(&s);
    }
    assert_true(bounded > 0);
}

/* Where a NaN may come from. */
static void poison(pe_contact_problem *problem, int place)
{
    const double nan = (double)NAN;
    if (place == 0) {
        problem->bodies[1].free_velocity[0] = nan;
    } else if (place == 1) {
        problem->points[6].bias = nan;
    } else if (place == 2) {
        problem->manifolds[1].friction = nan;
    } else if (place == 3) {
        problem->bodies[1].inertia[0] = nan;
    } else {
        problem->points[6].impulse[0] = nan;
    }
}

static void test_nan_ends_and_is_not_converged(void **state)
{
    (void)state;
    static const named_solver island = {.name = "island", .solve = solve_by_island};
    for (int k = 0; k <= ALL_SOLVERS; ++k) {
        const named_solver *by = k < ALL_SOLVERS ? &SOLVERS[k] : &island;
        for (int place = 0; place < 5; ++place) {
            for (int warm = 0; warm < 2; ++warm) {
                solving s;
                pe_contact_problem *source = problem_of_uniform_tower(4, 0.5);
                for (int j = 0; j < source->point_count; ++j) {
                    source->points[j].impulse[0] = warm ? 0.03 : 0;
                }
                poison(source, place);
                solving_begin(&s, source);
                const pe_solve_limits limits = {1e-8, SOLVING_ITERATIONS};
                assert_int_equal(by->solve(&s, &limits, NULL), PE_OK);
                pe_problem_rebuild_velocity(&s.problem);
                bool is_solved = pe_problem_residual(&s.problem).max <= 1e-8;
                if (is_solved != (s.report.stop == PE_STOP_CONVERGED) ||
                    is_solved != (s.report.residual.max <= 1e-8)) {
                    fail_msg("%s, NaN %d: said to stop by %d at %g, it is %g", by->name, place,
                             (int)s.report.stop, s.report.residual.max,
                             pe_problem_residual(&s.problem).max);
                }
                pe_contact_problem_destroy(source);
                solving_end(&s);
            }
        }
    }
}

/* No iterate was better than the start, so that the start is left. */
static void test_nan_leaves_the_starting_impulses(void **state)
{
    (void)state;
    for (int k = 0; k < COULOMB_SOLVERS; ++k) {
        for (int place = 0; place < 4; ++place) {
            solving s;
            pe_contact_problem *source = problem_of_uniform_tower(4, 0.5);
            for (int j = 0; j < source->point_count; ++j) {
                source->points[j].impulse[0] = 0.03 + 0.001 * j;
            }
            poison(source, place);
            solving_begin(&s, source);
            const pe_solve_limits limits = {1e-8, SOLVING_ITERATIONS};
            assert_int_equal(SOLVERS[k].solve(&s, &limits, NULL), PE_OK);
            for (int j = 0; j < source->point_count; ++j) {
                if (!(s.problem.impulse[j][0] == source->points[j].impulse[0])) {
                    fail_msg("%s, NaN %d: impulse %d began as %g and was left as %g",
                             SOLVERS[k].name, place, j, source->points[j].impulse[0],
                             s.problem.impulse[j][0]);
                }
            }
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

static void test_every_failed_allocation_is_reported(void **state)
{
    (void)state;
    const named_solver by[] = {SOLVERS[0],
                               SOLVERS[1],
                               SOLVERS[2],
                               SOLVERS[3],
                               {.name = "island", .solve = solve_by_island}};
    for (int i = 0; i < 5; ++i) {
        pe_contact_problem *source = hard_problem();
        /* A tolerance that no solver reaches, so that all its stages run. */
        const pe_solve_limits limits = {1e-30, 60};
        long total = 0;
        for (long k = 0; k == 0 || k <= total; ++k) {
            solving s;
            pe_error error = {0};
            solving_begin(&s, source);
            long before = s.memory.made;
            s.memory.fail_at = k == 0 ? 0 : before + k;
            pe_status status = by[i].solve(&s, &limits, &error);
            if (k == 0) {
                assert_int_equal(status, PE_OK);
                total = s.memory.made - before;
                assert_true(total >= 10);
                print_message("%s: %ld allocations failed in turn\n", by[i].name, total);
            } else if (status != PE_NO_MEMORY || error.status != PE_NO_MEMORY) {
                fail_msg("%s: allocation %ld of %ld failed: status %d", by[i].name, k, total,
                         (int)status);
            }
            solving_end(&s);
        }
        pe_contact_problem_destroy(source);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_iteration_is_too_few_best_is_left),
        cmocka_unit_test(test_iteration_limits_hold_and_start_is_never_worsened),
        cmocka_unit_test(test_warm_islands_get_few_direct_iterations),
        cmocka_unit_test(test_flops_are_bounded),
        cmocka_unit_test(test_new_islands_are_bounded_by_the_cost_of_sweeps),
        cmocka_unit_test(test_nan_ends_and_is_not_converged),
        cmocka_unit_test(test_nan_leaves_the_starting_impulses),
        cmocka_unit_test(test_every_failed_allocation_is_reported),
    };
    return cmocka_run_group_tests_name("engine_direct_limits", tests, NULL, NULL);
}
