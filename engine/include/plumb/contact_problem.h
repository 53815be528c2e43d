/* Contact problems as data: what the engine solves for one island in one step, to keep, to solve
 * again, and to try solvers on.
 *
 *   v = v* + M^-1 J^T p,   u = J v + b        per contact point: n, t1, t2; p in N s, u in m/s
 *   K* contains u + mu |u_t| n, K = { |p_t| <= mu p_n } contains p, and the two are orthogonal
 *
 * (Signorini and Coulomb in the form of De Saxce and Feng 1998; Acary and Brogliato 2008, ch. 3.)
 * J is held as geometry: at a point s off the centre of its manifold, in the manifold's frame F
 * (rows n, t1, t2), J v = F (v_b + w_b x r_b - v_a - w_a x r_a) + F (w_b - w_a) x s, where r_a and
 * r_b lead from the centres of mass to the manifold's centre.
 *
 * Conventions, status and errors are those of engine.h. A problem belongs to whoever has it, and
 * functions that take it const may be called on it by several threads at once. */
#ifndef PLUMB_CONTACT_PROBLEM_H
#define PLUMB_CONTACT_PROBLEM_H

#include "plumb/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pe_problem_body {
    double mass;             /* kg, > 0 */
    double inertia[6];       /* kg m^2, about the centre of mass, world axes: xx xy xz yy yz zz */
    double free_velocity[6]; /* v*: of the step without contacts; linear, angular, world */
    pe_body_id id;           /* in the world that it was captured from; null if in none */
} pe_problem_body;

enum { PE_STATIC = -1 }; /* stands for every static body */

typedef struct pe_problem_manifold {
    int a, b;         /* indices of bodies; one of the two may be PE_STATIC; n points from a to b */
    int first, count; /* its points: first .. first + count - 1 */
    double friction;  /* mu, >= 0 */
    double frame[3][3];        /* rows n, t1, t2: orthonormal, right-handed, world */
    double arm_a[3], arm_b[3]; /* r_a, r_b: world, m; no meaning for PE_STATIC */
} pe_problem_manifold;

typedef struct pe_problem_manifold_point {
    double offset[3];  /* s: in the manifold's frame, m */
    double bias;       /* b_n, m/s: the bounce asked for, or a gap over the step */
    double slip[2];    /* b_t, m/s: added to what friction opposes, where a slip goes on */
    double impulse[3]; /* warm start, (n, t1, t2) on b, N s */
} pe_problem_manifold_point;

/* Points lie in the order of their manifolds, without gaps: manifold 0 has first = 0, each next one
 * begins where the one before ends, and every manifold has at least one point. */
typedef struct pe_contact_problem {
    int body_count, manifold_count, point_count;
    pe_problem_body *bodies;           /* (body_count) */
    pe_problem_manifold *manifolds;    /* (manifold_count) */
    pe_problem_manifold_point *points; /* (point_count) */
    pe_allocator allocator;            /* of this struct and its arrays */
} pe_contact_problem;

/* A problem with room for so many, all zero. `allocator` NULL: that of a default world. The caller
 * destroys *problem. */
pe_status pe_contact_problem_create(int body_count, int manifold_count, int point_count,
                                    const pe_allocator *allocator, pe_contact_problem **problem,
                                    pe_error *error);
void pe_contact_problem_destroy(pe_contact_problem *problem); /* NULL allowed */

/* What is wrong with a problem: problem->LIST[index].FIELD. */
typedef struct pe_problem_fault {
    const char *list;  /* "bodies", "manifolds", "points" */
    int index;         /* in that list */
    const char *field; /* the struct's member */
    char text[160];    /* "expected ..., found ..." */
} pe_problem_fault;

/* Whether all that is said above holds: finite numbers, positive mass, positive definite inertia,
 * frames orthonormal to 1e-9, indices in range. If not, false, with the first fault. The impulses
 * may lie anywhere. */
bool pe_contact_problem_is_valid(const pe_contact_problem *problem, pe_problem_fault *fault);

/* The contact problems that pe_world_step(world, dt) would solve next, one for each island with a
 * contact, in the step's order, warm starts included. The world is left as it was: the step gives
 * the same bits with and without. The caller gives *problems to
 * pe_contact_problems_destroy. No contact: *count is 0. */
pe_status pe_world_capture_problems(pe_world *world, double dt, pe_contact_problem ***problems,
                                    int *count, pe_error *error);

/* Destroy what pe_world_capture_problems gave, the array too; `keep` all but problem `index`, which
 * it returns. A count of 0 is allowed. */
void pe_contact_problems_destroy(pe_contact_problem **problems, int count);
pe_contact_problem *pe_contact_problems_keep(pe_contact_problem **problems, int count, int index);

/* ---- Solvers -----------------------------------------------------------------------------------
 */

typedef struct pe_solver_info {
    const char *name;
    const char *description; /* a line */
    bool factorises;         /* an iteration is a factorisation; otherwise it is a sweep */
} pe_solver_info;

int pe_solver_count(void);

/* Of solver 0 .. pe_solver_count() - 1; NULLs for any other index. Static storage. */
pe_solver_info pe_solver(int index);

/* The natural map of a contact point, w | p - P_K(p - (u + mu |u_t| n)/w) |, w = tr(J M^-1 J^T)/3:
 * a velocity, zero in a solution. */
typedef struct pe_residual {
    double max, rms; /* m/s, over the points */
} pe_residual;

typedef struct pe_solve_limits {
    double tolerance;   /* m/s: stop at this pe_residual.max */
    int max_iterations; /* sweeps or Newton iterations */
} pe_solve_limits;

/* One line of the history: the residual after so many iterations. */
typedef struct pe_solve_mark {
    int iterations;
    double residual; /* m/s */
    double seconds; /* since the solve began, as clock() of the caller's choice has it; 0 without */
} pe_solve_mark;

typedef struct pe_contact_solution {
    double (*impulses)[3];   /* (point_count) x (n, t1, t2), N s, on b */
    double (*velocities)[6]; /* (body_count) x (linear, angular), world: v* + M^-1 J^T p */
    pe_residual start;       /* of the warm start */
    pe_residual residual;    /* of the impulses above, worked out apart from the solver */
    int iterations;          /* 0: the warm start was good enough, or the solver cannot start */
    pe_solve_stop stop;
    double seconds;         /* of the solver alone; 0 without a clock */
    double factor_flops;    /* of all factorisations made */
    pe_solve_mark *history; /* (history_count), iterations ascending */
    int history_count;
    pe_allocator allocator;
} pe_contact_solution;

/* Solves from the problem's warm start. `clock` gives seconds, or is NULL. That the solver did not
 * converge is no error: it is in *solution, which the caller frees. PE_BAD_ARGUMENT: no such
 * solver, limits out of range (tolerance > 0, max_iterations >= 0), or the problem's first fault;
 * nothing is then to be freed. */
pe_status pe_contact_problem_solve(const pe_contact_problem *problem, const char *solver,
                                   const pe_solve_limits *limits, double (*clock)(void),
                                   pe_contact_solution *solution, pe_error *error);

/* Frees what the solution holds, and makes it all zero. */
void pe_contact_solution_free(pe_contact_solution *solution);

#ifdef __cplusplus
}
#endif
#endif
