/* What the scene's own files share of its growth. */
#ifndef PLUMB_SCENE_ARRAY_H
#define PLUMB_SCENE_ARRAY_H

#include "plumb/scene.h"

/* Gives a malloc'd polyhedron to the scene; on PL_NO_MEMORY it stays the caller's. */
pl_status pl_scene_add_polyhedron(pl_scene *scene, pl_polyhedron *polyhedron, pl_error *error);

#endif
