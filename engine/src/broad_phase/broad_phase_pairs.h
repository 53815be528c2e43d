/* Lists of pairs of slots, in memory of the step. */
#ifndef PE_BROAD_PHASE_PAIRS_H
#define PE_BROAD_PHASE_PAIRS_H

#include "base/memory.h"

typedef struct pe_pair {
    int a, b; /* slots, a < b, not both static */
} pe_pair;

/* A growing list. All zero but `work` is the empty one. */
typedef struct pe_pair_list {
    pe_workspace work;
    pe_pair *items;
    int count, capacity;
} pe_pair_list;

/* Appends the pair with the smaller slot first. PE_NO_MEMORY leaves the list as it was. */
pe_status pe_pair_list_add(pe_pair_list *list, int a, int b, pe_error *error);

/* Sorts by (a, b) the pairs of slots below `slots`, in O(count + slots): a radix sort with the
 * slots for digits. PE_NO_MEMORY leaves the list as it was. */
pe_status pe_pair_list_sort(pe_pair_list *list, int slots, pe_error *error);

#endif
