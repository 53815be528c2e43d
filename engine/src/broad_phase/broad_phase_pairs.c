#include "broad_phase_pairs.h"

#include <string.h>

pe_status pe_pair_list_add(pe_pair_list *list, int a, int b, pe_error *error)
{
    if (list->count == list->capacity) {
        int capacity = list->capacity < 64 ? 64 : list->capacity * 2;
        pe_pair *items = pe_take(list->work, (size_t)capacity, sizeof *items);
        if (items == NULL) {
            return pe_fail(error, PE_NO_MEMORY, "no memory for %d pairs", capacity);
        }
        if (list->count > 0) {
            memcpy(items, list->items, (size_t)list->count * sizeof *items);
        }
        list->items = items;
        list->capacity = capacity;
    }
    list->items[list->count++] = a < b ? (pe_pair){a, b} : (pe_pair){b, a};
    return PE_OK;
}

static int slot_of(pe_pair pair, bool b)
{
    return b ? pair.b : pair.a;
}

/* A stable counting sort by slot b, or by slot a. */
static void sort_by(bool b, const pe_pair *from, int count, int *start, int slots, pe_pair *to)
{
    memset(start, 0, ((size_t)slots + 1) * sizeof *start);
    for (int i = 0; i < count; ++i) {
        start[slot_of(from[i], b) + 1] += 1;
    }
    for (int s = 0; s < slots; ++s) {
        start[s + 1] += start[s];
    }
    for (int i = 0; i < count; ++i) {
        to[start[slot_of(from[i], b)]++] = from[i];
    }
}

pe_status pe_pair_list_sort(pe_pair_list *list, int slots, pe_error *error)
{
    if (list->count < 2) {
        return PE_OK;
    }
    int *start = pe_take(list->work, (size_t)slots + 1, sizeof *start);
    pe_pair *sorted = pe_take(list->work, (size_t)list->count, sizeof *sorted);
    if (start == NULL || sorted == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to sort %d pairs", list->count);
    }
    sort_by(true, list->items, list->count, start, slots, sorted);
    sort_by(false, sorted, list->count, start, slots, list->items);
    return PE_OK;
}
