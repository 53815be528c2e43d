/* Which closed surfaces lie within which. */
#ifndef PLUMB_MESH_NESTING_H
#define PLUMB_MESH_NESTING_H

#include "base/diagnostic.h"

enum { PL_MAX_SURFACES = 4096 };

/* Turns each of `surface_count` components to its outer side, and complains of one that encloses
 * no volume. surface[t] is the number of t's component. */
bool pl_mesh_turn_outward(const double (*vertices)[3], int (*triangles)[3], int triangle_count,
                          const int *surface, int surface_count, pl_diagnostic *diagnostic);

/* Of surfaces that are turned outward and do not cross: turns round those that lie within an odd
 * number of others. */
bool pl_mesh_turn_cavities(const double (*vertices)[3], int (*triangles)[3], int triangle_count,
                           const int *surface, int surface_count, pl_diagnostic *diagnostic);

#endif
