/* The contact problem of one island in one step, and the one residual by which every solver is
 * judged.
 *
 *   v = v* + M^-1 J^T p,   u = J v + b        per contact point: n, t1, t2; p in N s, u in m/s
 *   b_n = e u_n before an impact above the threshold, phi/h for a gap phi > 0, else 0
 *   b_t = (u_t of the step's start - u_t)/2, predicted, where a slip goes on, else 0
 *   and in both what the rest of the step turns of them: problem_middle.h
 *
 * Signorini-Coulomb in De Saxce's form: K* contains u + mu |u_t| n, K = { |p_t| <= mu p_n }
 * contains p, and the two are orthogonal. (De Saxce and Feng 1998; Acary and Brogliato 2008,
 * ch. 3.)
 *
 * The points of a manifold lie on the same two bodies, so that all they see of the velocities is
 * one relative twist q = (relative velocity at the manifold's centre, relative angular velocity),
 * six numbers in the manifold's frame (n, t1, t2): at a point s off the centre J v = q_v + q_w x s.
 * In the same way their impulses act on the bodies as one wrench (sum p, sum s x p). */
#ifndef PE_PROBLEM_H
#define PE_PROBLEM_H

#include "plumb/contact_problem.h" /* pe_residual */

/* Mass and world-frame inertia; symmetric matrices are (xx, xy, xz, yy, yz, zz). All zero: a static
 * body. */
typedef struct pe_inertia {
    double mass, inverse_mass;           /* kg, 1/kg */
    double tensor[6], inverse_tensor[6]; /* kg m^2, and its inverse */
} pe_inertia;

/* A manifold as the solvers see it. */
typedef struct pe_solver_manifold {
    int a, b;         /* bodies of the problem; the normal points from a to b */
    int first, count; /* points first .. first + count - 1 */
    double friction;
    double frame[3][3];        /* rows n, t1, t2: orthonormal, right-handed, world */
    double arm_a[3], arm_b[3]; /* from the centre of mass to the manifold's centre, world, m */
} pe_solver_manifold;

typedef struct pe_solver_point {
    double s[3];    /* from the manifold's centre, in the manifold's frame, m */
    double bias;    /* b_n, m/s */
    double slip[2]; /* b_t, m/s */
    double scale;   /* w = tr(J M^-1 J^T) / 3, 1/kg: makes an impulse of this point a velocity */
} pe_solver_point;

/* Borrowed arrays; one body more than body_count stands for everything static, with zero velocity.
 * `velocity` is in step with `impulse` before and after every solver. */
typedef struct pe_problem {
    int body_count, manifold_count, point_count;
    const pe_inertia *inertia;          /* (body_count + 1) */
    const double (*free_velocity)[6];   /* v*: (body_count + 1) x (linear, angular), world */
    double (*velocity)[6];              /* (body_count + 1) x (linear, angular) */
    const pe_solver_manifold *manifold; /* (manifold_count) */
    const pe_solver_point *point;       /* (point_count) */
    double (*impulse)[3];               /* (point_count) x (n, t1, t2) */
} pe_problem;

/* Makes the velocities those of the impulses: v = v* + M^-1 J^T p. */
void pe_problem_rebuild_velocity(const pe_problem *problem);

/* The natural map of the convex problem K* contains u, m/s: w | p - P_K(p - u/w) |. */
double pe_cone_residual(double friction, double scale, const double p[3], const double u[3]);

/* The natural map of one point, m/s: the above of u + mu |u_t| n. */
double pe_point_residual(double friction, double scale, const double p[3], const double u[3]);

/* From the velocities as they stand; NaN in, NaN out. */
pe_residual pe_problem_residual(const pe_problem *problem);

/* Scale of a point at arms ra, rb from the centres of mass; see pe_solver_point. */
double pe_point_scale(const pe_inertia *a, const pe_inertia *b, const double ra[3],
                      const double rb[3]);

/* ---- Twists and wrenches -----------------------------------------------------------------------
 */

