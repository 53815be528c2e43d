#include "array.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 8 };

/* Reallocates the array whose pointer is at `items`. The pointer is copied as bytes, since it has a
 * type that this function does not know. */
static pl_status reallocate(void *items, int capacity, size_t size, pl_error *error)
{
    void *old, *grown;
    memcpy(&old, items, sizeof old);
    grown = (size_t)capacity > SIZE_MAX / size ? NULL : realloc(old, (size_t)capacity * size);
    if (grown == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d items of %zu bytes", capacity,
                       size);
    }
    memcpy(items, &grown, sizeof grown);
    return PL_OK;
}

static int doubled(int count)
{
    return count < FIRST_CAPACITY ? FIRST_CAPACITY : count > INT_MAX / 2 ? INT_MAX : 2 * count;
}

pl_status pl_array_push(void *items, int *count, const void *item, size_t size, pl_error *error)
{
    const int used = *count;
    if (used == 0 || (used >= FIRST_CAPACITY && (used & (used - 1)) == 0)) {
        pl_status status = reallocate(items, doubled(used), size, error);
        if (status != PL_OK) {
            return status;
        }
    }
    char *first;
    memcpy(&first, items, sizeof first);
    memcpy(first + (size_t)used * size, item, size);
    *count = used + 1;
    return PL_OK;
}

pl_status pl_array_reserve(void *items, int *capacity, int wanted, size_t size, pl_error *error)
{
    if (wanted <= *capacity) {
        return PL_OK;
    }
    int larger = doubled(*capacity) > wanted ? doubled(*capacity) : wanted;
    pl_status status = reallocate(items, larger, size, error);
    if (status == PL_OK) {
        *capacity = larger;
    }
    return status;
}
