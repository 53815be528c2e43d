/* Patterns that are kept from step to step, as long as the pairs of an island stay the same. */
#ifndef PE_PATTERN_STORE_H
#define PE_PATTERN_STORE_H

#include "pattern.h"

enum { PE_KEPT_PATTERNS = 32 };

/* The pattern of one island. Its key (the pairs that were counted) and its arrays are in its part
 * of the pool. */
typedef struct pe_kept_pattern {
    uint64_t hash; /* of the key */
    uint64_t used; /* number of the last lookup that found it; 0: empty */
    int body_count, manifold_count, depth;
    double flops;
} pe_kept_pattern;

/* All zero is the empty store. Every part of the pool has room for the largest pattern so far, so
 * that a scene that does not grow allocates nothing. */
typedef struct pe_pattern_store {
    pe_array pool; /* (PE_KEPT_PATTERNS x room) ints */
    size_t room;   /* of each part */
    pe_kept_pattern kept[PE_KEPT_PATTERNS];
    uint64_t lookups; /* made so far */
} pe_pattern_store;

/* As pe_pattern_find with `counted` not NULL, but a pattern of the same pairs is taken from the
 * store. A new one replaces the least recently used. The pattern points into the store and to
 * `counted`, and is valid until the next call. */
pe_status pe_pattern_store_find(pe_pattern_store *store, const pe_problem *problem,
                                const bool *counted, pe_workspace work, pe_pattern *pattern,
                                pe_error *error);

/* Frees the memory of a store. */
void pe_pattern_store_free(pe_pattern_store *store, const pe_allocator *allocator);

#endif
