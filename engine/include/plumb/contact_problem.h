/* Contact problems as data: what the engine solves for one island in one step, to store, to solve
 * again, and to try solvers on.
 *
 *   v = v* + M^-1 J^T p,   u = J v + b        per contact point: n, t1, t2; p in N s, u in m/s
 *   K* contains u + mu |u_t| n, K = { |p_t| <= mu p_n } contains p, and the two are orthogonal
 *
 * (Signorini and Coulomb in the form of De Saxce and Feng 1998; Acary and Brogliato 2008, ch. 3.) J
 * is held as geometry: at a point s from the centre of its manifold, in the manifold's frame F
 * (rows n, t1, t2), J v = F (v_b + w_b x r_b - v_a - w_a x r_a) + F (w_b - w_a) x s, where r_a and
 * r_b lead from the centres of mass to the manifold's centre.
 *
 * Conventions, status and errors are those of engine.h. A problem belongs to its holder. Functions
 * that take it as const may be called on it by several threads at once. */
#ifndef PLUMB_CONTACT_PROBLEM_H
#define PLUMB_CONTACT_PROBLEM_H

#include "plumb/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Problems ---- */

/* A dynamic body. */
typedef struct pe_problem_body {
    double mass;             /* kg, > 0 */
    double inertia[6];       /* kg m^2, about the centre of mass, world axes: xx xy xz yy yz zz */
    double free_velocity[6]; /* v*: of the step without contacts; linear, angular; world */
    pe_body_id id;           /* in the world that it was captured from; null if there is none */
} pe_problem_body;

/* The index that stands for every static body. */
enum { PE_STATIC = -1 };

/* Contact points of two bodies that share a normal. */
typedef struct pe_problem_manifold {
    int a;           /* index of a body, or PE_STATIC */
    int b;           /* the same; at most one of the two is PE_STATIC, and n points from a to b */
    int first;       /* its first point */
    int count;       /* of its points, which follow each other; at least 1 */
    double friction; /* mu, >= 0 */
    double frame[3][3]; /* F: rows n, t1, t2; orthonormal, right-handed, world */
    double arm_a[3];    /* r_a: world, m; not used for PE_STATIC */
    double arm_b[3];    /* r_b: the same */
} pe_problem_manifold;

/* One contact point. */
typedef struct pe_problem_manifold_point {
    double offset[3]; /* s: in the manifold's frame, m */
    double bias;      /* b_n, m/s: the negative speed of a bounce, or a gap over the step */
    double slip[2];   /* b_t, m/s: added to the slip that friction opposes, where sliding goes on */
    double impulse[3]; /* warm start: (n, t1, t2), on b, N s */
} pe_problem_manifold_point;

/* A problem. Points lie in the order of their manifolds without gaps: manifold 0 has first = 0, and
 * each next one begins where the one before ends. */
typedef struct pe_contact_problem {
    int body_count;                    /* dynamic bodies */
    int manifold_count;                /* manifolds */
    int point_count;                   /* points of all manifolds */
    pe_problem_body *bodies;           /* (body_count) */
    pe_problem_manifold *manifolds;    /* (manifold_count) */
    pe_problem_manifold_point *points; /* (point_count) */
    pe_allocator allocator;            /* of this struct and its arrays */
} pe_contact_problem;

/* Creates a problem with these counts, all numbers zero. `allocator` NULL: that of a default world.
 * The caller destroys *problem. PE_BAD_ARGUMENT: a count is negative. */
pe_status pe_contact_problem_create(int body_count, int manifold_count, int point_count,
                                    const pe_allocator *allocator, pe_contact_problem **problem,
                                    pe_error *error);

/* Destroys a problem; NULL is allowed. */
void pe_contact_problem_destroy(pe_contact_problem *problem);

/* The first fault of a problem, in problem->LIST[index].FIELD. */
typedef struct pe_problem_fault {
    const char *list;  /* "bodies", "manifolds" or "points"; static storage */
    int index;         /* in that list */
    const char *field; /* the struct's member; static storage */
    char text[160];    /* "expected ..., found ..." */
} pe_problem_fault;

