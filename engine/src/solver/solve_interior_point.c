/* The interior point method in the form of Vandenberghe, "The CVXOPT linear and quadratic cone
 * program solvers" (2010): self-dual cones, Nesterov and Todd's scaling, Mehrotra's predictor and
 * corrector. */
#include "solve_interior_point.h"

#include "base/vec3.h"
#include "sparse/factor.h"

#include <math.h>
#include <string.h>

typedef double vec3[3];
typedef double vec6[6];

/* One point in self-dual form: x = (mu p_n, p_t) and z = (u_n/mu, u_t) in the Lorentz cone, with
 * x.z = p.u. Without friction mu is set to 1 and the tangential parts to 0. */
typedef struct cone_point {
    vec3 x, z;
    double mu;
    bool rough;
    vec3 gap;  /* z(v) - z */
    vec3 v, w; /* W = beta (2 v v^T - J), W^-2 = (2 (Jw)(Jw)^T - J) / beta^2 */
    double beta;
    vec3 lambda; /* W x = W^-1 z */
    vec3 dx, dz, predicted_x, predicted_z;
} cone_point;

/* J = diag(1, -1, -1) */
static inline double j_product(const double a[3], const double b[3])
{
    return a[0] * b[0] - (a[1] * b[1] + a[2] * b[2]);
}

static inline double j_norm(const double a[3])
{
    double square = j_product(a, a);
    return square > 1e-300 ? sqrt(square) : 1e-150;
}

/* y = W a */
static inline void scale(const cone_point *c, const double a[3], double y[3])
{
    double twice = 2 * pe_dot3(c->v, a);
    y[0] = c->beta * (twice * c->v[0] - a[0]);
    y[1] = c->beta * (twice * c->v[1] + a[1]);
    y[2] = c->beta * (twice * c->v[2] + a[2]);
}

/* y = W^-1 a */
static inline void unscale(const cone_point *c, const double a[3], double y[3])
{
    double twice = 2 * j_product(c->v, a);
    y[0] = (twice * c->v[0] - a[0]) / c->beta;
    y[1] = (a[1] - twice * c->v[1]) / c->beta;
    y[2] = (a[2] - twice * c->v[2]) / c->beta;
}

/* y = W^-2 a */
static inline void unscale_twice(const cone_point *c, const double a[3], double y[3])
{
    double twice = 2 * j_product(c->w, a), square = c->beta * c->beta;
    y[0] = (twice * c->w[0] - a[0]) / square;
    y[1] = (a[1] - twice * c->w[1]) / square;
    y[2] = (a[2] - twice * c->w[2]) / square;
}

static void find_scaling(cone_point *c)
{
    double nx = j_norm(c->x), nz = j_norm(c->z), x[3], z[3];
    for (int k = 0; k < 3; ++k) {
        x[k] = c->x[k] / nx;
        z[k] = c->z[k] / nz;
    }
    double twice = 2 * sqrt(pe_max(0, 0.5 * (1 + pe_dot3(x, z))));
    c->w[1] = (z[1] - x[1]) / twice;
    c->w[2] = (z[2] - x[2]) / twice;
    c->w[0] = sqrt(1 + c->w[1] * c->w[1] + c->w[2] * c->w[2]);
    c->beta = sqrt(nz / nx);
    double norm = 1 / sqrt(2 * (c->w[0] + 1));
    c->v[0] = (c->w[0] + 1) * norm;
    c->v[1] = c->w[1] * norm;
    c->v[2] = c->w[2] * norm;
    scale(c, c->x, c->lambda);
}

/* W^-2 in terms of u and p. */
static void gain_of(const cone_point *c, pe_gain g)
{
    double jw[3] = {c->w[0], -c->w[1], -c->w[2]}, inverse = 1 / (c->beta * c->beta);
    g[0] = inverse * (2 * jw[0] * jw[0] - 1) / (c->mu * c->mu);
    g[1] = inverse * 2 * jw[0] * jw[1] / c->mu;
    g[2] = inverse * 2 * jw[0] * jw[2] / c->mu;
    g[3] = inverse * (2 * jw[1] * jw[1] + 1);
    g[4] = inverse * 2 * jw[1] * jw[2];
    g[5] = inverse * (2 * jw[2] * jw[2] + 1);
    if (!c->rough) {
        g[1] = g[2] = g[3] = g[4] = g[5] = 0;
    }
}

