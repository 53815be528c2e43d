/* Under which names a scene's file has its polyhedra. */
#ifndef PLUMB_POLYHEDRON_NAMES_H
#define PLUMB_POLYHEDRON_NAMES_H

#include "plumb/scene.h"
#include "pointer_map.h"

typedef struct pl_polyhedron_names {
    pl_pointer_map addresses;
    char (*names)[PL_NAME_SIZE]; /* (polyhedron_count); empty: it stands in its one body, or in none
                                  */
} pl_polyhedron_names;

/* Its own; or, where several bodies share one that has none, "polyhedron" and a number that no
 * other has. */
pl_status pl_polyhedron_names_create(const pl_scene *scene, pl_polyhedron_names *names);
void pl_polyhedron_names_free(pl_polyhedron_names *names);

#endif
