/* The contact problem: velocities, residuals, scales; see problem.h for the formulas. */
#include "problem.h"

#include <math.h>
#include <string.h>

pe_status pe_problem_take(pe_problem *problem, pe_workspace work, pe_error *error)
{
    size_t n = (size_t)problem->body_count, points = (size_t)problem->point_count + 1;
    problem->inertia = pe_take(work, n + 1, sizeof *problem->inertia);
    problem->free_velocity = pe_take(work, n + 1, sizeof *problem->free_velocity);
    problem->velocity = pe_take(work, n + 1, sizeof *problem->velocity);
    problem->manifold =
        pe_take(work, (size_t)problem->manifold_count + 1, sizeof *problem->manifold);
    problem->point = pe_take(work, points, sizeof *problem->point);
    problem->impulse = pe_take(work, points, sizeof *problem->impulse);
    if (problem->inertia == NULL || problem->free_velocity == NULL || problem->velocity == NULL ||
        problem->manifold == NULL || problem->point == NULL || problem->impulse == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d contact points",
                       problem->point_count);
    }
    problem->pool = problem->point_count >= PE_LARGE_POINTS ? work.pool : NULL;
    problem->side_start = problem->side = NULL;
    problem->push = NULL;
    problem->inertia[n] = (pe_inertia){0};
    memset(problem->free_velocity[n], 0, sizeof *problem->free_velocity);
    return PE_OK;
}

/* ---- Velocities ---- */

pe_status pe_problem_list_sides(pe_problem *problem, pe_workspace work, pe_error *error)
{
    if (problem->pool == NULL) {
        return PE_OK;
    }
    const size_t bodies = (size_t)problem->body_count, manifolds = (size_t)problem->manifold_count;
    int *start = pe_take(work, bodies + 3, sizeof *start);
    int *side = pe_take(work, 2 * manifolds + 1, sizeof *side);
    problem->push = pe_take(work, manifolds + 1, sizeof *problem->push);
    if (start == NULL || side == NULL || problem->push == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d contact points",
                       problem->point_count);
    }
    /* A counting sort, the static body included; start[i + 2] counts, so that filling leaves
     * start[i] right. */
    memset(start, 0, (bodies + 3) * sizeof *start);
    for (size_t i = 0; i < manifolds; ++i) {
        start[problem->manifold[i].a + 2] += 1;
        start[problem->manifold[i].b + 2] += 1;
    }
    for (size_t i = 0; i < bodies; ++i) {
        start[i + 2] += start[i + 1];
    }
    start[bodies + 2] += start[bodies + 1];
    for (int i = 0; i < problem->manifold_count; ++i) {
        side[start[problem->manifold[i].a + 1]++] = 2 * i;
        side[start[problem->manifold[i].b + 1]++] = 2 * i + 1;
    }
    problem->side_start = start;
    problem->side = side;
    return PE_OK;
}

/* The wrench of a manifold's impulses, in its frame. */
static void find_wrench(const pe_problem *problem, const pe_solver_manifold *manifold,
                        double wrench[6])
{
    memset(wrench, 0, 6 * sizeof *wrench);
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        pe_wrench_add(&problem->point[j], problem->impulse[j], wrench);
    }
}

/* v = v* + M^-1 x for the momentum x of body i, in place. */
static void add_momentum(const pe_problem *problem, int i)
{
    double gained[6], *v = problem->velocity[i];
    pe_inverse_mass_times(&problem->inertia[i], v, gained);
    for (int k = 0; k < 6; ++k) {
        v[k] = problem->free_velocity[i][k] + gained[k];
    }
}

static void find_pushes(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_problem *problem = context;
    for (int i = begin; i < end; ++i) {
        double wrench[6];
        find_wrench(problem, &problem->manifold[i], wrench);
        pe_wrench_to_world(&problem->manifold[i], wrench, problem->push[i]);
    }
}

/* Sums the pushes on bodies in the order of the manifolds. */
static void sum_pushes(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_problem *problem = context;
    for (int i = begin; i < end; ++i) {
        double *v = problem->velocity[i];
        memset(v, 0, sizeof *problem->velocity);
        for (int k = problem->side_start[i]; k < problem->side_start[i + 1]; ++k) {
            const int m = problem->side[k] / 2;
            if (problem->side[k] % 2 == 0) {
                pe_push_a(problem->manifold[m].arm_a, problem->push[m], v);
            } else {
                pe_push_b(problem->manifold[m].arm_b, problem->push[m], v);
            }
        }
        add_momentum(problem, i);
    }
}

void pe_problem_rebuild_velocity(const pe_problem *problem)
{
    const int bodies = problem->body_count + 1;
    if (problem->side != NULL) {
        pe_pool_run(problem->pool, problem->manifold_count, PE_MANIFOLD_GRAIN, find_pushes,
                    (void *)problem);
        pe_pool_run(problem->pool, bodies, PE_PROBLEM_BODY_GRAIN, sum_pushes, (void *)problem);
        return;
    }
    memset(problem->velocity, 0, (size_t)bodies * sizeof *problem->velocity);
    for (int i = 0; i < problem->manifold_count; ++i) {
        double wrench[6];
        find_wrench(problem, &problem->manifold[i], wrench);
        pe_solver_manifold_push(&problem->manifold[i], wrench, problem->velocity);
    }
    for (int i = 0; i < bodies; ++i) {
        add_momentum(problem, i);
    }
}