/* y solves lambda o y = r, the product of the cone's algebra: (a.b, a_0 b_t + b_0 a_t). */
static void divide(const double lambda[3], const double r[3], double y[3])
{
    double det = pe_max(j_product(lambda, lambda), 1e-300);
    y[0] = (lambda[0] * r[0] - (lambda[1] * r[1] + lambda[2] * r[2])) / det;
    y[1] = (r[1] - lambda[1] * y[0]) / lambda[0];
    y[2] = (r[2] - lambda[2] * y[0]) / lambda[0];
}

static void multiply(const double a[3], const double b[3], double y[3])
{
    y[0] = pe_dot3(a, b);
    y[1] = a[0] * b[1] + b[0] * a[1];
    y[2] = a[0] * b[2] + b[0] * a[2];
}

/* Largest a <= 1 with x + a dx in the cone: the first root of the quadratic (x + a dx)^T J (x + a
 * dx). */
static double step_to_boundary(const double x[3], const double dx[3])
{
    double a = j_product(dx, dx), b = j_product(x, dx), c = pe_max(0, j_product(x, x)), best = 1;
    double discriminant = b * b - a * c;
    if (discriminant >= 0) {
        double t = -(b + (b > 0 ? sqrt(discriminant) : -sqrt(discriminant)));
        double roots[2] = {a != 0 ? t / a : -1, t != 0 ? c / t : -1};
        for (int k = 0; k < 2; ++k) {
            best = roots[k] > 0 && roots[k] < best ? roots[k] : best;
        }
    }
    if (x[0] + best * dx[0] < 0) {
        best = pe_min(best, -x[0] / dx[0]);
    }
    return best;
}

typedef struct interior {
    const pe_problem *problem;
    const double *shift;
    pe_factor factor;
    cone_point *cone; /* (points) */
    pe_gain *gain;
    vec3 *u;      /* (points): velocities, scratch */
    vec3 *best;   /* impulses */
    vec6 *v, *dv; /* (bodies + 1): the iterate's own velocities, and their step */
} interior;

/* The velocity of a point in the variables of the cone. */
static inline void cone_velocity(const cone_point *c, const double u[3], double z[3])
{
    z[0] = u[0] / c->mu;
    z[1] = c->rough ? u[1] : 0;
    z[2] = c->rough ? u[2] : 0;
}

/* A central start: every contact has the impulse that would stop the fastest of them. */
static void start(interior *ip, double least_speed)
{
    const pe_problem *problem = ip->problem;
    memcpy(ip->v, problem->free_velocity, ((size_t)problem->body_count + 1) * sizeof *ip->v);
    pe_problem_point_velocities(problem, (const vec6 *)ip->v, true, ip->u);
    double speed = least_speed;
    for (int j = 0; j < problem->point_count; ++j) {
        const double *u = ip->u[j];
        speed = pe_max(speed, pe_max(fabs(u[0]), pe_max(fabs(u[1]), fabs(u[2]))));
    }
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        bool rough = manifold->friction != 0; /* true for NaN */
        double mu = rough ? manifold->friction : 1;
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            ip->cone[j] = (cone_point){
                .x = {mu * speed / problem->point[j].scale},
                .z = {speed / mu},
                .mu = mu,
                .rough = rough,
            };
        }
    }
}

/* Sets the impulses of the iterate, returns their residual in the convex problem, and keeps the
 * best. */
static double look(interior *ip, double *least)
{
    const pe_problem *problem = ip->problem;
    for (int j = 0; j < problem->point_count; ++j) {
        const cone_point *c = &ip->cone[j];
        problem->impulse[j][0] = c->x[0] / c->mu;
        problem->impulse[j][1] = c->x[1];
        problem->impulse[j][2] = c->x[2];
    }
    pe_problem_rebuild_velocity(problem);
    pe_problem_point_velocities(problem, (const vec6 *)problem->velocity, true, ip->u);
    double worst = 0;
    for (int j = 0; j < problem->point_count; ++j) {
        const cone_point *c = &ip->cone[j];
        ip->u[j][0] += ip->shift[j];
        double e = pe_cone_residual(c->rough ? c->mu : 0, problem->point[j].scale,
                                    problem->impulse[j], ip->u[j]);
        worst = e > worst || e != e ? e : worst;
    }
    if (worst < *least) {
        *least = worst;
        memcpy(ip->best, problem->impulse, (size_t)problem->point_count * sizeof *ip->best);
    }
    return worst;
}

