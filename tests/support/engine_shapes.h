/* Solids of every kind for the conformance tests of engines. Hulls and meshes have a frame whose
 * origin is outside of them. */
#ifndef PLUMB_TEST_ENGINE_SHAPES_H
#define PLUMB_TEST_ENGINE_SHAPES_H

#include "adapters/registry.h"
#include "plumb/scenario.h"

/* Whether the engine has this kind of shape at all. */
bool knows(const pl_engine_choice *choice, pl_shape_kind kind);

/* As in scene files: "capsule". */
const char *kind_name(pl_shape_kind kind);

/* A body with a solid that is `half` wide to every side along its own axes (a cube, but for what is
 * round), its middle at `at`, turned by `angle` about the world's axis 0, 1 or 2. A plane is
 * z = half, whatever the rest. */
pl_body solid_body(pl_scene *scene, pl_shape_kind kind, double half, const double at[3], int axis,
                   double angle);

#endif