static inline void pe_cross3(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double pe_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The manifold's relative twist q: its linear part at the centre, then its angular part. */
static inline void pe_solver_manifold_twist(const pe_solver_manifold *manifold,
                                            const double (*velocity)[6], double q[6])
{
    const double *va = velocity[manifold->a], *vb = velocity[manifold->b];
    double wa[3], wb[3], d[3], w[3];
    pe_cross3(va + 3, manifold->arm_a, wa);
    pe_cross3(vb + 3, manifold->arm_b, wb);
    for (int k = 0; k < 3; ++k) {
        d[k] = (vb[k] + wb[k]) - (va[k] + wa[k]);
        w[k] = vb[3 + k] - va[3 + k];
    }
    for (int k = 0; k < 3; ++k) {
        q[k] = pe_dot3(manifold->frame[k], d);
        q[3 + k] = pe_dot3(manifold->frame[k], w);
    }
}

/* J v of a point of the manifold. */
static inline void pe_point_motion(const pe_solver_point *point, const double q[6], double u[3])
{
    pe_cross3(q + 3, point->s, u);
    u[0] = u[0] + q[0];
    u[1] = u[1] + q[1];
    u[2] = u[2] + q[2];
}

/* J v + b of a point of the manifold. */
static inline void pe_point_velocity(const pe_solver_point *point, const double q[6], double u[3])
{
    pe_point_motion(point, q, u);
    u[0] = u[0] + point->bias;
    u[1] = u[1] + point->slip[0];
    u[2] = u[2] + point->slip[1];
}

/* Takes b from u again. */
static inline void pe_point_take_bias(const pe_solver_point *point, double u[3])
{
    u[0] -= point->bias;
    u[1] -= point->slip[0];
    u[2] -= point->slip[1];
}

/* Adds the impulse of one point to the manifold's wrench. */
static inline void pe_wrench_add(const pe_solver_point *point, const double p[3], double wrench[6])
{
    double moment[3];
    pe_cross3(point->s, p, moment);
    for (int k = 0; k < 3; ++k) {
        wrench[k] += p[k];
        wrench[3 + k] += moment[k];
    }
}

/* Adds the manifold's wrench, on b, to the bodies' momenta: J^T p. */
static inline void pe_solver_manifold_push(const pe_solver_manifold *manifold,
                                           const double wrench[6], double (*momentum)[6])
{
    const double(*d)[3] = manifold->frame;
    double *a = momentum[manifold->a], *b = momentum[manifold->b];
    double f[3], t[3], ta[3], tb[3];
    for (int k = 0; k < 3; ++k) {
        f[k] = d[0][k] * wrench[0] + d[1][k] * wrench[1] + d[2][k] * wrench[2];
        t[k] = d[0][k] * wrench[3] + d[1][k] * wrench[4] + d[2][k] * wrench[5];
    }
    pe_cross3(manifold->arm_a, f, ta);
    pe_cross3(manifold->arm_b, f, tb);
    for (int k = 0; k < 3; ++k) {
        a[k] -= f[k];
        b[k] += f[k];
        a[3 + k] -= ta[k] + t[k];
        b[3 + k] += tb[k] + t[k];
    }
}

static inline void pe_symmetric_times(const double m[6], const double x[3], double y[3])
{
    y[0] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
    y[1] = m[1] * x[0] + m[3] * x[1] + m[4] * x[2];
    y[2] = m[2] * x[0] + m[4] * x[1] + m[5] * x[2];
}

/* y = M x and y = M^-1 x of one body. */
static inline void pe_mass_times(const pe_inertia *m, const double x[6], double y[6])
{
    for (int k = 0; k < 3; ++k) {
        y[k] = m->mass * x[k];
    }
    pe_symmetric_times(m->tensor, x + 3, y + 3);
}

static inline void pe_inverse_mass_times(const pe_inertia *m, const double x[6], double y[6])
{
    for (int k = 0; k < 3; ++k) {
        y[k] = m->inverse_mass * x[k];
    }
    pe_symmetric_times(m->inverse_tensor, x + 3, y + 3);
}

#endif
