/* Whether a surface crosses itself. */
#ifndef PLUMB_MESH_CROSSING_H
#define PLUMB_MESH_CROSSING_H

#include "base/diagnostic.h"

/* Complains at "triangles"[t] of the first two triangles that cross: those that go through each
 * other, or lie in one plane, face the same way and overlap, by more than 1e-9 of the surface's
 * size. Triangles with a common edge never do. The surface must be closed, each component of
 * positive volume. O(n log n) where triangles are small beside the whole; up to O(n^2) where the
 * boxes around them overlap, as those of a fan of very many do. */
bool pl_mesh_check_crossing(const double (*vertices)[3], int vertex_count,
                            const int (*triangles)[3], int triangle_count,
                            pl_diagnostic *diagnostic);

#endif
