#include "sweep_bench.h"

#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int bench_set_up(void **state)
{
    *state = calloc(1, sizeof(sweep_bench));
    return *state == NULL;
}

int bench_tear_down(void **state)
{
    sweep_bench *b = *state;
    if (b->allocator.release != NULL) {
        pe_arena_free(&b->arena, &b->allocator);
    }
    free(b);
    return 0;
}

void bench_begin(sweep_bench *b, int bodies)
{
    memset(&b->problem, 0, sizeof b->problem);
    memset(b->free_velocity, 0, sizeof b->free_velocity);
    memset(b->inertia, 0, sizeof b->inertia);
    memset(b->impulse, 0, sizeof b->impulse);
    b->allocator = pe_allocator_default();
    b->problem = (pe_problem){
        .body_count = bodies,
        .inertia = b->inertia,
        .free_velocity = b->free_velocity,
        .velocity = b->velocity,
        .manifold = b->manifold,
        .point = b->point,
        .impulse = b->impulse,
    };
}

void bench_set_body(sweep_bench *b, int i, double mass, double x, double y, double z)
{
    b->inertia[i] = (pe_inertia){.mass = mass,
                                 .inverse_mass = 1 / mass,
                                 .tensor = {x, 0, 0, y, 0, z},
                                 .inverse_tensor = {1 / x, 0, 0, 1 / y, 0, 1 / z}};
}

void bench_add_manifold(sweep_bench *b, int body_a, int body_b, const double n[3], double friction,
                        const double arm_a[3], const double arm_b[3])
{
    pe_solver_manifold *manifold = &b->manifold[b->problem.manifold_count++];
    *manifold = (pe_solver_manifold){
        .a = body_a, .b = body_b, .first = b->problem.point_count, .friction = friction};
    /* Any tangent. */
    double e[3] = {fabs(n[0]) < 0.5, fabs(n[0]) >= 0.5, 0}, t[3];
    pe_cross3(n, e, t);
    double length = sqrt(pe_dot3(t, t));
    for (int k = 0; k < 3; ++k) {
        manifold->frame[0][k] = n[k];
        manifold->frame[1][k] = t[k] / length;
        manifold->arm_a[k] = arm_a[k];
        manifold->arm_b[k] = arm_b[k];
    }
    pe_cross3(manifold->frame[0], manifold->frame[1], manifold->frame[2]);
}

void bench_add_point(sweep_bench *b, double s0, double s1, double s2, double bias)
{
    pe_solver_manifold *manifold = &b->manifold[b->problem.manifold_count - 1];
    pe_solver_point *point = &b->point[b->problem.point_count++];
    *point = (pe_solver_point){.s = {s0, s1, s2}, .bias = bias};
    double ra[3], rb[3];
    for (int k = 0; k < 3; ++k) {
        double off =
            manifold->frame[0][k] * s0 + manifold->frame[1][k] * s1 + manifold->frame[2][k] * s2;
        ra[k] = manifold->arm_a[k] + off;
        rb[k] = manifold->arm_b[k] + off;
    }
    point->scale = pe_point_scale(&b->inertia[manifold->a], &b->inertia[manifold->b], ra, rb);
    manifold->count += 1;
}

void bench_add_corners(sweep_bench *b, double half)
{
    for (int i = 0; i < 4; ++i) {
        bench_add_point(b, 0, i & 1 ? half : -half, i & 2 ? half : -half, 0);
    }
}

void bench_put_heap(sweep_bench *b, uint64_t seed, int bodies, int manifolds, int most)
{
    check_random random = {seed};
    bench_begin(b, bodies);
    for (int i = 0; i < bodies; ++i) {
        double m = check_uniform(&random, 0.5, 2);
        double moments[3];
        for (int k = 2; k >= 0; --k) {
            moments[k] = m * check_uniform(&random, 0.1, 0.3);
        }
        bench_set_body(b, i, m, moments[0], moments[1], moments[2]);
        for (int k = 0; k < 6; ++k) {
            b->free_velocity[i][k] = check_uniform(&random, -1, 1);
        }
    }
    for (int i = 0; i < manifolds; ++i) {
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
        bench_add_manifold(b, other, one, n, check_uniform(&random, 0, 1), arm_a, arm_b);
        int count = 1 + (int)check_uniform(&random, 0, most);
        for (int j = 0; j < count; ++j) {
            double s1 = check_uniform(&random, -0.3, 0.3), s2 = check_uniform(&random, -0.3, 0.3);
            double gap = check_uniform(&random, -0.5, 0.5);
            bench_add_point(b, check_uniform(&random, -0.01, 0.01), s1, s2, gap > 0 ? gap : 0);
        }
    }
}

pe_workspace bench_workspace(sweep_bench *b)
{
    pe_arena_reset(&b->arena, &b->allocator);
    return (pe_workspace){&b->arena, &b->allocator, NULL};
}

pe_solve_report bench_solve(sweep_bench *b, sweep_solver *by, double tolerance, int most)
{
    pe_solve_report report = {0};
    pe_solve_limits limits = {.tolerance = tolerance, .max_iterations = most};
    pe_problem_rebuild_velocity(&b->problem);
    assert_int_equal(by(&b->problem, &limits, bench_workspace(b), &report, NULL), PE_OK);
    return report;
}

void bench_forget_impulses(sweep_bench *b)
{
    memset(b->impulse, 0, sizeof b->impulse);
}
