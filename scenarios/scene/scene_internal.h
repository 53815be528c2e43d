/* Functions that the scene's files share: polyhedra and materials of a scene, width of a shape. */
#ifndef PLUMB_SCENE_INTERNAL_H
#define PLUMB_SCENE_INTERNAL_H

#include "plumb/scene.h"

/* Gives a malloc'd polyhedron to the scene. On PL_NO_MEMORY it stays the caller's. */
pl_status pl_scene_add_polyhedron(pl_scene *scene, pl_polyhedron *polyhedron, pl_error *error);

/* The index of the material of that name; -1 when there is none. */
int pl_scene_find_material(const pl_scene *scene, const char *name);

/* Half of the shape's smallest dimension, m: along its own axes, of a polyhedron along its
 * principal axes. INFINITY for a plane. */
double pl_shape_half_width(const pl_shape *shape);

/* ---- Polyhedra by their addresses ---- */

/* A polyhedron and its number. */
typedef struct pl_addressed {
    uintptr_t address;
    int index; /* in scene->polyhedra */
} pl_addressed;

/* A scene's polyhedra, for look-up by bisection. */
typedef struct pl_pointer_map {
    pl_addressed *items; /* (count), by address */
    int count;
} pl_pointer_map;

/* PL_NO_MEMORY leaves an empty map. O(n log n). */
pl_status pl_pointer_map_create(const pl_scene *scene, pl_pointer_map *map);

/* Frees the map's memory. */
void pl_pointer_map_free(pl_pointer_map *map);

/* The polyhedron's index in its scene; -1 for another's, and for NULL. */
int pl_pointer_map_find(const pl_pointer_map *map, const pl_polyhedron *polyhedron);

#endif
