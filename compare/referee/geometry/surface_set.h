/* The surfaces that a scene's bodies need to be measured against meshes: one for each different
 * shape, none in a scene without a mesh. */
#ifndef PLUMB_SURFACE_SET_H
#define PLUMB_SURFACE_SET_H

#include "surface.h"

typedef struct pl_surface_set pl_surface_set;

/* NULL when out of memory. Freed by pl_surface_set_destroy (NULL allowed). */
pl_surface_set *pl_surface_set_create(const pl_scene *scene);
void pl_surface_set_destroy(pl_surface_set *set);

/* Of a body by its scene index; NULL where it needs none. Borrowed from the set. */
const pl_surface *pl_surface_set_of(const pl_surface_set *set, int body);

#endif
