/* A scene's polyhedra by their addresses, for look-up by bisection. */
#ifndef PLUMB_POINTER_MAP_H
#define PLUMB_POINTER_MAP_H

#include "plumb/scene.h"

typedef struct pl_addressed {
    uintptr_t address;
    int index; /* in scene->polyhedra */
} pl_addressed;

typedef struct pl_pointer_map {
    pl_addressed *items; /* (count), by address */
    int count;
} pl_pointer_map;

/* PL_NO_MEMORY leaves an empty map. O(n log n). */
pl_status pl_pointer_map_create(const pl_scene *scene, pl_pointer_map *map);
void pl_pointer_map_free(pl_pointer_map *map);

/* The polyhedron's index in its scene; -1 for another's, and for NULL. */
int pl_pointer_map_find(const pl_pointer_map *map, const pl_polyhedron *polyhedron);

#endif
