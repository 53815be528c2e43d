/* Growable arrays of plain data: an array is a pointer `items`, initially NULL, and an int `count`,
 * wherever its owner keeps them. The owner frees it with free(items).
 *
 *     pl_status status = pl_array_push(&list->items, &list->count, &item, sizeof item, error);
 *
 * The address of the pointer is passed as `void *`, because C has no pointer to a pointer to
 * anything; it must be the address of a pointer to items of `size` bytes. */
#ifndef PLUMB_ARRAY_H
#define PLUMB_ARRAY_H

#include "plumb/base.h"

#include <stddef.h>

/* Appends a copy of `item` and increments *count. An array that grows only by this function needs
 * no field for its capacity, which follows from the count: 8, then the next power of two. The count
 * may be set back at any time. On PL_NO_MEMORY the array is unchanged. Amortised O(1). */
pl_status pl_array_push(void *items, int *count, const void *item, size_t size, pl_error *error);

/* Makes room for at least `wanted` items in an array that keeps its capacity, which is at least
 * doubled when it grows. The items beyond the old capacity are not initialised. On PL_NO_MEMORY the
 * array is unchanged. */
pl_status pl_array_reserve(void *items, int *capacity, int wanted, size_t size, pl_error *error);

#endif
