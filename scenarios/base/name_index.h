/* An index of names, for look-up and for finding duplicates. */
#ifndef PLUMB_NAME_INDEX_H
#define PLUMB_NAME_INDEX_H

#include "plumb/base.h"

#include <jansson.h>
#include <stddef.h>

/* An index of names. Its hash is jansson's, with a random key, so that no list of names can be chosen to
 * fall into one place. {0} finds nothing. */
typedef struct pl_name_index {
    const char *first_name; /* borrowed, as all names */
    size_t stride;
    int count;
    int duplicate;   /* the lowest number of an item whose name an earlier item has; -1: none */
    json_t *numbers; /* name -> the number of its first item */
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
