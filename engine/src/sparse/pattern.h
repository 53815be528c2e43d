/* Symbolic block Cholesky on the graph of bodies: which 6 x 6 blocks the factor of M + sum J^T G J
 * has. It depends on the pairs only, not on the numbers.
 *
 * The elimination order is approximate minimum degree (Amestoy, Davis, Duff 1996) where the engine
 * was built with SuiteSparse's AMD, otherwise breadth first from a vertex of least degree, reversed
 * (Cuthill and McKee 1969; George 1971). */
#ifndef PE_PATTERN_H
#define PE_PATTERN_H

#include "base/memory.h"
#include "problem/problem.h"

/* Columns are in the order of elimination; column k holds blocks start[k] .. start[k + 1] - 1, the
 * diagonal first, then rows ascending. All in the workspace. */
typedef struct pe_pattern {
    int count;         /* block columns, one a body */
    const int *order;  /* (count): the body of column k */
    const int *place;  /* (count): the column of body i */
    const int *start;  /* (count + 1) */
    const int *row;    /* (start[count]) */
    const int *couple; /* (manifold_count): the block in which a manifold couples its two bodies, -1
                          if one is static or the manifold was left out */
    const bool *counted; /* (manifold_count): whether the manifold was taken into account */
    int depth;           /* bodies from the static ones to the farthest, 1 where none is static */
    double mass_ratio;   /* the lightest body's mass over the heaviest's */
    double flops;        /* of one factorisation */
} pe_pattern;

/* Finds the pattern for manifolds with counted[i]; NULL: all. In a wall most contacts carry
 * nothing, those between neighbours in a row, and leaving them out makes the factor cheap. */
pe_status pe_pattern_find(const pe_problem *problem, const bool *counted, pe_workspace work,
                          pe_pattern *pattern, pe_error *error);

/* Marks the manifolds that are expected to carry: those with a normal impulse, or an approach
 * faster than `speed`, in m/s, at the present velocities. Returns the number of their points. */
int pe_pattern_mark_loaded(const pe_problem *problem, double speed, bool *loaded);

/* The lightest body's mass over the heaviest's. */
double pe_pattern_mass_ratio(const pe_problem *problem);

#endif