/* Whether a problem obeys all rules above: finite numbers, positive masses, positive definite
 * inertia, frames orthonormal to 1e-9, indices in range. If not, fills *fault, unless it is NULL.
 * The impulses may be outside of the friction cone. */
bool pe_contact_problem_is_valid(const pe_contact_problem *problem, pe_problem_fault *fault);

/* ---- Capture ---- */

/* Captures the contact problems that pe_world_step(world, dt) would solve next, dt in s: one for
 * each island with a contact, in the step's order, warm starts included. The world is not changed:
 * the next step gives the same bits with and without a capture. The caller gives *problems to
 * pe_contact_problems_destroy. Without contacts *count is 0. PE_BAD_ARGUMENT for a dt out of range;
 * PE_NO_MEMORY; PE_NOT_FINITE where a problem would not be valid: the velocities are absurd. */
pe_status pe_world_capture_problems(pe_world *world, double dt, pe_contact_problem ***problems,
                                    int *count, pe_error *error);

/* Destroys captured problems and their array. A count of 0 is allowed. */
void pe_contact_problems_destroy(pe_contact_problem **problems, int count);

/* The same, except for problem `index`, which it returns; the caller destroys that one. A negative
 * index keeps none and returns NULL. */
pe_contact_problem *pe_contact_problems_keep(pe_contact_problem **problems, int count, int index);

/* ---- Solvers ---- */

/* What a solver is. The solvers are gauss_seidel, momentum, newton, interior_point and direct. */
typedef struct pe_solver_info {
    const char *name;        /* as pe_contact_problem_solve takes it */
    const char *description; /* one line */
    bool factorises;         /* an iteration is a factorisation; otherwise it is a sweep */
} pe_solver_info;

/* The number of solvers. */
int pe_solver_count(void);

/* Solver 0 .. pe_solver_count() - 1, in static storage. All members are zero for other indices. */
pe_solver_info pe_solver(int index);

/* The natural map of a contact point, w | p - P_K(p - (u + mu |u_t| n)/w) | with w = tr(J M^-1
 * J^T)/3: a velocity, which is zero in a solution. */
typedef struct pe_residual {
    double max; /* m/s, largest over the points */
    double rms; /* m/s, root mean square over the points */
} pe_residual;

/* When a solver stops. */
typedef struct pe_solve_limits {
    double tolerance;   /* m/s, > 0: at this pe_residual.max */
    int max_iterations; /* >= 0: sweeps or factorisations */
} pe_solve_limits;

/* One entry of a solver's history. */
typedef struct pe_solve_mark {
    int iterations;  /* made so far */
    double residual; /* m/s, pe_residual.max after them */
    double seconds;  /* since the solve began, by the caller's clock; 0 without one */
} pe_solve_mark;

/* The result of a solve. */
typedef struct pe_contact_solution {
    double (*impulses)[3];   /* (point_count) x (n, t1, t2), N s, on b */
    double (*velocities)[6]; /* (body_count) x (linear, angular), world: v* + M^-1 J^T p */
    pe_residual start;       /* of the warm start */
    pe_residual residual;    /* of the impulses above, computed independently of the solver */
    int iterations;          /* 0: the warm start was good enough, or the solver cannot start */
    pe_solve_stop stop;      /* why it stopped */
    double seconds;          /* in the solver; 0 without a clock */
    double factor_flops;     /* floating-point operations of all factorisations */
    pe_solve_mark *history;  /* (history_count), iterations ascending */
    int history_count;       /* at least 1 */
    pe_allocator allocator;  /* of the arrays */
} pe_contact_solution;

/* Solves a problem from its warm start with the named solver. `clock` returns seconds, or is NULL.
 * Not converging is no error: *solution says so. The caller frees *solution.
 *
 * PE_BAD_ARGUMENT: there is no such solver, a limit is out of range, or the problem has a fault;
 * then *solution is not written. */
pe_status pe_contact_problem_solve(const pe_contact_problem *problem, const char *solver,
                                   const pe_solve_limits *limits, double (*clock)(void),
                                   pe_contact_solution *solution, pe_error *error);

/* Frees the arrays of a solution and sets all of it to zero. */
void pe_contact_solution_free(pe_contact_solution *solution);

#ifdef __cplusplus
}
#endif
#endif
