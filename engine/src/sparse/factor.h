/* Block Cholesky factorisation of H = M + sum over points of J^T G J, and solves with it.
 *
 * A body has six unknowns, so that the factor consists of 6 x 6 blocks, and more points of a
 * manifold only add to a sum. H is positive definite because M is, with any contacts: redundant
 * points do no harm. (George and Liu 1981.) */
#ifndef PE_FACTOR_H
#define PE_FACTOR_H

#include "pattern.h"

/* Eight numbers in one vector. */
typedef double pe_lanes __attribute__((vector_size(64)));

/* A 6 x 6 block, column-major. A column fills six of its eight lanes; two are padding. */
typedef struct pe_block {
    pe_lanes column[6];
} pe_block;

/* The block-sparse matrix H, and after the factorisation its factor. */
typedef struct pe_factor {
    const pe_pattern *pattern;
    pe_block *block; /* (pattern->start[count]): H, then its factor in place */
    pe_lanes *right; /* (count): scratch of the solves */
    pe_pool *pool;   /* threads that share the products of wide columns; NULL: none */
} pe_factor;

/* Symmetric (nn, n1, n2, 11, 12, 22) gain of each point in its manifold's frame, N s per m/s. */
typedef double pe_gain[6];

/* Takes the memory of a factor from the workspace; the pattern stays borrowed. */
pe_status pe_factor_create(const pe_pattern *pattern, pe_workspace work, pe_factor *factor,
                           pe_error *error);

/* Fills H from the gains (point_count). */
void pe_factor_assemble(pe_factor *factor, const pe_problem *problem, const pe_gain *gain);

/* Factors H in place. False if a pivot is not positive, which only NaN or overflow causes. */
bool pe_factor_compute(pe_factor *factor);

/* x = H^-1 b; both are (body_count) x 6 in the order of bodies, and may be the same array. */
void pe_factor_solve(const pe_factor *factor, const double (*b)[6], double (*x)[6]);

#endif