/* Scalings, gains and gaps at the iterate; returns the mean of x.z. */
static double linearise(interior *ip)
{
    const pe_problem *problem = ip->problem;
    double sum = 0;
    pe_problem_point_velocities(problem, (const vec6 *)ip->v, true, ip->u);
    for (int j = 0; j < problem->point_count; ++j) {
        cone_point *c = &ip->cone[j];
        double z[3];
        ip->u[j][0] += ip->shift[j];
        cone_velocity(c, ip->u[j], z);
        for (int k = 0; k < 3; ++k) {
            c->gap[k] = z[k] - c->z[k];
        }
        sum += pe_dot3(c->x, c->z);
        find_scaling(c);
        gain_of(c, ip->gain[j]);
    }
    return sum / problem->point_count;
}

/* The right-hand side of one point: dx = W^-1 (lambda \ r) - W^-2 dz, here without the step's part
 * of dz. The predictor aims at 0. The corrector aims at `target` and subtracts the second-order
 * term of the predictor. */
static void point_right_side(cone_point *c, bool corrects, double target)
{
    double r[3], y[3], dx[3], gap[3];
    multiply(c->lambda, c->lambda, r);
    for (int k = 0; k < 3; ++k) {
        r[k] = -r[k];
    }
    if (corrects) {
        double sx[3], sz[3], cross[3];
        scale(c, c->predicted_x, sx);
        unscale(c, c->predicted_z, sz);
        multiply(sx, sz, cross);
        r[0] += target;
        for (int k = 0; k < 3; ++k) {
            r[k] -= cross[k];
        }
    }
    divide(c->lambda, r, y);
    unscale(c, y, dx);
    unscale_twice(c, c->gap, gap);
    for (int k = 0; k < 3; ++k) {
        c->dx[k] = dx[k] - gap[k];
    }
}

/* Solves for the step; returns the longest length at which the iterate stays in the cones. */
static double direction(interior *ip, bool corrects, double target)
{
    const pe_problem *problem = ip->problem;
    memset(ip->dv, 0, ((size_t)problem->body_count + 1) * sizeof *ip->dv);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        double wrench[6] = {0};
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            cone_point *c = &ip->cone[j];
            point_right_side(c, corrects, target);
            double p[3] = {(c->x[0] + c->dx[0]) / c->mu, c->x[1] + c->dx[1], c->x[2] + c->dx[2]};
            pe_wrench_add(&problem->point[j], p, wrench);
        }
        pe_solver_manifold_push(manifold, wrench, ip->dv);
    }
    for (int i = 0; i < problem->body_count; ++i) {
        double kept[6];
        pe_problem_momentum(problem, (const vec6 *)ip->v, i, kept);
        for (int k = 0; k < 6; ++k) {
            ip->dv[i][k] -= kept[k];
        }
    }
    pe_factor_solve(&ip->factor, (const vec6 *)ip->dv, ip->dv);
    memset(ip->dv[problem->body_count], 0, sizeof *ip->dv);
    pe_problem_point_velocities(problem, (const vec6 *)ip->dv, false, ip->u);
    double longest = 1;
    for (int j = 0; j < problem->point_count; ++j) {
        cone_point *c = &ip->cone[j];
        double dz[3], back[3];
        cone_velocity(c, ip->u[j], dz);
        unscale_twice(c, dz, back);
        for (int k = 0; k < 3; ++k) {
            c->dz[k] = dz[k] + c->gap[k];
            c->dx[k] -= back[k];
        }
        longest =
            pe_min(longest, pe_min(step_to_boundary(c->x, c->dx), step_to_boundary(c->z, c->dz)));
    }
    return longest;
}

