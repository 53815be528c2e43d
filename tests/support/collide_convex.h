/* The manifold of two convex shapes. They need no memory for it. */
#ifndef PLUMB_TEST_COLLIDE_CONVEX_H
#define PLUMB_TEST_COLLIDE_CONVEX_H

#include "narrow_phase/collide.h"

/* manifold->count 0: they are farther apart than the margin. */
static inline void collide_convex(pe_placed a, pe_placed b, double margin,
                                  pe_pair_manifold *manifold)
{
    pe_pair_manifold manifolds[PE_MAX_MANIFOLDS];
    int count = pe_collide(a, b, margin, (pe_workspace){NULL, NULL, NULL}, manifolds);
    *manifold = manifolds[0];
    manifold->count = count > 0 ? manifold->count : 0;
}

#endif
