/* The Gauss-Seidel solvers: closed forms, and the contact law itself. */
#include "check.h"
#include "contact_problem_for_tests.h"
#include "counting_allocator.h"
#include "sweep_bench.h"

#include <math.h>
#include <string.h>

static sweep_solver *const solvers[] = {pe_solve_gauss_seidel, pe_solve_momentum};

/* ---- Closed forms ---- */

/* A cube of 1 m and 2 kg on a slope down towards +x; without contacts it gains h g in a step. */
static void put_on_slope(sweep_bench *b, double angle, double friction)
{
    bench_begin(b, 1);
    bench_set_body(b, 0, 2, 1.0 / 3, 1.0 / 3, 1.0 / 3);
    b->free_velocity[0][2] = -STEP * GRAVITY;
    double n[3] = {sin(angle), 0, cos(angle)}, arm[3] = {-n[0] / 2, 0, -n[2] / 2};
    bench_add_manifold(b, 1, 0, n, friction, arm, arm);
    bench_add_corners(b, 0.5);
}

static void test_box_sticks_below_the_friction_angle(void **state)
{
    sweep_bench *b = *state;
    for (int k = 0; k < 2; ++k) {
        put_on_slope(b, atan(0.5) - 1e-3, 0.5);
        pe_solve_report report = bench_solve(b, solvers[k], 1e-11, 20000);
        assert_int_equal(report.stop, PE_STOP_CONVERGED);
        for (int j = 0; j < 6; ++j) {
            assert_close(b->velocity[0][j], 0, 1e-8, 0);
        }
    }
}

static void test_box_slides_above_friction_angle_by_newtons_law(void **state)
{
    sweep_bench *b = *state;
    double angle = 0.7, gain = STEP * GRAVITY * (sin(angle) - 0.5 * cos(angle));
    for (int k = 0; k < 2; ++k) {
        put_on_slope(b, angle, 0.5);
        pe_solve_report report = bench_solve(b, solvers[k], 1e-11, 20000);
        assert_int_equal(report.stop, PE_STOP_CONVERGED);
        assert_close(b->velocity[0][0], gain * cos(angle), 1e-8, 0);
        assert_close(b->velocity[0][2], -gain * sin(angle), 1e-8, 0);
        assert_close(b->velocity[0][4], 0, 1e-8, 0);
    }
}

/* Cubes on each other; the k-th has k + 1 kg. */
static void put_tower(sweep_bench *b, int height)
{
    bench_begin(b, height);
    const double up[3] = {0, 0, 1}, below[3] = {0, 0, -0.5}, above[3] = {0, 0, 0.5};
    for (int i = 0; i < height; ++i) {
        double mass = i + 1.0;
        bench_set_body(b, i, mass, mass / 6, mass / 6, mass / 6);
        b->free_velocity[i][2] = -STEP * GRAVITY;
        bench_add_manifold(b, i == 0 ? height : i - 1, i, up, 0.5, above, below);
        bench_add_corners(b, 0.5);
    }
}

static void test_tower_contact_carries_the_weight_above(void **state)
{
    sweep_bench *b = *state;
    for (int k = 0; k < 2; ++k) {
        put_tower(b, 2);
        bench_solve(b, solvers[k], 1e-11, 100000);
        for (int i = 0; i < 2; ++i) {
            double sum = 0;
            for (int j = 4 * i; j < 4 * i + 4; ++j) {
                sum += b->impulse[j][0];
            }
            assert_close(sum, (i == 0 ? 3 : 2) * GRAVITY * STEP, 1e-8, 0);
        }
    }
}

static void test_a_bounce_leaves_with_restitution_times_the_approach(void **state)
{
    sweep_bench *b = *state;
    const double up[3] = {0, 0, 1}, below[3] = {0, 0, -0.5}, none[3] = {0};
    for (int k = 0; k < 2; ++k) {
        bench_begin(b, 1);
        bench_set_body(b, 0, 3, 0.3, 0.3, 0.3);
        b->free_velocity[0][2] = -4.1;
        bench_add_manifold(b, 1, 0, up, 0, none, below);
        bench_add_point(b, 0, 0, 0, 0.8 * -4);
        bench_solve(b, solvers[k], 1e-12, 100);
        assert_close(b->velocity[0][2], 3.2, 1e-12, 0);
        assert_close(b->impulse[0][0], 3 * (4.1 + 3.2), 1e-12, 0);
    }
}

