/* Gauss-Seidel sweeps over the manifolds of a problem, eight at a time.
 *
 * Manifolds are coloured so that no two of one colour share a dynamic body, and packed eight to a
 * block; the manifolds of a block can then be visited in any order, or at once, with the same
 * result. A sweep goes by colour, then by manifold, on every machine. The number of lanes that an
 * instruction works on is chosen at run time and does not change the bits.
 *
 * A manifold is swept in its relative twist q = T v (problem.h): its points change q through E = T
 * M^-1 T^T, six by six, and only the sum of their impulses goes back to the bodies. For four points
 * that takes 208 bytes a point, where rows of the Jacobian take 360.
 *
 * With momentum, z is what a sweep leaves and y = z + beta (z - z_before) is where the next one
 * starts; z lies in the cones, y need not.
 *
 * A problem may consist of parts that share no dynamic body, such as several islands, so that they
 * fill the blocks together. Each part has a beta of its own, and its bits are those that it would
 * have alone.
 *
 * The threads of the problem share the blocks of a colour where it has many. Static bodies are only
 * read. */
#ifndef PE_SWEEP_H
#define PE_SWEEP_H

#include "base/memory.h"
#include "problem/problem.h"
#include "solver_body.h"
#include "stages.h"

enum { PE_BLOCK_LANES = 8 };

/* One number per manifold of a block. */
typedef double pe_block_lanes[PE_BLOCK_LANES];

/* Eight manifolds of one colour. Lanes without a manifold are between static bodies, all zero. */
typedef struct pe_sweep_block {
    int a[PE_BLOCK_LANES], b[PE_BLOCK_LANES];
    int colour; /* its own for a manifold that found no colour free */
    int first,
        count; /* points first .. first + count - 1: the most that any of the manifolds has */
    /* n and t1, world; t2 = n x t1 */
    _Alignas(64) pe_block_lanes normal[3], tangent[3];
    pe_block_lanes arm_a[3], arm_b[3];
    pe_block_lanes inverse_inertia_a[6], inverse_inertia_b[6];
    pe_block_lanes friction;
    pe_block_lanes beta;        /* of the manifold's part */
    pe_block_lanes e_normal[6]; /* E of the velocity along n and the spins about t1 and t2 */
    pe_block_lanes e_other[15]; /* the rest of E; not filled with `normals` */
} pe_sweep_block;

/* A part of a problem: ranges of its bodies and manifolds. */
typedef struct pe_sweep_part {
    int body, body_count, manifold, manifold_count;
} pe_sweep_part;

/* The k-th points of eight manifolds: what their normal impulses need. Lanes whose manifold has fewer
 * points never touch. */
typedef struct pe_sweep_point {
    _Alignas(64) pe_block_lanes s[2]; /* s along t1 and t2 */
    pe_block_lanes bias;
    pe_block_lanes impulse;     /* z */
    pe_block_lanes before;      /* z of the sweep before */
    pe_block_lanes inverse_wnn; /* of W = J M^-1 J^T, kg; 0 in a lane without a point */
    pe_block_lanes inverse_wtt; /* of the larger eigenvalue of W's tangential block */
} pe_sweep_point;

/* What their friction needs besides. */
typedef struct pe_sweep_friction {
    _Alignas(64) pe_block_lanes s; /* along n */
    pe_block_lanes impulse[2];
    pe_block_lanes before[2];
    pe_block_lanes wn[2]; /* W's coupling of n with t1 and t2, 1/kg */
} pe_sweep_friction;

/* What sweeps seldom read, or only their residuals; 0 in a lane without a point. */
typedef struct pe_sweep_extra {
    pe_block_lanes slip[2], scale; /* as in pe_solver_point */
} pe_sweep_extra;

/* Blocks of a piece, in sums over all blocks. */
enum { PE_SUM_GRAIN = 128 };

/* A problem in blocks of eight manifolds, with the state of its sweeps. */
typedef struct pe_sweep {
    const pe_problem *problem;
    const struct pe_sweep_kernel *kernel;
    bool normals; /* only normal impulses are swept; what they do not need is not filled */
    int block_count, point_count;
    pe_sweep_block *blocks;
    pe_sweep_point *points;
    pe_sweep_friction *frictions; /* (point_count); none with `normals` */
    pe_sweep_extra *extras;       /* the same */
    bool has_slip;                /* any point's is not 0 */
    pe_stages stages;
    pe_solver_body *velocity; /* (body_count + 1): of z; world axes */
    pe_solver_body *before;   /* (body_count + 1): of z of the sweep before */
    bool one_beta;            /* all parts have whole_beta; `beta` is not read */
    double whole_beta;
    double *beta;              /* (body_count + 1): of the body's part; 0 of static bodies */
    pe_block_lanes *worst;     /* (block_count): residuals of manifolds */
    int *place;                /* (manifold_count): 8 x block + lane; -1: left out */
    int *source;               /* (8 x block_count): the manifold in the lane; -1: none */
    struct pe_violation *sums; /* one for each piece of the blocks: scratch */
} pe_sweep;

