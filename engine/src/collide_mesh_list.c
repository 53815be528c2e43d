/* A list of touches in the step's memory. */
#include "collide_mesh.h"

#include <string.h>

enum { FIRST_CAPACITY = 64 };

uint64_t pe_touch_feature(pe_touch_kind kind, int first, int second)
{
    return (uint64_t)kind << 60 | (uint64_t)(uint32_t)first << 30 | (uint64_t)(uint32_t)second;
}

void pe_touches_add(pe_touches *list, const pe_touch *touch)
{
    if (list->count == list->capacity && !list->failed) {
        int capacity = list->capacity > 0 ? 2 * list->capacity : FIRST_CAPACITY;
        pe_touch *items = pe_take(list->work, (size_t)capacity, sizeof *items);
        list->failed = items == NULL;
        if (!list->failed) {
            if (list->count > 0) {
                memcpy(items, list->items, (size_t)list->count * sizeof *items);
            }
            list->items = items;
            list->capacity = capacity;
        }
    }
    if (!list->failed) {
        list->items[list->count++] = *touch;
    }
}

/* Heapsort (Williams 1964): in place, and no worse for many. */
static void sift(pe_touch *items, int root, int count)
{
    pe_touch touch = items[root];
    int child = 2 * root + 1;
    for (; child < count; child = 2 * root + 1) {
        if (child + 1 < count && items[child + 1].feature > items[child].feature) {
            ++child;
        }
        if (items[child].feature <= touch.feature) {
            break;
        }
        items[root] = items[child];
        root = child;
    }
    items[root] = touch;
}

void pe_touches_sort(pe_touches *list)
{
    for (int i = list->count / 2 - 1; i >= 0; --i) {
        sift(list->items, i, list->count);
    }
    for (int end = list->count - 1; end > 0; --end) {
        pe_touch last = list->items[end];
        list->items[end] = list->items[0];
        list->items[0] = last;
        sift(list->items, 0, end);
    }
}
