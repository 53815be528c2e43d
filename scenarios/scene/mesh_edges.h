/* How the triangles of a surface hang together: edges, direction, components. */
#ifndef PLUMB_MESH_EDGES_H
#define PLUMB_MESH_EDGES_H

#include "base/diagnostic.h"
#include "plumb/scene.h"

/* Fills neighbours[t][k] with the triangle beyond the edge of t from corner k to the next; t itself
 * where none is. Complains at "triangles"[t] of an edge that is not of exactly two triangles.
 * O(n log n). */
bool pl_mesh_neighbours(const int (*triangles)[3], int triangle_count, int (*neighbours)[3],
                        pl_diagnostic *diagnostic);

/* Turns triangles so that all neighbours run along their common edge in opposite directions, the
 * lowest triangle of each component staying as it is; complains where none such is. Fills
 * component[t] with the number of t's component, from 0 by lowest triangle, and *component_count.
 */
bool pl_mesh_orient(int (*triangles)[3], int triangle_count, const int (*neighbours)[3],
                    int *component, int *component_count, pl_diagnostic *diagnostic);

/* Whether each edge has two triangles that run along it in opposite directions; false also when out
 * of memory. */
bool pl_mesh_is_closed(const pl_polyhedron *polyhedron);

#endif
