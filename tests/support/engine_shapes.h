/* Solids of every kind for the conformance tests of engines. */
#ifndef PLUMB_TEST_ENGINE_SHAPES_H
#define PLUMB_TEST_ENGINE_SHAPES_H

#include "engines/registry.h"
#include "plumb/scenario.h"

/* Whether the engine has this kind of shape at all. */
bool knows(const pl_engine_choice *choice, pl_shape_kind kind);

/* As in scene files: "capsule". */
const char *kind_name(pl_shape_kind kind);

/* How far a solid of this kind made by solid_body reaches along its own axis 0, 1 or 2: `half`, but
 * 0.8 and 0.9 of it along the first two axes of a hull and a mesh, and half of it for a capsule. */
double solid_width(pl_shape_kind kind, double half, int axis);

/* A body with a solid of those widths, its middle at `at`, turned by `angle` about the world's axis
 * 0, 1 or 2; a plane is z = half, whatever the rest. Hulls and meshes are boxes in a frame that is
 * neither at their middle nor along their edges. */
pl_body solid_body(pl_scene *scene, pl_shape_kind kind, double half, const double at[3], int axis,
                   double angle);

#endif
