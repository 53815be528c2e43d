/* An index of names, for look-up and for finding duplicates. */
#ifndef PLUMB_NAME_INDEX_H
#define PLUMB_NAME_INDEX_H

#include "plumb/base.h"

#include <stddef.h>
#include <stdint.h>

/* The place of an item in the index. */
typedef struct pl_name_slot {
    uint32_t hash; /* of the name */
    int number;    /* 1 + the number of the item; 0: there is none */
} pl_name_slot;

/* An open-addressed hash table of names. Its hash has a random key, so that no list of names can be
 * chosen to fall into one place. */
typedef struct pl_name_index {
    const char *first_name; /* borrowed, as all names */
    size_t stride;
    int count;
    int duplicate;       /* the lowest number of an item whose name an earlier item has; -1: none */
    pl_name_slot *slots; /* (mask + 1), a power of two, at most half of them used */
    uint32_t mask;
    uint64_t key[2];
} pl_name_index;

/* Makes an index of `count` items, `stride` bytes apart, whose name begins at `first_name` and ends
 * with a zero. The names must stay where they are while the index is used. PL_NO_MEMORY leaves an
 * empty index. */
pl_status pl_name_index_create(const char *first_name, size_t stride, int count,
                               pl_name_index *index);

/* Frees the index and makes it empty. */
void pl_name_index_free(pl_name_index *index);

/* The number of the item of that name, the first of them when it is not unique; -1 when there is
 * none. */
int pl_name_index_find(const pl_name_index *index, const char *name);

/* The lowest number of an item whose name an earlier item has; -1 when all names differ. */
int pl_name_index_duplicate(const pl_name_index *index);

/* pl_nearest_name over all names of the index in alphabetical order; also NULL when out of memory. */
const char *pl_name_index_nearest(const pl_name_index *index, const char *word);

#endif