static void test_gap_closes_exactly(void **state)
{
    sweep_bench *b = *state;
    const double up[3] = {0, 0, 1}, none[3] = {0};
    bench_begin(b, 1);
    bench_set_body(b, 0, 3, 0.3, 0.3, 0.3);
    b->free_velocity[0][2] = -4;
    bench_add_manifold(b, 1, 0, up, 0, none, none);
    bench_add_point(b, 0, 0, 0, 1.5);
    bench_solve(b, pe_solve_momentum, 1e-12, 100);
    assert_close(b->velocity[0][2], -1.5, 1e-12, 0);
}

/* ---- Heaps ---- */

static void test_both_solvers_meet_the_contact_law(void **state)
{
    sweep_bench *b = *state;
    for (int k = 0; k < 2; ++k) {
        bench_put_heap(b, 5, 60, 90, 4);
        pe_solve_report report = bench_solve(b, solvers[k], 1e-10, 200000);
        assert_int_equal(report.stop, PE_STOP_CONVERGED);
        int sliding = 0, sticking = 0;
        for (int i = 0; i < b->problem.manifold_count; ++i) {
            const pe_solver_manifold *manifold = &b->manifold[i];
            double q[6], u[3];
            pe_solver_manifold_twist(manifold, (const double(*)[6])b->velocity, q);
            for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
                const double *p = b->impulse[j];
                pe_point_velocity(&b->point[j], q, u);
                double friction = hypot(p[1], p[2]), most = manifold->friction * p[0];
                double slip = hypot(u[1], u[2]);
                assert_true(p[0] >= 0);
                assert_at_most(friction, most * (1 + 1e-12));
                assert_at_most(-u[0], 1e-8);
                assert_close(p[0] * u[0], 0, 1e-8, 0);
                if (p[0] > 1e-3 && slip > 1e-3) {
                    assert_close(friction, most, 1e-8, 0); /* the largest dissipation */
                    assert_close(p[1] * u[1] + p[2] * u[2], -friction * slip, 1e-8, 0);
                    ++sliding;
                }
                sticking += p[0] > 1e-3 && slip < 1e-8;
            }
        }
        assert_true(sliding > 5 && sticking > 5);
    }
}

static void test_both_solvers_find_the_same_velocities(void **state)
{
    sweep_bench *b = *state;
    static double found[BENCH_BODIES][6];
    put_tower(b, 6);
    b->free_velocity[3][0] = 0.05; /* held by friction */
    bench_solve(b, pe_solve_gauss_seidel, 1e-11, 400000);
    memcpy(found, b->velocity, sizeof found);
    bench_forget_impulses(b);
    bench_solve(b, pe_solve_momentum, 1e-11, 400000);
    for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < 6; ++k) {
            assert_close(b->velocity[i][k], found[i][k], 1e-8, 0);
        }
    }
}

static void test_momentum_halves_the_sweeps_on_a_tower(void **state)
{
    sweep_bench *b = *state;
    put_tower(b, 12);
    int plain = bench_solve(b, pe_solve_gauss_seidel, 1e-5, 100000).iterations;
    bench_forget_impulses(b);
    int with_momentum = bench_solve(b, pe_solve_momentum, 1e-5, 100000).iterations;
    assert_true(2 * with_momentum <= plain);
}

static void test_residual_never_grows(void **state)
{
    sweep_bench *b = *state;
    for (uint64_t seed = 1; seed < 40; ++seed) {
        bench_put_heap(b, seed, 40, 70, 4);
        pe_problem_rebuild_velocity(&b->problem);
        double before = pe_problem_residual(&b->problem).max;
        for (int most = 0; most < 12; most += 3) {
            pe_solve_report report = bench_solve(b, solvers[seed % 2], 1e-12, most);
            assert_true(report.iterations <= most);
            assert_at_most(report.residual.max, before * (1 + 1e-12));
            before = report.residual.max;
        }
    }
}

