/* The kernels of the sweeps against textbook Gauss-Seidel, and the same bits at every width. */
#include "check.h"
#include "contact_problem_for_tests.h"
#include "solver/kernels.h"
#include "sweep_bench.h"

#include <math.h>
#include <string.h>

static void velocity_now(const sweep_bench *b, const pe_solver_manifold *manifold,
                         const pe_solver_point *point, double u[3])
{
    double q[6];
    pe_solver_manifold_twist(manifold, (const double(*)[6])b->velocity, q);
    pe_point_velocity(point, q, u);
}

/* Applies an impulse to the bodies' velocities. */
static void push(sweep_bench *b, const pe_solver_manifold *manifold, const pe_solver_point *point,
                 const double p[3])
{
    double wrench[6] = {0}, momentum[3][6] = {{0}}, gained[6];
    pe_wrench_add(point, p, wrench);
    pe_solver_manifold_push(manifold, wrench, momentum);
    for (int i = 0; i < b->problem.body_count; ++i) {
        pe_inverse_mass_times(&b->inertia[i], momentum[i], gained);
        for (int k = 0; k < 6; ++k) {
            b->velocity[i][k] += gained[k];
        }
    }
}

/* W of a point, by unit impulses. */
static void try_impulses(sweep_bench *b, const pe_solver_manifold *manifold,
                         const pe_solver_point *point, double w[3][3])
{
    double before[3], after[3];
    velocity_now(b, manifold, point, before);
    for (int k = 0; k < 3; ++k) {
        double unit[3] = {k == 0, k == 1, k == 2}, back[3] = {-unit[0], -unit[1], -unit[2]};
        push(b, manifold, point, unit);
        velocity_now(b, manifold, point, after);
        push(b, manifold, point, back);
        for (int j = 0; j < 3; ++j) {
            w[j][k] = after[j] - before[j];
        }
    }
}

static void set_beta(pe_sweep *sweep, double beta)
{
    const pe_sweep_part whole = pe_sweep_whole(sweep);
    pe_sweep_set_beta(sweep, &whole, beta);
}

static double residual_of(const pe_sweep *sweep)
{
    const pe_sweep_part whole = pe_sweep_whole(sweep);
    double residual;
    pe_sweep_residuals(sweep, &whole, 1, &residual);
    return residual;
}

static void store(const pe_sweep *sweep)
{
    const pe_sweep_part whole = pe_sweep_whole(sweep);
    pe_sweep_store(sweep, &whole);
}

/* Textbook Gauss-Seidel at one point. */
static void visit_plainly(sweep_bench *b, const pe_solver_manifold *manifold, int j)
{
    const pe_solver_point *point = &b->point[j];
    double w[3][3], u[3], *p = b->impulse[j];
    try_impulses(b, manifold, point, w);
    velocity_now(b, manifold, point, u);
    double normal[3] = {fmax(p[0] - u[0] / w[0][0], 0) - p[0], 0, 0};
    push(b, manifold, point, normal);
    p[0] += normal[0];
    velocity_now(b, manifold, point, u);
    double gain = 2 / (w[1][1] + w[2][2] + hypot(w[1][1] - w[2][2], 2 * w[1][2]));
    double t1 = p[1] - gain * u[1], t2 = p[2] - gain * u[2], length = hypot(t1, t2);
    double shrink = length > manifold->friction * p[0] ? manifold->friction * p[0] / length : 1;
    double tangential[3] = {0, shrink * t1 - p[1], shrink * t2 - p[2]};
    push(b, manifold, point, tangential);
    p[1] += tangential[1];
    p[2] += tangential[2];
}

