/* Pairs that would collide at the poses now, but pass each other: see passing.c. */
#ifndef PE_PASSING_H
#define PE_PASSING_H

#include "narrow_phase/collide.h"

/* A pair of bodies at the start of a step. */
typedef struct pe_approach {
    pe_placed a, b;
    pe_twist of_a, of_b;
    const pe_manifold *old;              /* (old_count): of the pair in the last step */
    const pe_manifold_point *old_points; /* of all manifolds of that list */
    int old_count;
    double dt;     /* s */
    double fall;   /* m: by how much gravity may lengthen a way of the step */
    double margin; /* m, as in pe_collide */
    double depth;  /* m: how deep the bodies may lie in others, and so lower than these hold them */
} pe_approach;

/* Replaces the `*count` manifolds of a pair that would collide in the step along one of them by those
 * of a direction along which it stays apart, if there is one. They act at the poses now. Their points
 * lie where the smaller body will be touched. Returns false when out of memory. */
bool pe_pass(const pe_approach *approach, pe_workspace work, pe_pair_manifold *manifolds,
             int *count);

#endif
