/* The contact problem of one island in one step, and the residual by which every solver is judged.
 *
 *   v = v* + M^-1 J^T p,   u = J v + b        per contact point: n, t1, t2; p in N s, u in m/s
 *   b_n = e u_n before an impact faster than the threshold, phi/h for a gap phi > 0, else 0
 *   b_t = (u_t of the step's start - u_t)/2, predicted, where sliding goes on, else 0
 *   and in both the change by the rotation in the rest of the step: midpoint.h
 *
 * Signorini and Coulomb in De Saxce's form: K* contains u + mu |u_t| n, K = { |p_t| <= mu p_n }
 * contains p, and the two are orthogonal. (De Saxce and Feng 1998; Acary and Brogliato 2008,
 * ch. 3.)
 *
 * The points of a manifold lie on the same two bodies, so that they see the velocities only through
 * one relative twist q = (relative velocity at the manifold's centre, relative angular velocity),
 * six numbers in the manifold's frame (n, t1, t2): at a point s from the centre J v = q_v + q_w x
 * s. In the same way their impulses act on the bodies as one wrench (sum p, sum s x p).
 *
 * Names: vA, wA, rA the velocity, angular velocity and arm of body A; vB and so on of body B. */
#ifndef PE_PROBLEM_H
#define PE_PROBLEM_H

#include "base/pool.h"
#include "plumb/contact_problem.h"

/* Mass and world-frame inertia of a body, all zero for a static one. Symmetric matrices are (xx,
 * xy, xz, yy, yz, zz). */
typedef struct pe_inertia {
    double mass, inverse_mass;           /* kg, 1/kg */
    double tensor[6], inverse_tensor[6]; /* kg m^2, and its inverse */
} pe_inertia;

/* A manifold as the solvers see it. A static body is number body_count. */
typedef pe_problem_manifold pe_solver_manifold;

/* A manifold point as the solvers see it. */
typedef struct pe_solver_point {
    double s[3];    /* from the manifold's centre, in its frame, m */
    double bias;    /* b_n, m/s */
    double slip[2]; /* b_t, m/s */
    double scale;   /* w = tr(J M^-1 J^T) / 3, 1/kg: takes an impulse of this point to a velocity */
} pe_solver_point;

/* Borrowed arrays, of which solvers change `velocity` and `impulse` only. Body number body_count
 * stands for everything static and has velocity zero. The velocities are in step with the impulses
 * before and after every solver. */
typedef struct pe_problem {
    int body_count, manifold_count, point_count;
    pe_inertia *inertia;          /* (body_count + 1) */
    double (*free_velocity)[6];   /* v*: (body_count + 1) x (linear, angular), world */
    double (*velocity)[6];        /* (body_count + 1) x (linear, angular) */
    pe_solver_manifold *manifold; /* (manifold_count) */
    pe_solver_point *point;       /* (point_count) */
    double (*impulse)[3];         /* (point_count) x (n, t1, t2) */

    /* Of a large problem that was built in a workspace with threads; else NULL. */
    pe_pool *pool;     /* threads that share the loops over the problem */
    int *side_start;   /* (body_count + 1): where the sides of a body begin */
    int *side;         /* 2 x manifold + (0: the body is a, 1: it is b), ascending for each body */
    double (*push)[6]; /* (manifold_count): scratch */
} pe_problem;

/* Points from which a problem is large, and the manifolds and bodies of a piece of its loops. */
enum { PE_LARGE_POINTS = 2048, PE_MANIFOLD_GRAIN = 128, PE_PROBLEM_BODY_GRAIN = 256 };

/* Takes the arrays of a problem whose counts are set from the workspace, and its threads. The numbers
 * of the static body are set; the others are the caller's to fill. */
pe_status pe_problem_take(pe_problem *problem, pe_workspace work, pe_error *error);

/* The arrays of a solution of `problem`, all zero, with room for so many marks; freed by
 * pe_contact_solution_free. */
pe_status pe_contact_solution_take(const pe_contact_problem *problem, int mark_capacity,
                                   pe_contact_solution *made, pe_error *error);

/* A contact problem given as data as solvers take it, in the workspace; velocities in step with its
 * impulses. */
pe_status pe_problem_of_data(const pe_contact_problem *data, pe_workspace work, pe_problem *problem,
                             pe_error *error);

/* Lists the sides of the bodies, when the bodies of all manifolds are set, so that threads can share
 * pe_problem_rebuild_velocity. Does nothing for a problem without threads. */
pe_status pe_problem_list_sides(pe_problem *problem, pe_workspace work, pe_error *error);

/* Sets the velocities to those of the impulses: v = v* + M^-1 J^T p. */
void pe_problem_rebuild_velocity(const pe_problem *problem);

/* The natural map of the convex problem K* contains u, m/s: w | p - P_K(p - u/w) |. */
double pe_cone_residual(double friction, double scale, const double p[3], const double u[3]);

/* The natural map of one point, m/s: the function above at u + mu |u_t| n. */
double pe_point_residual(double friction, double scale, const double p[3], const double u[3]);

/* The residual of all points at the present velocities and impulses. NaN in them gives NaN. */
pe_residual pe_problem_residual(const pe_problem *problem);

/* u (point_count): J v of every point at these velocities of all bodies, or J v + b. */
void pe_problem_point_velocities(const pe_problem *problem, const double (*velocity)[6],
                                 bool with_bias, double (*u)[3]);

/* Scale of a point at arms ra, rb from the centres of mass; see pe_solver_point. */
double pe_point_scale(const pe_inertia *a, const pe_inertia *b, const double ra[3],
                      const double rb[3]);

/* Whether any point has an impulse to start from. */
bool pe_problem_has_impulse(const pe_problem *problem);