static void test_a_sweep_is_gauss_seidel_point_by_point(void **state)
{
    sweep_bench *b = *state;
    static double plain[8][3];
    for (uint64_t seed = 1; seed < 60; ++seed) {
        bench_put_heap(b, seed, 2, 1, 8);
        b->manifold[0].a = seed % 2 ? 2 : 1; /* against a static body, or the other one */
        b->manifold[0].b = 0;
        pe_problem_rebuild_velocity(&b->problem);
        for (int sweep = 0; sweep < 3; ++sweep) {
            for (int j = 0; j < b->problem.point_count; ++j) {
                visit_plainly(b, &b->manifold[0], j);
            }
        }
        memcpy(plain, b->impulse, sizeof plain);
        bench_forget_impulses(b);
        pe_problem_rebuild_velocity(&b->problem);
        pe_sweep sweep;
        assert_int_equal(pe_sweep_create(&b->problem, pe_kernels_for(0)->sweep, bench_workspace(b),
                                         &sweep, NULL),
                         PE_OK);
        for (int i = 0; i < 3; ++i) {
            pe_sweep_cones(&sweep);
        }
        store(&sweep);
        for (int j = 0; j < b->problem.point_count; ++j) {
            for (int k = 0; k < 3; ++k) {
                assert_close(b->impulse[j][k], plain[j][k], 1e-11, 1e-11);
            }
        }
    }
}

static void test_sweep_residual_equals_the_reported_one(void **state)
{
    sweep_bench *b = *state;
    for (uint64_t seed = 1; seed < 20; ++seed) {
        bench_put_heap(b, seed, 60, 100, 8);
        pe_problem_rebuild_velocity(&b->problem);
        pe_sweep sweep;
        assert_int_equal(pe_sweep_create(&b->problem, pe_kernels_for(0)->sweep, bench_workspace(b),
                                         &sweep, NULL),
                         PE_OK);
        for (int i = 0; i < 4; ++i) {
            double seen = residual_of(&sweep);
            store(&sweep);
            pe_problem_rebuild_velocity(&b->problem);
            assert_close(seen, pe_problem_residual(&b->problem).max, 1e-11, 1e-11);
            pe_sweep_cones(&sweep);
        }
    }
}

typedef struct outcome {
    double impulse[BENCH_POINTS][3];
    double residual;
    pe_violation violation;
} outcome;

/* Some sweeps of both kinds with and without momentum. */
static void run(sweep_bench *b, const pe_sweep_kernel *kernel, outcome *o)
{
    pe_sweep sweep;
    bench_forget_impulses(b);
    pe_problem_rebuild_velocity(&b->problem);
    assert_int_equal(pe_sweep_create(&b->problem, kernel, bench_workspace(b), &sweep, NULL), PE_OK);
    for (int i = 0; i < 12; ++i) {
        set_beta(&sweep, i < 3 ? 0 : 0.8);
        pe_sweep_cones(&sweep);
    }
    o->residual = residual_of(&sweep);
    for (int i = 0; i < 12; ++i) {
        set_beta(&sweep, i < 3 ? 0 : 0.8);
        pe_sweep_normals(&sweep);
    }
    o->violation = pe_sweep_violation(&sweep);
    store(&sweep);
    memcpy(o->impulse, b->impulse, sizeof o->impulse);
}

static void test_every_width_gives_the_same_bits(void **state)
{
    sweep_bench *b = *state;
    static outcome one, wide;
    static const int lanes[] = {4, 8};
    for (uint64_t seed = 1; seed < 12; ++seed) {
        bench_put_heap(b, seed, 17 * (int)seed, 40 * (int)seed, 8);
        run(b, pe_kernels_for(1)->sweep, &one);
        assert_true(isfinite(one.residual) && one.residual > 0 && one.violation.deepest > 0);
        for (int k = 0; k < 2; ++k) {
            const pe_kernels *kernels = pe_kernels_for(lanes[k]);
            run(b, kernels->sweep, &wide); /* a narrower one if the processor lacks this width */
            assert_true(kernels->lanes <= lanes[k]);
            assert_memory_equal(wide.impulse, one.impulse, sizeof one.impulse);
            assert_memory_equal(&wide.residual, &one.residual, sizeof one.residual);
            assert_memory_equal(&wide.violation, &one.violation, sizeof one.violation);
        }
    }
}

