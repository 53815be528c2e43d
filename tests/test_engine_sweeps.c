/* The sweeping solvers: closed forms, the contact law itself, and the same bits at every width. */
#include "check.h"

#include "solve/solve.h"
#include "solve/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double STEP = 1.0 / 60, GRAVITY = 9.81;

/* ---- Problems by hand --------------------------------------------------------------------------
 */

enum { MOST_BODIES = 300, MOST_PATCHES = 1200, MOST_POINTS = 6000 };

typedef struct bench {
    pe_problem problem;
    pe_inertia inertia[MOST_BODIES + 1];
    double free_velocity[MOST_BODIES + 1][6], velocity[MOST_BODIES + 1][6];
    pe_patch patch[MOST_PATCHES];
    pe_patch_point point[MOST_POINTS];
    double impulse[MOST_POINTS][3];
    pe_allocator allocator;
    pe_arena arena;
} bench;

static int set_up(void **state)
{
    *state = calloc(1, sizeof(bench));
    return *state == NULL;
}

static int tear_down(void **state)
{
    bench *b = *state;
    if (b->allocator.release != NULL) {
        pe_arena_free(&b->arena, &b->allocator);
    }
    free(b);
    return 0;
}

static void begin(bench *b, int bodies)
{
    memset(&b->problem, 0, sizeof b->problem);
    memset(b->free_velocity, 0, sizeof b->free_velocity);
    memset(b->inertia, 0, sizeof b->inertia);
    memset(b->impulse, 0, sizeof b->impulse);
    b->allocator = pe_allocator_default();
    b->problem = (pe_problem){
        .body_count = bodies,
        .inertia = b->inertia,
        .free_velocity = (const double(*)[6])b->free_velocity,
        .velocity = b->velocity,
        .patch = b->patch,
        .point = b->point,
        .impulse = b->impulse,
    };
}

/* Principal inertia along the world's axes. */
static void set_body(bench *b, int i, double mass, double x, double y, double z)
{
    b->inertia[i] = (pe_inertia){.mass = mass,
                                 .inverse_mass = 1 / mass,
                                 .tensor = {x, 0, 0, y, 0, z},
                                 .inverse_tensor = {1 / x, 0, 0, 1 / y, 0, 1 / z}};
}

/* A patch at arms from the two centres of mass; points follow. */
static void add_patch(bench *b, int body_a, int body_b, const double n[3], double friction,
                      const double arm_a[3], const double arm_b[3])
{
    pe_patch *patch = &b->patch[b->problem.patch_count++];
    *patch =
        (pe_patch){.a = body_a, .b = body_b, .first = b->problem.point_count, .friction = friction};
    /* Any tangent. */
    double e[3] = {fabs(n[0]) < 0.5, fabs(n[0]) >= 0.5, 0}, t[3];
    pe_cross3(n, e, t);
    double length = sqrt(pe_dot3(t, t));
    for (int k = 0; k < 3; ++k) {
        patch->frame[0][k] = n[k];
        patch->frame[1][k] = t[k] / length;
        patch->arm_a[k] = arm_a[k];
        patch->arm_b[k] = arm_b[k];
    }
    pe_cross3(patch->frame[0], patch->frame[1], patch->frame[2]);
}

/* A point of the patch added last, at s in its frame. */
static void add_point(bench *b, double s0, double s1, double s2, double bias)
{
    pe_patch *patch = &b->patch[b->problem.patch_count - 1];
    pe_patch_point *point = &b->point[b->problem.point_count++];
    *point = (pe_patch_point){.s = {s0, s1, s2}, .bias = bias};
    double ra[3], rb[3];
    for (int k = 0; k < 3; ++k) {
        double off = patch->frame[0][k] * s0 + patch->frame[1][k] * s1 + patch->frame[2][k] * s2;
        ra[k] = patch->arm_a[k] + off;
        rb[k] = patch->arm_b[k] + off;
    }
    point->scale = pe_point_scale(&b->inertia[patch->a], &b->inertia[patch->b], ra, rb);
    patch->count += 1;
}

/* The corners of a square face of the given half side. */
static void add_corners(bench *b, double half)
{
    for (int i = 0; i < 4; ++i) {
        add_point(b, 0, i & 1 ? half : -half, i & 2 ? half : -half, 0);
    }
}

static pe_workspace workspace(bench *b)
{
    pe_arena_reset(&b->arena, &b->allocator);
    return (pe_workspace){&b->arena, &b->allocator};
}

