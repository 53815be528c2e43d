/* The one patch of two convex shapes, which need no memory for it. */
#ifndef PLUMB_TEST_COLLIDE_CONVEX_H
#define PLUMB_TEST_COLLIDE_CONVEX_H

#include "narrow_phase/collide.h"

/* hits->count 0: none. */
static inline void collide_convex(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits)
{
    pe_pair_manifold patches[PE_MAX_MANIFOLDS];
    int count = pe_collide(a, b, margin, (pe_workspace){NULL, NULL}, patches);
    *hits = patches[0];
    hits->count = count > 0 ? hits->count : 0;
}

#endif
