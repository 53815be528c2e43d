/* What DART must store so that its rule of mixing gives every pair of materials its own
 * coefficients.
 *
 * DART stores a friction and a restitution with each shape of a body, not with a pair. A contact
 * has the lesser friction and the product of the restitutions (ContactConstraint.cpp, 6.12.1).
 * Often numbers for each material make that right. Where none do, a body gets its shape once for
 * each material that it can touch, and a filter lets each of these shapes meet just the one that is
 * meant for it. */
#ifndef PLUMB_DART_PAIRS_H
#define PLUMB_DART_PAIRS_H

#include "plumb/engine_abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The coefficients of the shapes of all materials. Begins as zeros, is freed by
 * pl_dart_pairs_free. */
typedef struct pl_dart_pairs {
    int material_count;
    bool by_partner; /* a shape for each material that can be touched; else one for all */
    bool *touch;     /* (material_count x material_count): bodies of these materials can touch */
    /* (material_count x material_count): what a shape of the first material stores for contacts
     * with the second; the same for all partners unless by_partner. */
    pl_pair_coefficients *stored;
} pl_dart_pairs;

/* Finds the coefficients for a scene. PL_NO_MEMORY. */
pl_status pl_dart_pairs_of(const pl_engine_setup *setup, pl_dart_pairs *pairs);

/* What a shape of `material` stores for contacts with `partner`. */
static inline pl_pair_coefficients pl_dart_stored(const pl_dart_pairs *pairs, int material,
                                                  int partner)
{
    return pairs->stored[material * pairs->material_count + partner];
}

/* Whether bodies of these materials can touch, at least one of them moving. */
static inline bool pl_dart_can_touch(const pl_dart_pairs *pairs, int material, int partner)
{
    return pairs->touch[material * pairs->material_count + partner];
}

/* Frees the arrays. */
void pl_dart_pairs_free(pl_dart_pairs *pairs);

#ifdef __cplusplus
}
#endif
#endif