static void test_best_evaluated_iterate_is_left(void **state)
{
    sweep_bench *b = *state;
    int rose = 0;
    for (uint64_t seed = 1; seed < 40; ++seed) {
        pe_solve_mark marks[40];
        pe_solve_history history = {.marks = marks, .capacity = 40};
        pe_solve_report report = {.history = &history};
        pe_solve_limits limits = {1e-12, 60};
        bench_put_heap(b, seed, 40, 70, 4);
        pe_problem_rebuild_velocity(&b->problem);
        assert_int_equal(pe_solve_momentum(&b->problem, &limits, bench_workspace(b), &report, NULL),
                         PE_OK);
        double best = marks[0].residual;
        for (int i = 1; i < history.count; ++i) {
            best = fmin(best, marks[i].residual);
        }
        assert_close(report.residual.max, best, 1e-12, 1e-9);
        rose += best < marks[history.count - 1].residual;
    }
    assert_true(rose > 0);
}

static void test_velocities_are_left_in_step_with_impulses(void **state)
{
    sweep_bench *b = *state;
    static double left[BENCH_BODIES][6];
    bench_put_heap(b, 9, 50, 90, 4);
    pe_solve_report report = bench_solve(b, pe_solve_momentum, 1e-3, 37);
    memcpy(left, b->velocity, sizeof left);
    assert_close(report.residual.max, pe_problem_residual(&b->problem).max, 0, 0);
    pe_problem_rebuild_velocity(&b->problem);
    assert_memory_equal(left, b->velocity, sizeof left);
}

/* ---- Memory and history ---- */

static void test_out_of_memory_is_reported(void **state)
{
    sweep_bench *b = *state;
    put_tower(b, 3);
    pe_problem_rebuild_velocity(&b->problem);
    for (int blocks = 0;; ++blocks) {
        counter c = {.fail_at = blocks, .lasting = true};
        pe_allocator allocator = {count_allocate, count_release, &c};
        pe_arena arena = {0};
        pe_solve_report report = {0};
        pe_error error = {0};
        pe_solve_limits limits = {1e-6, 10};
        pe_status status = pe_solve_momentum(
            &b->problem, &limits, (pe_workspace){&arena, &allocator, NULL}, &report, &error);
        pe_arena_free(&arena, &allocator);
        if (status == PE_OK) {
            assert_true(blocks > 3);
            break;
        }
        assert_int_equal(status, PE_NO_MEMORY);
        assert_contains(error.message, "12 contact points");
        assert_true(blocks < 20);
    }
}

static void test_history_holds_the_evaluated_residuals(void **state)
{
    sweep_bench *b = *state;
    pe_solve_mark marks[3];
    pe_solve_history history = {.marks = marks, .capacity = 3};
    pe_solve_report report = {.history = &history};
    pe_solve_limits limits = {1e-12, 40};
    put_tower(b, 8);
    pe_problem_rebuild_velocity(&b->problem);
    assert_int_equal(pe_solve_momentum(&b->problem, &limits, bench_workspace(b), &report, NULL),
                     PE_OK);
    assert_int_equal(report.iterations, 40);
    assert_int_equal(report.stop, PE_STOP_ITERATIONS);
    assert_int_equal(history.count, 3);
    for (int i = 0; i < 3; ++i) {
        assert_true(marks[i].iterations > (i > 0 ? marks[i - 1].iterations : 0));
        assert_true(marks[i].residual > 0);
    }
}

int main(void)
{
#define UNIT(test) cmocka_unit_test_setup_teardown(test, bench_set_up, bench_tear_down)
    const struct CMUnitTest tests[] = {
        UNIT(test_box_sticks_below_the_friction_angle),
        UNIT(test_box_slides_above_friction_angle_by_newtons_law),
        UNIT(test_tower_contact_carries_the_weight_above),
        UNIT(test_a_bounce_leaves_with_restitution_times_the_approach),
        UNIT(test_gap_closes_exactly),
        UNIT(test_both_solvers_meet_the_contact_law),
        UNIT(test_both_solvers_find_the_same_velocities),
        UNIT(test_momentum_halves_the_sweeps_on_a_tower),
        UNIT(test_residual_never_grows),
        UNIT(test_best_evaluated_iterate_is_left),
        UNIT(test_velocities_are_left_in_step_with_impulses),
        UNIT(test_out_of_memory_is_reported),
        UNIT(test_history_holds_the_evaluated_residuals),
    };
    return cmocka_run_group_tests_name("engine_sweeps", tests, NULL, NULL);
}
