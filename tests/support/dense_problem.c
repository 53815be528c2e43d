#include "dense_problem.h"

#include "check.h"
#include "contact_problem_for_tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(void *context, size_t size)
{
    test_memory *memory = context;
    memory->made += 1;
    if (memory->made == memory->fail_at) {
        return NULL;
    }
    size = (size + 63) / 64 * 64;
    void *block = aligned_alloc(64, size);
    assert_non_null(block);
    memset(block, 0xff, size);
    return block;
}

static void release(void *context, void *block)
{
    (void)context;
    free(block);
}

pe_workspace test_memory_begin(test_memory *memory)
{
    *memory = (test_memory){.allocator = {allocate, release, memory}};
    return (pe_workspace){&memory->arena, &memory->allocator, NULL};
}

void test_memory_end(test_memory *memory)
{
    pe_arena_free(&memory->arena, &memory->allocator);
}

/* The inverse of a symmetric matrix by its adjugate. */
static void invert(const double m[6], double inverse[6])
{
    double xx = m[3] * m[5] - m[4] * m[4], xy = m[2] * m[4] - m[1] * m[5],
           xz = m[1] * m[4] - m[2] * m[3];
    double det = m[0] * xx + m[1] * xy + m[2] * xz;
    const double adjugate[6] = {xx,
                                xy,
                                xz,
                                m[0] * m[5] - m[2] * m[2],
                                m[1] * m[2] - m[0] * m[4],
                                m[0] * m[3] - m[1] * m[1]};
    for (int k = 0; k < 6; ++k) {
        inverse[k] = adjugate[k] / det;
    }
}

/* From a body's centre of mass to a point. */
static void arm_to(const pe_problem_manifold *m, const double arm[3],
                   const pe_problem_manifold_point *point, double r[3])
{
    for (int k = 0; k < 3; ++k) {
        r[k] = arm[k];
        for (int i = 0; i < 3; ++i) {
            r[k] += m->frame[i][k] * point->offset[i];
        }
    }
}

pe_problem solver_problem(const pe_contact_problem *from, pe_workspace work)
{
    pe_problem problem;
    assert_int_equal(pe_problem_of_data(from, work, &problem, NULL), PE_OK);
    return problem;
}

double solver_problem_fault(const pe_contact_problem *from, const pe_problem *problem)
{
    double(*v)[6] = calloc((size_t)from->body_count + 1, sizeof *v);
    assert_non_null(v);
    const double(*p)[3] = (const double(*)[3])problem->impulse;
    reference_velocities(from, p, v);
    double fault = coulomb_fault(from, p, (const double(*)[6])v);
    free(v);
    return fault;
}

/* ---- Matrices ---- */

static double *zeros(int rows, int columns)
{
    double *m = calloc((size_t)rows * (size_t)columns + 1, sizeof *m);
    assert_non_null(m);
    return m;
}

/* The part of a body's velocity in that of a point along `direction`: d, and r x d. */
static void fill_row(double *row, const double direction[3], const double r[3], double sign)
{
    for (int k = 0; k < 3; ++k) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        row[k] = sign * direction[k];
        row[3 + k] = sign * (r[i] * direction[j] - r[j] * direction[i]);
    }
}

double *dense_jacobian(const pe_contact_problem *problem)
{
    int columns = 6 * problem->body_count;
    double *jacobian = zeros(3 * problem->point_count, columns);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_problem_manifold *m = &problem->manifolds[i];
        for (int j = 3 * m->first; j < 3 * (m->first + m->count); ++j) {
            double *row = jacobian + (size_t)j * (size_t)columns, r[3];
            if (m->a != PE_STATIC) {
                arm_to(m, m->arm_a, &problem->points[j / 3], r);
                fill_row(row + 6 * m->a, m->frame[j % 3], r, -1);
            }
            if (m->b != PE_STATIC) {
                arm_to(m, m->arm_b, &problem->points[j / 3], r);
                fill_row(row + 6 * m->b, m->frame[j % 3], r, 1);
            }
        }
    }
    return jacobian;
}

/* A block diagonal matrix: `inverted` or not. */
static double *mass_matrix(const pe_contact_problem *problem, bool inverted)
{
    static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    int n = 6 * problem->body_count;
    double *matrix = zeros(n, n);
    for (int b = 0; b < problem->body_count; ++b) {
        const pe_problem_body *body = &problem->bodies[b];
        double inverse[6];
        invert(body->inertia, inverse);
        for (int i = 0; i < 3; ++i) {
            double *linear = matrix + (6 * b + i) * n + 6 * b;
            double *angular = matrix + (6 * b + 3 + i) * n + 6 * b + 3;
            linear[i] = inverted ? 1 / body->mass : body->mass;
            for (int j = 0; j < 3; ++j) {
                angular[j] = inverted ? inverse[at[i][j]] : body->inertia[at[i][j]];
            }
        }
    }
    return matrix;
}

double *dense_mass(const pe_contact_problem *problem)
{
    return mass_matrix(problem, false);
}

double *dense_inverse_mass(const pe_contact_problem *problem)
{
    return mass_matrix(problem, true);
}

/* Row by row, so that a zero that no elimination reaches stays an exact one. */
void dense_cholesky(double *a, int n)
{
    for (int i = 0; i < n; ++i) {
        double *row = a + (size_t)i * (size_t)n;
        for (int j = 0; j <= i; ++j) {
            const double *other = a + (size_t)j * (size_t)n;
            double sum = row[j];
            for (int k = 0; k < j; ++k) {
                sum -= row[k] * other[k];
            }
            row[j] = j < i ? sum / other[j] : sqrt(sum);
        }
        assert_true(row[i] > 0);
    }
}

void dense_solve(const double *l, int n, double *x)
{
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < i; ++k) {
            x[i] -= l[i * n + k] * x[k];
        }
        x[i] /= l[i * n + i];
    }
    for (int i = n - 1; i >= 0; --i) {
        x[i] /= l[i * n + i];
        for (int k = 0; k < i; ++k) {
            x[k] -= l[i * n + k] * x[i];
        }
    }
}