/* ---- Residuals ---- */

double pe_cone_residual(double friction, double scale, const double p[3], const double u[3])
{
    double z[3] = {p[0] - u[0] / scale, p[1] - u[1] / scale, p[2] - u[2] / scale};
    if (friction == 0) {
        return scale * fabs(p[0] - (z[0] > 0 ? z[0] : 0));
    }
    /* The projection of z on the cone K. */
    double along = sqrt(z[1] * z[1] + z[2] * z[2]);
    if (friction * along <= -z[0]) {
        z[0] = z[1] = z[2] = 0;
    } else if (!(along <= friction * z[0])) { /* true for NaN as well */
        double n = (z[0] + friction * along) / (1 + friction * friction);
        z[1] *= friction * n / along;
        z[2] *= friction * n / along;
        z[0] = n;
    }
    double d[3] = {p[0] - z[0], p[1] - z[1], p[2] - z[2]};
    return scale * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

double pe_point_residual(double friction, double scale, const double p[3], const double u[3])
{
    if (p[0] == 0 && p[1] == 0 && p[2] == 0 && u[0] >= 0) {
        return 0; /* open: no impulse, no approach */
    }
    double lifted[3] = {u[0] + friction * sqrt(u[1] * u[1] + u[2] * u[2]), u[1], u[2]};
    return pe_cone_residual(friction, scale, p, lifted);
}

/* Sums of residuals by pieces of the manifolds: at most so many, of at least so many manifolds. */
typedef struct residual_sums {
    const pe_problem *problem;
    int grain;
    pe_residual of[PE_MOST_SUMS]; /* with the sum of squares in the place of rms */
} residual_sums;

static void sum_residuals(void *context, int worker, int begin, int end)
{
    (void)worker;
    residual_sums *sums = context;
    const pe_problem *problem = sums->problem;
    pe_residual residual = {0};
    for (int i = begin; i < end; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        double q[6], u[3];
        pe_solver_manifold_twist(manifold, (const double(*)[6])problem->velocity, q);
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            const pe_solver_point *point = &problem->point[j];
            pe_point_velocity(point, q, u);
            double e = pe_point_residual(manifold->friction, point->scale, problem->impulse[j], u);
            residual.rms += e * e;
            residual.max = e > residual.max || e != e ? e : residual.max;
        }
    }
    sums->of[begin / sums->grain] = residual;
}

pe_residual pe_problem_residual(const pe_problem *problem)
{
    const int count = problem->manifold_count;
    residual_sums sums = {.problem = problem, .grain = pe_sum_grain(count)};
    pe_pool_run(problem->pool, count, sums.grain, sum_residuals, &sums);
    pe_residual residual = {0};
    for (int i = 0; i < pe_piece_count(count, sums.grain); ++i) {
        const double e = sums.of[i].max;
        residual.rms += sums.of[i].rms;
        residual.max = e > residual.max || e != e ? e : residual.max;
    }
    if (problem->point_count > 0) {
        residual.rms = sqrt(residual.rms / problem->point_count);
    }
    return residual;
}

void pe_problem_point_velocities(const pe_problem *problem, const double (*velocity)[6],
                                 bool with_bias, double (*u)[3])
{
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        double q[6];
        pe_solver_manifold_twist(manifold, velocity, q);
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            pe_point_velocity(&problem->point[j], q, u[j]);
            if (!with_bias) {
                pe_point_take_bias(&problem->point[j], u[j]);
            }
        }
    }
}

/* Trace of -[r] A [r] for a symmetric A: |r|^2 tr A - r . A r. */
static double rotational_trace(const double a[6], const double r[3])
{
    double ar[3];
    pe_symmetric_times(a, r, ar);
    return pe_dot3(r, r) * (a[0] + a[3] + a[5]) - pe_dot3(r, ar);
}

double pe_point_scale(const pe_inertia *a, const pe_inertia *b, const double ra[3],
                      const double rb[3])
{
    return (3 * (a->inverse_mass + b->inverse_mass) + rotational_trace(a->inverse_tensor, ra) +
            rotational_trace(b->inverse_tensor, rb)) /
           3;
}

bool pe_problem_has_impulse(const pe_problem *problem)
{
    for (int j = 0; j < problem->point_count; ++j) {
        if (problem->impulse[j][0] > 0) {
            return true;
        }
    }
    return false;
}

void pe_problem_find_shifts(const pe_problem *problem, double *shift)
{
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        double q[6], u[3];
        pe_solver_manifold_twist(manifold, (const double(*)[6])problem->velocity, q);
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            pe_point_velocity(&problem->point[j], q, u);
            shift[j] = manifold->friction * sqrt(u[1] * u[1] + u[2] * u[2]);
        }
    }
}