typedef pe_status solver(const pe_problem *problem, const pe_solve_limits *limits,
                         pe_workspace work, pe_solve_report *report, pe_error *error);

static solver *const solvers[] = {pe_solve_gauss_seidel, pe_solve_momentum};

static pe_solve_report solve(bench *b, solver *by, double tolerance, int most)
{
    pe_solve_report report = {0};
    pe_solve_limits limits = {.tolerance = tolerance, .max_iterations = most};
    pe_problem_rebuild_velocity(&b->problem);
    assert_int_equal(by(&b->problem, &limits, workspace(b), &report, NULL), PE_OK);
    return report;
}

static void forget_impulses(bench *b)
{
    memset(b->impulse, 0, sizeof b->impulse);
}

/* ---- Closed forms ------------------------------------------------------------------------------
 */

/* A cube of 1 m and 2 kg on a slope that falls towards +x; free of contacts it gains h g. */
static void put_on_slope(bench *b, double angle, double friction)
{
    begin(b, 1);
    set_body(b, 0, 2, 1.0 / 3, 1.0 / 3, 1.0 / 3);
    b->free_velocity[0][2] = -STEP * GRAVITY;
    double n[3] = {sin(angle), 0, cos(angle)}, arm[3] = {-n[0] / 2, 0, -n[2] / 2};
    add_patch(b, 1, 0, n, friction, arm, arm);
    add_corners(b, 0.5);
}

static void test_box_on_slope_below_the_friction_angle_stays(void **state)
{
    bench *b = *state;
    for (int k = 0; k < 2; ++k) {
        put_on_slope(b, atan(0.5) - 1e-3, 0.5);
        pe_solve_report report = solve(b, solvers[k], 1e-11, 20000);
        assert_int_equal(report.stop, PE_STOP_CONVERGED);
        for (int j = 0; j < 6; ++j) {
            assert_close(b->velocity[0][j], 0, 1e-8, 0);
        }
    }
}

static void test_box_on_slope_above_the_friction_angle_slides_as_newton_says(void **state)
{
    bench *b = *state;
    double angle = 0.7, gain = STEP * GRAVITY * (sin(angle) - 0.5 * cos(angle));
    for (int k = 0; k < 2; ++k) {
        put_on_slope(b, angle, 0.5);
        pe_solve_report report = solve(b, solvers[k], 1e-11, 20000);
        assert_int_equal(report.stop, PE_STOP_CONVERGED);
        assert_close(b->velocity[0][0], gain * cos(angle), 1e-8, 0);
        assert_close(b->velocity[0][2], -gain * sin(angle), 1e-8, 0);
        assert_close(b->velocity[0][4], 0, 1e-8, 0);
    }
}

/* Cubes on each other, the k-th k + 1 kg. */
static void put_tower(bench *b, int height)
{
    begin(b, height);
    const double up[3] = {0, 0, 1}, below[3] = {0, 0, -0.5}, above[3] = {0, 0, 0.5};
    for (int i = 0; i < height; ++i) {
        double mass = i + 1.0;
        set_body(b, i, mass, mass / 6, mass / 6, mass / 6);
        b->free_velocity[i][2] = -STEP * GRAVITY;
        add_patch(b, i == 0 ? height : i - 1, i, up, 0.5, above, below);
        add_corners(b, 0.5);
    }
}