/* One heavy plate with more small bodies on it than there are colours. */
static void test_more_contacts_than_colours_are_swept(void **state)
{
    sweep_bench *b = *state;
    enum { SMALL = 150 };
    bench_begin(b, SMALL + 1);
    bench_set_body(b, SMALL, 100, 50, 50, 50);
    b->free_velocity[SMALL][2] = -STEP * GRAVITY;
    const double up[3] = {0, 0, 1}, below[3] = {0, 0, -0.1}, none[3] = {0};
    for (int i = 0; i < SMALL; ++i) {
        const double at[3] = {0.1 * (i % 15 - 7), 0.1 * (i / 15) - 0.45, 0.1};
        bench_set_body(b, i, 0.1, 0.01, 0.01, 0.01);
        b->free_velocity[i][2] = -STEP * GRAVITY;
        bench_add_manifold(b, SMALL, i, up, 0.5, at, below);
        bench_add_point(b, 0, 0, 0, 0);
    }
    bench_add_manifold(b, SMALL + 1, SMALL, up, 0.5, none, below);
    bench_add_corners(b, 1);
    bench_solve(b, pe_solve_momentum, 1e-10, 100000);
    for (int i = 0; i < SMALL; ++i) {
        assert_close(b->impulse[i][0], 0.1 * GRAVITY * STEP, 1e-8, 0);
    }
    double sum = 0;
    for (int j = SMALL; j < SMALL + 4; ++j) {
        sum += b->impulse[j][0];
    }
    assert_close(sum, (100 + 0.1 * SMALL) * GRAVITY * STEP, 1e-8, 0);
}

/* Heaps of several sizes, of which some need many sweeps and some few. */
static void test_problems_swept_together_get_their_own_bits(void **state)
{
    enum { HEAPS = 6 };
    (void)state;
    sweep_bench *alone[HEAPS], *joined[HEAPS];
    const pe_problem *problems[HEAPS];
    pe_solve_report reports[HEAPS] = {{0}};
    const pe_solve_limits limits = {1e-4, 60};
    for (int momentum = 0; momentum < 2; ++momentum) {
        for (int i = 0; i < HEAPS; ++i) {
            bench_set_up((void **)&alone[i]);
            bench_set_up((void **)&joined[i]);
            bench_put_heap(alone[i], 1 + (uint64_t)i, 1 + 3 * i, 2 + 5 * i, 4);
            bench_put_heap(joined[i], 1 + (uint64_t)i, 1 + 3 * i, 2 + 5 * i, 4);
            pe_problem_rebuild_velocity(&joined[i]->problem);
            problems[i] = &joined[i]->problem;
        }
        assert_int_equal(pe_solve_together(problems, HEAPS, &limits, momentum != 0,
                                           bench_workspace(joined[0]), reports, NULL),
                         PE_OK);
        for (int i = 0; i < HEAPS; ++i) {
            const pe_solve_report report =
                bench_solve(alone[i], momentum != 0 ? pe_solve_momentum : pe_solve_gauss_seidel,
                            limits.tolerance, limits.max_iterations);
            assert_int_equal(reports[i].iterations, report.iterations);
            assert_int_equal(reports[i].stop, report.stop);
            assert_memory_equal(&reports[i].residual, &report.residual, sizeof report.residual);
            assert_memory_equal(joined[i]->impulse, alone[i]->impulse, sizeof alone[i]->impulse);
            bench_tear_down((void **)&alone[i]);
            bench_tear_down((void **)&joined[i]);
        }
    }
}

int main(void)
{
#define UNIT(test) cmocka_unit_test_setup_teardown(test, bench_set_up, bench_tear_down)
    const struct CMUnitTest tests[] = {
        UNIT(test_a_sweep_is_gauss_seidel_point_by_point),
        UNIT(test_sweep_residual_equals_the_reported_one),
        UNIT(test_every_width_gives_the_same_bits),
        UNIT(test_more_contacts_than_colours_are_swept),
        cmocka_unit_test(test_problems_swept_together_get_their_own_bits),
    };
    return cmocka_run_group_tests_name("engine_sweep_kernels", tests, NULL, NULL);
}