/* Mehrotra's centring: the cube of the part of the mean that the predictor would leave. */
static double centring(interior *ip, double mean, double longest)
{
    double sum = 0;
    for (int j = 0; j < ip->problem->point_count; ++j) {
        cone_point *c = &ip->cone[j];
        for (int k = 0; k < 3; ++k) {
            sum += (c->x[k] + longest * c->dx[k]) * (c->z[k] + longest * c->dz[k]);
            c->predicted_x[k] = c->dx[k];
            c->predicted_z[k] = c->dz[k];
        }
    }
    double left = pe_max(0, pe_min(1, sum / ip->problem->point_count / mean));
    return left * left * left;
}

static void move(interior *ip, double length)
{
    for (int j = 0; j < ip->problem->point_count; ++j) {
        cone_point *c = &ip->cone[j];
        for (int k = 0; k < 3; ++k) {
            c->x[k] += length * c->dx[k];
            c->z[k] += length * c->dz[k];
        }
    }
    for (int i = 0; i < ip->problem->body_count; ++i) {
        for (int k = 0; k < 6; ++k) {
            ip->v[i][k] += length * ip->dv[i][k];
        }
    }
}

static const double BACK_OFF = 0.99;    /* part of the longest step that is taken */
static const double LEAST_SPEED = 1e-3; /* m/s, of the starting point */
enum {
    MAX_WORSE = 10, /* iterations without a new best */
    MAX_WORSE_ROUNDS =
        4 /* the same of rounds, before the fixed point of the shift counts as lost */
};

/* The method, on a problem whose manifolds all take part. */
static pe_status solve_convex(const pe_problem *problem, const double *shift,
                              const pe_solve_limits *limits, pe_workspace work,
                              pe_solve_report *report, pe_error *error)
{
    size_t points = (size_t)problem->point_count + 1, bodies = (size_t)problem->body_count + 1;
    interior ip = {
        .problem = problem,
        .shift = shift,
        .cone = pe_take(work, points, sizeof *ip.cone),
        .gain = pe_take(work, points, sizeof *ip.gain),
        .u = pe_take(work, points, sizeof *ip.u),
        .best = pe_take(work, points, sizeof *ip.best),
        .v = pe_take(work, bodies, sizeof *ip.v),
        .dv = pe_take(work, bodies, sizeof *ip.dv),
    };
    if (ip.cone == NULL || ip.gain == NULL || ip.u == NULL || ip.best == NULL || ip.v == NULL ||
        ip.dv == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %d contact points",
                       problem->point_count);
    }
    pe_pattern pattern;
    pe_status status = pe_pattern_find(problem, NULL, work, &pattern, error);
    if (status == PE_OK) {
        status = pe_factor_create(&pattern, work, &ip.factor, error);
    }
    if (status != PE_OK) {
        return status;
    }
    memcpy(ip.best, problem->impulse, (size_t)problem->point_count * sizeof *ip.best);
    start(&ip, LEAST_SPEED);
    double least = HUGE_VAL;
    report->stop = PE_STOP_STALLED;
    for (int worse = 0; worse <= MAX_WORSE;) {
        double before = least, now = look(&ip, &least);
        pe_solve_note(report, report->iterations, now);
        worse = least < before ? 0 : worse + 1;
        if (now <= limits->tolerance || report->iterations >= limits->max_iterations ||
            !pe_solve_may_factor(report, pattern.flops)) {
            report->stop = now <= limits->tolerance ? PE_STOP_CONVERGED : PE_STOP_ITERATIONS;
            break;
        }
        double mean = linearise(&ip);
        pe_factor_assemble(&ip.factor, problem, (const pe_gain *)ip.gain);
        if (!pe_factor_compute(&ip.factor)) {
            break;
        }
        report->iterations += 1;
        report->factor_flops += pattern.flops;
        double longest = direction(&ip, false, 0);
        double target = mean * centring(&ip, mean, longest);
        longest = direction(&ip, true, target);
        move(&ip, pe_min(1, BACK_OFF * longest));
    }
    memcpy(problem->impulse, ip.best, (size_t)problem->point_count * sizeof *ip.best);
    return PE_OK;
}

/* The manifolds of a problem with loaded[i] (NULL: all), their points packed, impulses copied.
 * Bodies and velocities are shared with `problem`. point_of (part->point_count) is each point's
 * index in `problem`. */
