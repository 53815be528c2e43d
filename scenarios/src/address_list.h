/* A scene's polyhedra by their addresses, for look-up by bisection. */
#ifndef PLUMB_ADDRESS_LIST_H
#define PLUMB_ADDRESS_LIST_H

#include "plumb/scene.h"

typedef struct pl_addressed {
    uintptr_t address;
    int index; /* in scene->polyhedra */
} pl_addressed;

typedef struct pl_address_list {
    pl_addressed *items; /* (count), by address */
    int count;
} pl_address_list;

/* PL_NO_MEMORY leaves an empty list. O(n log n). */
pl_status pl_address_list_create(const pl_scene *scene, pl_address_list *list);
void pl_address_list_free(pl_address_list *list);

/* The polyhedron's index in its scene; -1 for another's, and for NULL. */
int pl_address_list_find(const pl_address_list *list, const pl_polyhedron *polyhedron);

#endif