static void test_each_contact_of_a_tower_carries_what_stands_on_it(void **state)
{
    bench *b = *state;
    for (int k = 0; k < 2; ++k) {
        put_tower(b, 2);
        solve(b, solvers[k], 1e-11, 100000);
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
    bench *b = *state;
    const double up[3] = {0, 0, 1}, below[3] = {0, 0, -0.5}, none[3] = {0};
    for (int k = 0; k < 2; ++k) {
        begin(b, 1);
        set_body(b, 0, 3, 0.3, 0.3, 0.3);
        b->free_velocity[0][2] = -4.1;
        add_patch(b, 1, 0, up, 0, none, below);
        add_point(b, 0, 0, 0, 0.8 * -4);
        solve(b, solvers[k], 1e-12, 100);
        assert_close(b->velocity[0][2], 3.2, 1e-12, 0);
        assert_close(b->impulse[0][0], 3 * (4.1 + 3.2), 1e-12, 0);
    }
}

static void test_a_gap_may_close_just_as_far_as_it_is_wide(void **state)
{
    bench *b = *state;
    const double up[3] = {0, 0, 1}, none[3] = {0};
    begin(b, 1);
    set_body(b, 0, 3, 0.3, 0.3, 0.3);
    b->free_velocity[0][2] = -4;
    add_patch(b, 1, 0, up, 0, none, none);
    add_point(b, 0, 0, 0, 1.5);
    solve(b, pe_solve_momentum, 1e-12, 100);
    assert_close(b->velocity[0][2], -1.5, 1e-12, 0);
}

/* ---- Heaps -------------------------------------------------------------------------------------
 */

/* Bodies of all shapes and weights in a random net of patches of 1 to `most` points, falling. */
static void put_heap(bench *b, uint64_t seed, int bodies, int patches, int most)
{
    check_random random = {seed};
    begin(b, bodies);
    for (int i = 0; i < bodies; ++i) {
        double m = check_uniform(&random, 0.5, 2);
        set_body(b, i, m, m * check_uniform(&random, 0.1, 0.3),
                 m * check_uniform(&random, 0.1, 0.3), m * check_uniform(&random, 0.1, 0.3));
        for (int k = 0; k < 6; ++k) {
            b->free_velocity[i][k] = check_uniform(&random, -1, 1);
        }
    }
    for (int i = 0; i < patches; ++i) {
        int one = (int)check_uniform(&random, 0, bodies);
        int other = i % 5 == 0 ? bodies : (int)check_uniform(&random, 0, bodies);
        if (one == other) {
            other = bodies;
        }
        double n[3], arm_a[3] = {0}, arm_b[3], length = 0;
        for (int k = 0; k < 3; ++k) {
            n[k] = check_uniform(&random, -1, 1);
            length += n[k] * n[k];
        }
        for (int k = 0; k < 3; ++k) {
            n[k] /= sqrt(length);
            arm_b[k] = -0.5 * n[k] + check_uniform(&random, -0.2, 0.2);
            arm_a[k] = 0.5 * n[k] + check_uniform(&random, -0.2, 0.2);
        }
        add_patch(b, other, one, n, check_uniform(&random, 0, 1), arm_a, arm_b);
        int count = 1 + (int)check_uniform(&random, 0, most);
        for (int j = 0; j < count; ++j) {
            double s1 = check_uniform(&random, -0.3, 0.3), s2 = check_uniform(&random, -0.3, 0.3);
            double gap = check_uniform(&random, -0.5, 0.5);
            add_point(b, check_uniform(&random, -0.01, 0.01), s1, s2, gap > 0 ? gap : 0);
        }
    }
}

static void test_both_solvers_meet_the_contact_law(void **state)
{
    bench *b = *state;
    for (int k = 0; k < 2; ++k) {
        put_heap(b, 5, 60, 90, 4);
        pe_solve_report report = solve(b, solvers[k], 1e-10, 200000);
        assert_int_equal(report.stop, PE_STOP_CONVERGED);
        int sliding = 0, sticking = 0;
        for (int i = 0; i < b->problem.patch_count; ++i) {
            const pe_patch *patch = &b->patch[i];
            double q[6], u[3];
            pe_patch_twist(patch, (const double(*)[6])b->velocity, q);
            for (int j = patch->first; j < patch->first + patch->count; ++j) {
                const double *p = b->impulse[j];
                pe_point_velocity(&b->point[j], q, u);
                double friction = hypot(p[1], p[2]), most = patch->friction * p[0];
                double slip = hypot(u[1], u[2]);
                assert_true(p[0] >= 0);
                assert_at_most(friction, most * (1 + 1e-12));
                assert_at_most(-u[0], 1e-8);
                assert_close(p[0] * u[0], 0, 1e-8, 0);
                if (p[0] > 1e-3 && slip > 1e-3) {
                    assert_close(friction, most, 1e-8, 0); /* dissipates all it can */
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
    bench *b = *state;
    static double found[MOST_BODIES][6];
    put_tower(b, 6);
    b->free_velocity[3][0] = 0.05; /* held by friction */
    solve(b, pe_solve_gauss_seidel, 1e-11, 400000);
    memcpy(found, b->velocity, sizeof found);
    forget_impulses(b);
    solve(b, pe_solve_momentum, 1e-11, 400000);
    for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < 6; ++k) {
            assert_close(b->velocity[i][k], found[i][k], 1e-8, 0);
        }
    }
}

static void test_momentum_needs_at_most_half_the_sweeps_on_a_tower(void **state)
{
    bench *b = *state;
    put_tower(b, 12);
    int plain = solve(b, pe_solve_gauss_seidel, 1e-5, 100000).iterations;
    forget_impulses(b);
    int with_momentum = solve(b, pe_solve_momentum, 1e-5, 100000).iterations;
    assert_true(2 * with_momentum <= plain);
}

static void test_no_sweep_leaves_worse_than_it_found(void **state)
{
    bench *b = *state;
    for (uint64_t seed = 1; seed < 40; ++seed) {
        put_heap(b, seed, 40, 70, 4);
        pe_problem_rebuild_velocity(&b->problem);
        double before = pe_problem_residual(&b->problem).max;
        for (int most = 0; most < 12; most += 3) {
            pe_solve_report report = solve(b, solvers[seed % 2], 1e-12, most);
            assert_true(report.iterations <= most);
            assert_at_most(report.residual.max, before * (1 + 1e-12));
            before = report.residual.max;
        }
    }
}

static void test_the_best_iterate_that_was_looked_at_is_left(void **state)
{
    bench *b = *state;
    int rose = 0;
    for (uint64_t seed = 1; seed < 40; ++seed) {
        pe_solve_mark marks[40];
        pe_solve_history history = {.marks = marks, .capacity = 40};
        pe_solve_report report = {.history = &history};
        pe_solve_limits limits = {1e-12, 60};
        put_heap(b, seed, 40, 70, 4);
        pe_problem_rebuild_velocity(&b->problem);
        assert_int_equal(pe_solve_momentum(&b->problem, &limits, workspace(b), &report, NULL),
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
    bench *b = *state;
    static double left[MOST_BODIES][6];
    put_heap(b, 9, 50, 90, 4);
    pe_solve_report report = solve(b, pe_solve_momentum, 1e-3, 37);
    memcpy(left, b->velocity, sizeof left);
    assert_close(report.residual.max, pe_problem_residual(&b->problem).max, 0, 0);
    pe_problem_rebuild_velocity(&b->problem);
    assert_memory_equal(left, b->velocity, sizeof left);
}

/* ---- The kernels -------------------------------------------------------------------------------
 */

static void velocity_now(const bench *b, const pe_patch *patch, const pe_patch_point *point,
                         double u[3])
{
    double q[6];
    pe_patch_twist(patch, (const double(*)[6])b->velocity, q);
    pe_point_velocity(point, q, u);
}

/* What an impulse does to the bodies' velocities. */
static void push(bench *b, const pe_patch *patch, const pe_patch_point *point, const double p[3])
{
    double wrench[6] = {0}, momentum[3][6] = {{0}}, gained[6];
    pe_wrench_add(point, p, wrench);
    pe_patch_push(patch, wrench, momentum);
    for (int i = 0; i < b->problem.body_count; ++i) {
        pe_inverse_mass_times(&b->inertia[i], momentum[i], gained);
        for (int k = 0; k < 6; ++k) {
            b->velocity[i][k] += gained[k];
        }
    }
}

/* W of a point, by trying unit impulses. */
static void try_impulses(bench *b, const pe_patch *patch, const pe_patch_point *point,
                         double w[3][3])
{
    double before[3], after[3];
    velocity_now(b, patch, point, before);
    for (int k = 0; k < 3; ++k) {
        double unit[3] = {k == 0, k == 1, k == 2}, back[3] = {-unit[0], -unit[1], -unit[2]};
        push(b, patch, point, unit);
        velocity_now(b, patch, point, after);
        push(b, patch, point, back);
        for (int j = 0; j < 3; ++j) {
            w[j][k] = after[j] - before[j];
        }
    }
}

/* Gauss-Seidel by the book at one point. */
static void visit_plainly(bench *b, const pe_patch *patch, int j)
{
    const pe_patch_point *point = &b->point[j];
    double w[3][3], u[3], *p = b->impulse[j];
    try_impulses(b, patch, point, w);
    velocity_now(b, patch, point, u);
    double normal[3] = {fmax(p[0] - u[0] / w[0][0], 0) - p[0], 0, 0};
    push(b, patch, point, normal);
    p[0] += normal[0];
    velocity_now(b, patch, point, u);
    double gain = 2 / (w[1][1] + w[2][2] + hypot(w[1][1] - w[2][2], 2 * w[1][2]));
    double t1 = p[1] - gain * u[1], t2 = p[2] - gain * u[2], length = hypot(t1, t2);
    double shrink = length > patch->friction * p[0] ? patch->friction * p[0] / length : 1;
    double tangential[3] = {0, shrink * t1 - p[1], shrink * t2 - p[2]};
    push(b, patch, point, tangential);
    p[1] += tangential[1];
    p[2] += tangential[2];
}

static void test_a_sweep_is_gauss_seidel_point_by_point(void **state)
{
    bench *b = *state;
    static double plain[8][3];
    for (uint64_t seed = 1; seed < 60; ++seed) {
        put_heap(b, seed, 2, 1, 8);
        b->patch[0].a = seed % 2 ? 2 : 1; /* against what is static, or the other body */
        b->patch[0].b = 0;
        pe_problem_rebuild_velocity(&b->problem);
        for (int sweep = 0; sweep < 3; ++sweep) {
            for (int j = 0; j < b->problem.point_count; ++j) {
                visit_plainly(b, &b->patch[0], j);
            }
        }
        memcpy(plain, b->impulse, sizeof plain);
        forget_impulses(b);
        pe_problem_rebuild_velocity(&b->problem);
        pe_sweep sweep;
        assert_int_equal(
            pe_sweep_create(&b->problem, pe_sweep_kernel_for(0), workspace(b), &sweep, NULL),
            PE_OK);
        for (int i = 0; i < 3; ++i) {
            pe_sweep_cones(&sweep, 0);
        }
        pe_sweep_store(&sweep);
        for (int j = 0; j < b->problem.point_count; ++j) {
            for (int k = 0; k < 3; ++k) {
                assert_close(b->impulse[j][k], plain[j][k], 1e-11, 1e-11);
            }
        }
    }
}

static void test_sweeps_see_the_residual_that_is_reported(void **state)
{
    bench *b = *state;
    for (uint64_t seed = 1; seed < 20; ++seed) {
        put_heap(b, seed, 60, 100, 8);
        pe_problem_rebuild_velocity(&b->problem);
        pe_sweep sweep;
        assert_int_equal(
            pe_sweep_create(&b->problem, pe_sweep_kernel_for(0), workspace(b), &sweep, NULL),
            PE_OK);
        for (int i = 0; i < 4; ++i) {
            double seen = pe_sweep_residual(&sweep);
            pe_sweep_store(&sweep);
            pe_problem_rebuild_velocity(&b->problem);
            assert_close(seen, pe_problem_residual(&b->problem).max, 1e-11, 1e-11);
            pe_sweep_cones(&sweep, 0);
        }
    }
}

typedef struct outcome {
    double impulse[MOST_POINTS][3];
    double residual;
    pe_violation violation;
} outcome;

/* Some sweeps of both kinds with and without momentum. */
static void run(bench *b, const pe_sweep_kernel *kernel, outcome *o)
{
    pe_sweep sweep;
    forget_impulses(b);
    pe_problem_rebuild_velocity(&b->problem);
    assert_int_equal(pe_sweep_create(&b->problem, kernel, workspace(b), &sweep, NULL), PE_OK);
    for (int i = 0; i < 12; ++i) {
        pe_sweep_cones(&sweep, i < 3 ? 0 : 0.8);
    }
    o->residual = pe_sweep_residual(&sweep);
    for (int i = 0; i < 12; ++i) {
        pe_sweep_normals(&sweep, i < 3 ? 0 : 0.8);
    }
    o->violation = pe_sweep_violation(&sweep);
    pe_sweep_store(&sweep);
    memcpy(o->impulse, b->impulse, sizeof o->impulse);
}

static void test_every_width_gives_the_same_bits(void **state)
{
    bench *b = *state;
    static outcome one, wide;
    static const int lanes[] = {4, 8};
    for (uint64_t seed = 1; seed < 12; ++seed) {
        put_heap(b, seed, 17 * (int)seed, 40 * (int)seed, 8);
        run(b, pe_sweep_kernel_for(1), &one);
        assert_true(isfinite(one.residual) && one.residual > 0 && one.violation.deepest > 0);
        for (int k = 0; k < 2; ++k) {
            const pe_sweep_kernel *kernel = pe_sweep_kernel_for(lanes[k]);
            run(b, kernel, &wide); /* a narrower one where the processor has no such width */
            assert_true(kernel->lanes <= lanes[k]);
            assert_memory_equal(wide.impulse, one.impulse, sizeof one.impulse);
            assert_memory_equal(&wide.residual, &one.residual, sizeof one.residual);
            assert_memory_equal(&wide.violation, &one.violation, sizeof one.violation);
        }
    }
}

/* One heavy plate with more small bodies on it than there are colours. */
static void test_a_body_with_more_contacts_than_colours_is_swept_too(void **state)
{
    bench *b = *state;
    enum { SMALL = 150 };
    begin(b, SMALL + 1);
    set_body(b, SMALL, 100, 50, 50, 50);
    b->free_velocity[SMALL][2] = -STEP * GRAVITY;
    const double up[3] = {0, 0, 1}, below[3] = {0, 0, -0.1}, none[3] = {0};
    for (int i = 0; i < SMALL; ++i) {
        const double at[3] = {0.1 * (i % 15 - 7), 0.1 * (i / 15) - 0.45, 0.1};
        set_body(b, i, 0.1, 0.01, 0.01, 0.01);
        b->free_velocity[i][2] = -STEP * GRAVITY;
        add_patch(b, SMALL, i, up, 0.5, at, below);
        add_point(b, 0, 0, 0, 0);
    }
    add_patch(b, SMALL + 1, SMALL, up, 0.5, none, below);
    add_corners(b, 1);
    solve(b, pe_solve_momentum, 1e-10, 100000);
    for (int i = 0; i < SMALL; ++i) {
        assert_close(b->impulse[i][0], 0.1 * GRAVITY * STEP, 1e-8, 0);
    }
    double sum = 0;
    for (int j = SMALL; j < SMALL + 4; ++j) {
        sum += b->impulse[j][0];
    }
    assert_close(sum, (100 + 0.1 * SMALL) * GRAVITY * STEP, 1e-8, 0);
}

static void *none_left(void *context, size_t size)
{
    (void)size;
    int *left = context;
    return *left > 0 && (*left)-- > 0 ? aligned_alloc(64, (size + 63) / 64 * 64) : NULL;
}

static void release(void *context, void *memory)
{
    (void)context;
    free(memory);
}

static void test_without_memory_the_status_says_so(void **state)
{
    bench *b = *state;
    put_tower(b, 3);
    pe_problem_rebuild_velocity(&b->problem);
    for (int blocks = 0;; ++blocks) {
        int left = blocks;
        pe_allocator allocator = {none_left, release, &left};
        pe_arena arena = {0};
        pe_solve_report report = {0};
        pe_error error = {0};
        pe_solve_limits limits = {1e-6, 10};
        pe_status status = pe_solve_momentum(&b->problem, &limits,
                                             (pe_workspace){&arena, &allocator}, &report, &error);
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

static void test_history_notes_the_looks(void **state)
{
    bench *b = *state;
    pe_solve_mark marks[3];
    pe_solve_history history = {.marks = marks, .capacity = 3};
    pe_solve_report report = {.history = &history};
    pe_solve_limits limits = {1e-12, 40};
    put_tower(b, 8);
    pe_problem_rebuild_velocity(&b->problem);
    assert_int_equal(pe_solve_momentum(&b->problem, &limits, workspace(b), &report, NULL), PE_OK);
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
#define UNIT(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        UNIT(test_box_on_slope_below_the_friction_angle_stays),
        UNIT(test_box_on_slope_above_the_friction_angle_slides_as_newton_says),
        UNIT(test_each_contact_of_a_tower_carries_what_stands_on_it),
        UNIT(test_a_bounce_leaves_with_restitution_times_the_approach),
        UNIT(test_a_gap_may_close_just_as_far_as_it_is_wide),
        UNIT(test_both_solvers_meet_the_contact_law),
        UNIT(test_both_solvers_find_the_same_velocities),
        UNIT(test_momentum_needs_at_most_half_the_sweeps_on_a_tower),
        UNIT(test_no_sweep_leaves_worse_than_it_found),
        UNIT(test_the_best_iterate_that_was_looked_at_is_left),
        UNIT(test_velocities_are_left_in_step_with_impulses),
        UNIT(test_a_sweep_is_gauss_seidel_point_by_point),
        UNIT(test_sweeps_see_the_residual_that_is_reported),
        UNIT(test_every_width_gives_the_same_bits),
        UNIT(test_a_body_with_more_contacts_than_colours_is_swept_too),
        UNIT(test_without_memory_the_status_says_so),
        UNIT(test_history_notes_the_looks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