static pe_status select_loaded(const pe_problem *problem, const bool *loaded, pe_workspace work,
                               pe_problem *part, int **point_of, pe_error *error)
{
    size_t manifolds = (size_t)problem->manifold_count, points = (size_t)problem->point_count;
    pe_solver_manifold *manifold = pe_take(work, manifolds + 1, sizeof *manifold);
    pe_solver_point *point = pe_take(work, points + 1, sizeof *point);
    vec3 *impulse = pe_take(work, points + 1, sizeof *impulse);
    int *origin = pe_take(work, points + 1, sizeof *origin);
    if (manifold == NULL || point == NULL || impulse == NULL || origin == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points", points);
    }
    *part = *problem;
    part->manifold_count = part->point_count = 0;
    part->side = part->side_start = NULL; /* they list other manifolds */
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *from = &problem->manifold[i];
        if (loaded != NULL && !loaded[i]) {
            continue;
        }
        manifold[part->manifold_count] = *from;
        manifold[part->manifold_count++].first = part->point_count;
        for (int j = from->first; j < from->first + from->count; ++j) {
            point[part->point_count] = problem->point[j];
            memcpy(impulse[part->point_count], problem->impulse[j], sizeof *impulse);
            origin[part->point_count++] = j;
        }
    }
    part->manifold = manifold;
    part->point = point;
    part->impulse = impulse;
    *point_of = origin;
    return PE_OK;
}

pe_status pe_interior_point(const pe_problem *problem, const pe_convex_form *form,
                            const pe_solve_limits *limits, pe_workspace work,
                            pe_solve_report *report, pe_error *error)
{
    pe_problem part;
    int *point_of = NULL;
    double *shift = pe_take(work, (size_t)problem->point_count + 1, sizeof *shift);
    if (shift == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %d contact points",
                       problem->point_count);
    }
    pe_status status = select_loaded(problem, form->loaded, work, &part, &point_of, error);
    if (status != PE_OK) {
        return status;
    }
    for (int j = 0; j < part.point_count; ++j) {
        shift[j] = form->shift[point_of[j]];
    }
    status = solve_convex(&part, shift, limits, work, report, error);
    if (status != PE_OK) {
        return status;
    }
    memset(problem->impulse, 0, (size_t)problem->point_count * sizeof *problem->impulse);
    for (int j = 0; j < part.point_count; ++j) {
        memcpy(problem->impulse[point_of[j]], part.impulse[j], sizeof *part.impulse);
    }
    pe_problem_rebuild_velocity(problem);
    report->residual = pe_problem_residual(problem);
    return PE_OK;
}

pe_status pe_solve_interior_point(const pe_problem *problem, const pe_solve_limits *limits,
                                  pe_workspace work, pe_solve_report *report, pe_error *error)
{
    size_t points = (size_t)problem->point_count;
    double *shift = pe_take(work, points + 1, sizeof *shift);
    vec3 *best = pe_take(work, points + 1, sizeof *best);
    if (shift == NULL || best == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %zu contact points", points);
    }
    pe_residual least = pe_problem_residual(problem);
    memcpy(best, problem->impulse, points * sizeof *best);
    memset(shift, 0, points * sizeof *shift);
    for (int worse = 0; worse < MAX_WORSE_ROUNDS && least.max > limits->tolerance &&
                        report->iterations < limits->max_iterations;) {
        pe_status status =
            pe_interior_point(problem, &(pe_convex_form){NULL, shift}, limits, work, report, error);
        if (status != PE_OK) {
            return status;
        }
        pe_problem_find_shifts(problem, shift);
        ++worse;
        if (report->residual.max < least.max) {
            worse = 0;
            least = report->residual;
            memcpy(best, problem->impulse, points * sizeof *best);
        }
    }
    memcpy(problem->impulse, best, points * sizeof *best);
    pe_problem_rebuild_velocity(problem);
    report->residual = least;
    report->stop = least.max <= limits->tolerance                 ? PE_STOP_CONVERGED
                   : report->iterations >= limits->max_iterations ? PE_STOP_ITERATIONS
                                                                  : PE_STOP_STALLED;
    return PE_OK;
}