/* De Saxce's shift mu |u_t| of each point at the present velocities: shift (point_count), m/s. */
void pe_problem_find_shifts(const pe_problem *problem, double *shift);

/* ---- Twists and wrenches ---- */

/* c = a x b */
static inline void pe_cross3(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* a.b */
static inline double pe_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The relative twist q of the manifold at these velocities of all bodies. */
static inline void pe_solver_manifold_twist(const pe_solver_manifold *manifold,
                                            const double (*velocity)[6], double q[6])
{
    const double *vA = velocity[manifold->a], *wA = vA + 3;
    const double *vB = velocity[manifold->b], *wB = vB + 3;
    double wA_rA[3], wB_rB[3], v[3], w[3];
    pe_cross3(wA, manifold->arm_a, wA_rA);
    pe_cross3(wB, manifold->arm_b, wB_rB);
    for (int k = 0; k < 3; ++k) {
        v[k] = (vB[k] + wB_rB[k]) - (vA[k] + wA_rA[k]);
        w[k] = wB[k] - wA[k];
    }
    for (int k = 0; k < 3; ++k) {
        q[k] = pe_dot3(manifold->frame[k], v);
        q[3 + k] = pe_dot3(manifold->frame[k], w);
    }
}

/* u = J v of a point of the manifold. */
static inline void pe_point_motion(const pe_solver_point *point, const double q[6], double u[3])
{
    pe_cross3(q + 3, point->s, u);
    u[0] = u[0] + q[0];
    u[1] = u[1] + q[1];
    u[2] = u[2] + q[2];
}

/* u = J v + b of a point of the manifold. */
static inline void pe_point_velocity(const pe_solver_point *point, const double q[6], double u[3])
{
    pe_point_motion(point, q, u);
    u[0] = u[0] + point->bias;
    u[1] = u[1] + point->slip[0];
    u[2] = u[2] + point->slip[1];
}

/* u -= b */
static inline void pe_point_take_bias(const pe_solver_point *point, double u[3])
{
    u[0] -= point->bias;
    u[1] -= point->slip[0];
    u[2] -= point->slip[1];
}

/* Adds the impulse p of one point to the manifold's wrench. */
static inline void pe_wrench_add(const pe_solver_point *point, const double p[3], double wrench[6])
{
    double moment[3];
    pe_cross3(point->s, p, moment);
    for (int k = 0; k < 3; ++k) {
        wrench[k] += p[k];
        wrench[3 + k] += moment[k];
    }
}

/* The force and torque on body B about the manifold's centre, in world axes, of a wrench in the
 * manifold's frame. */
static inline void pe_wrench_to_world(const pe_solver_manifold *manifold, const double wrench[6],
                                      double push[6])
{
    const double *n = manifold->frame[0], *t1 = manifold->frame[1], *t2 = manifold->frame[2];
    for (int k = 0; k < 3; ++k) {
        push[k] = n[k] * wrench[0] + t1[k] * wrench[1] + t2[k] * wrench[2];
        push[3 + k] = n[k] * wrench[3] + t1[k] * wrench[4] + t2[k] * wrench[5];
    }
}

/* Adds to the momentum of body B, at this arm from its centre of mass, what pe_wrench_to_world gives. */
static inline void pe_push_b(const double arm[3], const double push[6], double momentum[6])
{
    double moment[3];
    pe_cross3(arm, push, moment);
    for (int k = 0; k < 3; ++k) {
        momentum[k] += push[k];
        momentum[3 + k] += moment[k] + push[3 + k];
    }
}

/* Subtracts the same from the momentum of body A. */
static inline void pe_push_a(const double arm[3], const double push[6], double momentum[6])
{
    double moment[3];
    pe_cross3(arm, push, moment);
    for (int k = 0; k < 3; ++k) {
        momentum[k] -= push[k];
        momentum[3 + k] -= moment[k] + push[3 + k];
    }
}

/* Adds J^T p to the momenta of all bodies, from the wrench on body B in the manifold's frame. */
static inline void pe_solver_manifold_push(const pe_solver_manifold *manifold,
                                           const double wrench[6], double (*momentum)[6])
{
    double push[6];
    pe_wrench_to_world(manifold, wrench, push);
    pe_push_a(manifold->arm_a, push, momentum[manifold->a]);
    pe_push_b(manifold->arm_b, push, momentum[manifold->b]);
}

/* y = m x for a symmetric matrix (xx, xy, xz, yy, yz, zz) */
static inline void pe_symmetric_times(const double m[6], const double x[3], double y[3])
{
    y[0] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
    y[1] = m[1] * x[0] + m[3] * x[1] + m[4] * x[2];
    y[2] = m[2] * x[0] + m[4] * x[1] + m[5] * x[2];
}

/* y = M x of one body */
static inline void pe_mass_times(const pe_inertia *m, const double x[6], double y[6])
{
    for (int k = 0; k < 3; ++k) {
        y[k] = m->mass * x[k];
    }
    pe_symmetric_times(m->tensor, x + 3, y + 3);
}

/* momentum = M (v - v*) of body i at these velocities */
static inline void pe_problem_momentum(const pe_problem *problem, const double (*velocity)[6],
                                       int i, double momentum[6])
{
    double change[6];
    for (int k = 0; k < 6; ++k) {
        change[k] = velocity[i][k] - problem->free_velocity[i][k];
    }
    pe_mass_times(&problem->inertia[i], change, momentum);
}

/* y = M^-1 x of one body */
static inline void pe_inverse_mass_times(const pe_inertia *m, const double x[6], double y[6])
{
    for (int k = 0; k < 3; ++k) {
        y[k] = m->inverse_mass * x[k];
    }
    pe_symmetric_times(m->inverse_tensor, x + 3, y + 3);
}

#endif
