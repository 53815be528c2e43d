/* Patterns that are kept from step to step, while the pairs of an island stay. */
#ifndef PE_PATTERN_STORE_H
#define PE_PATTERN_STORE_H

#include "pattern.h"

enum { PE_KEPT_PATTERNS = 32 };

/* One island's; its key, the pairs that were counted, and the arrays of its pattern are in its part
 * of the pool. */
typedef struct pe_kept_pattern {
    uint64_t hash, used; /* used: the count of lookups when it was last asked for; 0: empty */
    int body_count, manifold_count, depth;
    double flops;
} pe_kept_pattern;

/* All zero is the empty store. Every part of the pool has room for the largest pattern so far, so
 * that a scene that does not grow allocates nothing, whatever its contacts do. */
typedef struct pe_pattern_store {
    pe_array pool; /* (PE_KEPT_PATTERNS x room) ints */
    size_t room;
    pe_kept_pattern kept[PE_KEPT_PATTERNS];
    uint64_t lookups;
} pe_pattern_store;

/* As pe_pattern_find with `counted` not NULL, but what was found for the same pairs before is not
 * found again; what was asked for longest ago makes room. The pattern points into the store and to
 * `counted`, and holds until the next call. */
pe_status pe_pattern_store_find(pe_pattern_store *store, const pe_problem *problem,
                                const bool *counted, pe_workspace work, pe_pattern *pattern,
                                pe_error *error);

void pe_pattern_store_free(pe_pattern_store *store, const pe_allocator *allocator);

#endif
