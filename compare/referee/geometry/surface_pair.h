/* Two surfaces in a pose: how far apart they are, and where the edges of one pierce the other. */
#ifndef PLUMB_SURFACE_PAIR_H
#define PLUMB_SURFACE_PAIR_H

#include "surface.h"

typedef struct pl_surface_pair {
    const pl_surface *a, *b;
    pl_axes axes;  /* b's axes in a's frame */
    pl_vec offset; /* b's origin in a's frame, m */
} pl_surface_pair;

/* The distance of the surfaces (not of their solids), m; 0 where they cross. Of one above `within`
 * HUGE_VAL. */
double pl_surface_pair_distance(const pl_surface_pair *pair, double within);

typedef struct pl_piercing {
    int of;          /* 0: an edge of a pierces b; 1: of b, a */
    int edge;        /* of the one */
    int triangle;    /* of the other */
    double fraction; /* of the edge's way from start to end, 0 .. 1 */
} pl_piercing;

/* All of them, by `of`, edge and fraction. *piercings is NULL where there is none; the caller frees
 * it. PL_NO_MEMORY. */
pl_status pl_surface_pair_piercings(const pl_surface_pair *pair, pl_piercing **piercings,
                                    int *count);

#endif
