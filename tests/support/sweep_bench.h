/* Problems for the Gauss-Seidel solvers, made by hand. Every failure fails the test. */
#ifndef PLUMB_TEST_SWEEP_BENCH_H
#define PLUMB_TEST_SWEEP_BENCH_H

#include "solver/solve.h"

enum { BENCH_BODIES = 300, BENCH_MANIFOLDS = 1200, BENCH_POINTS = 6000 };

typedef struct sweep_bench {
    pe_problem problem;
    pe_inertia inertia[BENCH_BODIES + 1];
    double free_velocity[BENCH_BODIES + 1][6], velocity[BENCH_BODIES + 1][6];
    pe_solver_manifold manifold[BENCH_MANIFOLDS];
    pe_solver_point point[BENCH_POINTS];
    double impulse[BENCH_POINTS][3];
    pe_allocator allocator;
    pe_arena arena;
} sweep_bench;

/* For cmocka: *state is a bench. */
int bench_set_up(void **state);
int bench_tear_down(void **state);

/* A problem without manifolds, whose bodies are still to be set. */
void bench_begin(sweep_bench *b, int bodies);

/* Principal inertia along the world's axes. */
void bench_set_body(sweep_bench *b, int i, double mass, double x, double y, double z);

/* A manifold at arms from the two centres of mass; points follow. */
void bench_add_manifold(sweep_bench *b, int body_a, int body_b, const double n[3], double friction,
                        const double arm_a[3], const double arm_b[3]);

/* A point of the manifold added last, at s in its frame. */
void bench_add_point(sweep_bench *b, double s0, double s1, double s2, double bias);

/* The corners of a square face of the given half side. */
void bench_add_corners(sweep_bench *b, double half);

/* Falling bodies of various inertia in a random net of manifolds of 1 to `most` points. */
void bench_put_heap(sweep_bench *b, uint64_t seed, int bodies, int manifolds, int most);

/* The workspace, emptied. */
pe_workspace bench_workspace(sweep_bench *b);

typedef pe_status sweep_solver(const pe_problem *problem, const pe_solve_limits *limits,
                               pe_workspace work, pe_solve_report *report, pe_error *error);

/* Solves from the present impulses. */
pe_solve_report bench_solve(sweep_bench *b, sweep_solver *by, double tolerance, int most);

void bench_forget_impulses(sweep_bench *b);

#endif