/* By how much J_n v + b >= 0 is violated, in the unit of b. */
typedef struct pe_violation {
    double deepest;
    double squares; /* sum over the points */
} pe_violation;

/* The work on blocks begin .. end - 1 for one width of instructions; see the functions below of the
 * same names. */
typedef struct pe_sweep_kernel {
    void (*prepare)(pe_sweep *sweep, int begin, int end); /* E of the manifolds, W of the points */
    /* y = z + beta (z - z_before) of the velocities of bodies begin .. end - 1; the impulses follow
     * in the sweep. */
    void (*extrapolate)(pe_sweep *sweep, int begin, int end);
    void (*sweep_cones)(pe_sweep *sweep, int begin, int end);
    void (*sweep_normals)(pe_sweep *sweep, int begin, int end);
    void (*residuals)(const pe_sweep *sweep, int begin, int end); /* fills sweep->worst */
    pe_violation (*violation)(const pe_sweep *sweep, int begin, int end);
} pe_sweep_kernel;

/* Lays out a problem, which stays borrowed, with its impulses and velocities, in the workspace. */
pe_status pe_sweep_create(const pe_problem *problem, const pe_sweep_kernel *kernel,
                          pe_workspace work, pe_sweep *sweep, pe_error *error);

/* The same for pe_sweep_normals alone, over the manifolds with chosen[i]; NULL: all. It is used as a
 * whole, and has no residuals but a violation. */
pe_status pe_sweep_create_normals(const pe_problem *problem, const bool *chosen,
                                  const pe_sweep_kernel *kernel, pe_workspace work, pe_sweep *sweep,
                                  pe_error *error);

/* The whole problem as one part. */
pe_sweep_part pe_sweep_whole(const pe_sweep *sweep);

/* Sets the momentum of a part in the sweeps that follow; 0 at first. */
void pe_sweep_set_beta(pe_sweep *sweep, const pe_sweep_part *part, double beta);

/* One sweep from y = z + beta (z - z_before): each point takes the normal impulse that stops
 * approach, then the tangential one that stops slip, held to the disc of radius mu p_n. */
void pe_sweep_cones(pe_sweep *sweep);

/* The same for normal impulses only, as if there were no friction; tangential impulses stay. */
void pe_sweep_normals(pe_sweep *sweep);

/* Largest natural-map residual of z in each part, m/s: that of pe_problem_residual except for
 * rounding. */
void pe_sweep_residuals(const pe_sweep *sweep, const pe_sweep_part *parts, int count,
                        double *residuals);

/* The violation of J_n v + b >= 0 by z. */
pe_violation pe_sweep_violation(const pe_sweep *sweep);

/* Writes z of a part to the problem's impulses. The problem's velocities are not updated. */
void pe_sweep_store(const pe_sweep *sweep, const pe_sweep_part *part);

/* ---- Parts ---- */

/* Makes one problem of several that share no dynamic body, in the workspace, and fills parts
 * (count). A single one is borrowed as it is. */
pe_status pe_sweep_join(const pe_problem *const *problems, int count, pe_workspace work,
                        pe_problem *joint, pe_sweep_part *parts, pe_error *error);

/* Copies the impulses of the joint problem back. */
void pe_sweep_part_from(const pe_problem *joint, const pe_problem *const *problems, int count);

/* ---- Momentum ---- */

/* The state that chooses beta, the heavy-ball momentum of a sweep (Polyak 1964). Which beta is good
 * is not known beforehand, and contact problems have no objective to descend on, so that beta
 * follows the residual e, evaluated every few sweeps:
 *
 *   no gain of a tenth in 100 sweeps, or e > 30 times the best: 20 sweeps with beta = 0.
 *     If e then falls to less than half, momentum kept it up: 1 - beta grows by 1.7, to 0.5 at most.
 *     If it falls by less than a fifth, momentum is not to blame: 1 - beta shrinks by 0.7, to 0.02.
 *
 * Measured on piles, towers and walls against plain Gauss-Seidel, Nesterov's sequence with
 * restarts, nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe, Erleben 2010) and fixed
 * betas. */
typedef struct pe_momentum {
    double beta;
    int sweeps; /* made so far */
    double best, before_probe;
    int since_gain; /* sweeps */
    int probe_left; /* sweeps without momentum still to make; 0: none */
} pe_momentum;

/* Starts at this residual. */
pe_momentum pe_momentum_begin(double residual);

/* The beta of the next sweep. It grows from 0 as Nesterov's sequence does. */
double pe_momentum_next(pe_momentum *m);

/* To be called with the residual after every `sweeps` more sweeps. */
void pe_momentum_look(pe_momentum *m, int sweeps, double residual);

#endif
