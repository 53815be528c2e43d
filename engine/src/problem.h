/* The contact problem of one step, and the one residual by which every solver is judged.
 *
 *   v = v* + M^-1 J^T p,   u = J v + b        per contact point: n, t1, t2; p in N s, u in m/s
 *   b_n = e u_n before an impact above the threshold, phi/h for a gap phi > 0, else 0
 *
 * Signorini-Coulomb in De Saxce's form: K* contains u + mu |u_t| n, K = { |p_t| <= mu p_n }
 * contains p, and the two are orthogonal. (De Saxce and Feng 1998; Acary and Brogliato 2008,
 * ch. 3.)
 *
 * Velocities are scaled by the root of the mass matrix, y = M^(1/2) v with the angular part in the
 * body's axes, so that each row of J M^(-1/2) is at once the row that measures u and the column
 * that p acts by. */
#ifndef PE_PROBLEM_H
#define PE_PROBLEM_H

#include "island.h"

enum { PE_LANES = 8 }; /* 6 numbers a body, in a line of 64 bytes */

typedef struct pe_row {
    int a, b;        /* slots */
    double ja[3][6]; /* (n, t1, t2) x (linear, angular) of body a; 0 when it is static */
    double jb[3][6]; /* the same of body b */
    double bias;     /* b_n, m/s */
    double friction;
    double inverse_wnn; /* W = J M^-1 J^T of this point, kg */
    double inverse_wtt; /* of the larger eigenvalue of W's tangential block */
    double wn1, wn2;    /* W's coupling of n with t1 and t2 */
    double scale;       /* w = tr W / 3, 1/kg: makes an impulse of this point a velocity */
} pe_row;

/* One island's problem, or a view of all of them. */
typedef struct pe_problem {
    int count;
    pe_row *rows;                            /* (count) */
    double (*impulse)[3];                    /* (count x 3): n, t1, t2 */
    double (*velocity)[PE_LANES];            /* (slots x 8): y, in step with the impulses */
    const double (*free_velocity)[PE_LANES]; /* y* */
} pe_problem;

/* A whole step's problems: rows in the order of islands, then manifolds, then points. */
typedef struct pe_problems {
    pe_problem all;
    const int *row_start;   /* (islands.count + 1): island k has rows row_start[k] .. [k + 1] - 1 */
    const int *point_of;    /* (all.count): the contact point of each row */
    const int *manifold_of; /* (all.count) */
    double (*spare)[PE_LANES]; /* (slots x 8): not touched by the velocity problem */
} pe_problems;

/* Assembles rows, biases, warm-start impulses and y*, with y = y*; in the step's arena. `predicted`
 * are the velocities without contacts, `dt` the step. */
pe_status pe_problems_build(pe_world *world, const pe_islands *islands, const pe_motion *predicted,
                            double dt, pe_problems *problems, pe_error *error);

/* Island k's own problem. */
pe_problem pe_problems_island(const pe_problems *problems, int k);

/* Stores each row's impulse in its contact point, as a world vector on body b. */
void pe_problems_store_impulses(pe_world *world, const pe_problems *problems);

/* Makes the velocities those of the impulses: y = y* + (J M^(-1/2))^T p. */
void pe_problem_rebuild_velocity(const pe_problem *problem);

/* Largest natural-map residual over the rows, in m/s:
 * w | p - P_K(p - (u + mu |u_t| n)/w) |, from the velocities as they stand. */
double pe_problem_residual(const pe_problem *problem);

/* j . y */
static inline double pe_row_dot(const double *restrict j, const double *restrict y)
{
    return (j[0] * y[0] + j[2] * y[2] + j[4] * y[4]) + (j[1] * y[1] + j[3] * y[3] + j[5] * y[5]);
}

/* y += s j */
static inline void pe_row_add(double *restrict y, double s, const double *restrict j)
{
    for (int k = 0; k < 6; ++k) {
        y[k] += s * j[k];
    }
}

/* Component k (0 n, 1 t1, 2 t2) of the relative velocity J v, without the bias. */
static inline double pe_row_velocity(const pe_row *row, int k, const double *ya, const double *yb)
{
    return pe_row_dot(row->ja[k], ya) + pe_row_dot(row->jb[k], yb);
}

#endif
