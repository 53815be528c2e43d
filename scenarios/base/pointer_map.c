#include "pointer_map.h"

#include <stdlib.h>

static int by_address(const void *left, const void *right)
{
    const pl_addressed *a = left, *b = right;
    return (a->address > b->address) - (a->address < b->address);
}

pl_status pl_pointer_map_create(const pl_scene *scene, pl_pointer_map *list)
{
    *list = (pl_pointer_map){.items = NULL};
    if (scene->polyhedron_count == 0) {
        return PL_OK;
    }
    const size_t count = (size_t)scene->polyhedron_count;
    list->items = malloc(count * sizeof *list->items);
    if (list->items == NULL) {
        return PL_NO_MEMORY;
    }
    list->count = scene->polyhedron_count;
    for (int i = 0; i < list->count; i++) {
        list->items[i] = (pl_addressed){(uintptr_t)scene->polyhedra[i], i};
    }
    qsort(list->items, count, sizeof *list->items, by_address);
    return PL_OK;
}

void pl_pointer_map_free(pl_pointer_map *list)
{
    free(list->items);
    *list = (pl_pointer_map){.items = NULL};
}

int pl_pointer_map_find(const pl_pointer_map *list, const pl_polyhedron *polyhedron)
{
    if (list->count == 0) {
        return -1;
    }
    const pl_addressed key = {.address = (uintptr_t)polyhedron};
    const pl_addressed *found =
        bsearch(&key, list->items, (size_t)list->count, sizeof key, by_address);
    return found != NULL ? found->index : -1;
}
