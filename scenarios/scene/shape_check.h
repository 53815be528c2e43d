/* The rules that every shape keeps. */
#ifndef PLUMB_SHAPE_CHECK_H
#define PLUMB_SHAPE_CHECK_H

#include "base/diagnostic.h"
#include "pointer_map.h"

/* The shape's own numbers; complains at the path as it stands. */
bool pl_check_shape(const pl_shape *shape, pl_diagnostic *diagnostic);

/* That the polyhedron of a hull or a mesh is one of the scene's, and of that kind. */
bool pl_check_polyhedron(const pl_shape *shape, const pl_pointer_map *polyhedra,
                         pl_diagnostic *diagnostic);

#endif
