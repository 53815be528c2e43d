/* Gauss-Seidel sweeps over the manifolds of a problem, eight at a time.
 *
 * Manifolds are coloured so that no two of one colour share a dynamic body, and packed eight to a
 * block; manifolds of a block can then be visited in any order, or at once, with the same result.
 * The order of a sweep is by colour, then by manifold, on every machine, and so are the bits: how
 * many of the eight lanes an instruction works on is chosen when the program runs.
 *
 * A manifold is swept in its relative twist q = T v (problem.h): its points change q through
 * E = T M^-1 T^T, six by six, and only their sum goes back to the bodies. For four points that is
 * 216 bytes a point, where rows of the Jacobian take 360.
 *
 * With momentum, z is what a sweep leaves and y = z + beta (z - z_before) what the next begins at;
 * z lies in the cones, y need not. */
#ifndef PE_SWEEP_H
#define PE_SWEEP_H

#include "base/memory.h"
#include "problem/problem.h"
#include "solver_body.h"

enum { PE_BLOCK_LANES = 8 };

typedef double pe_block_lanes[PE_BLOCK_LANES];

/* Eight manifolds of one colour. Lanes without a manifold are between static bodies, all zero. */
typedef struct pe_sweep_block {
    int a[PE_BLOCK_LANES], b[PE_BLOCK_LANES];
    int colour; /* one of its own for a manifold that found none free */
    int first,
        count; /* points first .. first + count - 1: the most that any of the manifolds has */
    _Alignas(64) pe_block_lanes normal[3], tangent[3]; /* n and t1, world; t2 = n x t1 */
    pe_block_lanes arm_a[3], arm_b[3];
    pe_block_lanes inverse_inertia_a[6], inverse_inertia_b[6];
    pe_block_lanes linear[6], mixed[9], angular[6]; /* E: two symmetric blocks, one full */
    pe_block_lanes friction;
} pe_sweep_block;

/* The k-th points of eight manifolds. Lanes whose manifold has fewer never touch. */
typedef struct pe_sweep_point {
    pe_block_lanes s[3], bias, slip[2];
    pe_block_lanes inverse_wnn; /* W = J M^-1 J^T of the point, kg; 0 in a lane without a point */
    pe_block_lanes inverse_wtt; /* of the larger eigenvalue of W's tangential block */
    pe_block_lanes wn1, wn2;    /* W's coupling of n with t1 and t2, 1/kg */
    pe_block_lanes impulse[3];  /* z */
    pe_block_lanes before[3];   /* z of the sweep before */
    pe_block_lanes scale;       /* as in pe_solver_point */
} pe_sweep_point;

typedef struct pe_sweep {
    const pe_problem *problem;
    const struct pe_sweep_kernel *kernel;
    int block_count, point_count;
    pe_sweep_block *blocks;
    pe_sweep_point *points;
    pe_solver_body *velocity,
        *before; /* (body_count + 1): of z, and of z a sweep before; world axes */
    int *place;  /* (manifold_count): 8 x block + lane */
} pe_sweep;

/* How far J_n v + b >= 0 is from being met, in the unit of b. */
typedef struct pe_violation {
    double deepest, squares; /* squares: their sum over the points */
} pe_violation;

/* The work on blocks for one width of instructions, by those names below. */
typedef struct pe_sweep_kernel {
    int lanes;
    void (*prepare)(pe_sweep *sweep); /* E of the manifolds, W of the points */
    void (*sweep_cones)(pe_sweep *sweep, double beta);
    double (*residual)(const pe_sweep *sweep);
    void (*sweep_normals)(pe_sweep *sweep, double beta);
    pe_violation (*violation)(const pe_sweep *sweep);
} pe_sweep_kernel;

/* The widest kernel that this build and processor have, of at most `lanes` lanes; 0: any. */
const pe_sweep_kernel *pe_sweep_kernel_for(int lanes);

/* Lays out a problem, which stays borrowed, with its impulses and velocities, in the workspace. */
pe_status pe_sweep_create(const pe_problem *problem, const pe_sweep_kernel *kernel,
                          pe_workspace work, pe_sweep *sweep, pe_error *error);

/* One sweep from y = z + beta (z - z_before), in which each point takes the normal impulse that
 * stops approach, and then the tangential one that stops slip, held to the disc of radius mu p_n.
 */
static inline void pe_sweep_cones(pe_sweep *sweep, double beta)
{
    sweep->kernel->sweep_cones(sweep, beta);
}

/* Largest natural-map residual of z, m/s, as pe_problem_residual has it but for rounding. */
static inline double pe_sweep_residual(const pe_sweep *sweep)
{
    return sweep->kernel->residual(sweep);
}

/* The same for normal impulses alone, as if there were no friction; the tangential ones stay. */
static inline void pe_sweep_normals(pe_sweep *sweep, double beta)
{
    sweep->kernel->sweep_normals(sweep, beta);
}

static inline pe_violation pe_sweep_violation(const pe_sweep *sweep)
{
    return sweep->kernel->violation(sweep);
}

/* Writes z to the problem's impulses; the problem's velocities are then behind. */
void pe_sweep_store(const pe_sweep *sweep);

#endif
