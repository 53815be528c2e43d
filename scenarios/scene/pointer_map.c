#include "pointer_map.h"

#include <stdlib.h>

static int by_address(const void *left, const void *right)
{
    const pl_addressed *a = left, *b = right;
    return (a->address > b->address) - (a->address < b->address);
}

pl_status pl_pointer_map_create(const pl_scene *scene, pl_pointer_map *map)
{
    *map = (pl_pointer_map){.items = NULL};
    if (scene->polyhedron_count == 0) {
        return PL_OK;
    }
    const size_t count = (size_t)scene->polyhedron_count;
    map->items = malloc(count * sizeof *map->items);
    if (map->items == NULL) {
        return PL_NO_MEMORY;
    }
    map->count = scene->polyhedron_count;
    for (int i = 0; i < map->count; i++) {
        map->items[i] = (pl_addressed){(uintptr_t)scene->polyhedra[i], i};
    }
    qsort(map->items, count, sizeof *map->items, by_address);
    return PL_OK;
}

void pl_pointer_map_free(pl_pointer_map *map)
{
    free(map->items);
    *map = (pl_pointer_map){.items = NULL};
}

int pl_pointer_map_find(const pl_pointer_map *map, const pl_polyhedron *polyhedron)
{
    if (map->count == 0) {
        return -1;
    }
    const pl_addressed key = {.address = (uintptr_t)polyhedron};
    const pl_addressed *found =
        bsearch(&key, map->items, (size_t)map->count, sizeof key, by_address);
    return found != NULL ? found->index : -1;
}
