/* Closed surfaces of triangles: how the triangles connect, whether the surface crosses itself, and
 * which surfaces lie within which. */
#ifndef PLUMB_MESH_H
#define PLUMB_MESH_H

#include "base/diagnostic.h"
#include "mesh_tree.h"
#include "plumb/scene.h"

/* ---- Edges, direction and components: mesh_edges.c ---- */

/* Fills neighbours[t][k] with the triangle on the other side of the edge of t from corner k to the
 * next. Reports an edge that is not of exactly two triangles at "triangles"[t].
 * O(n log n). */
bool pl_mesh_neighbours(const int (*triangles)[3], int triangle_count, int (*neighbours)[3],
                        pl_diagnostic *diagnostic);

/* Turns triangles so that all neighbours run along their common edge in opposite directions, the
 * lowest triangle of each component being left as it is. Reports a surface with one side.
 * Fills component[t] with the number of t's component, from 0 by lowest triangle. Also
 * fills *component_count. */
bool pl_mesh_orient(int (*triangles)[3], int triangle_count, const int (*neighbours)[3],
                    int *component, int *component_count, pl_diagnostic *diagnostic);

/* Whether each edge has two triangles that run along it in opposite directions; false also when out
 * of memory. */
bool pl_mesh_is_closed(const pl_polyhedron *polyhedron);

/* ---- Crossing: mesh_crossing.c ---- */

/* Reports at "triangles"[t] the first two triangles that cross: those that go through each
 * other, or lie in one plane, face the same way and overlap, by more than the tolerance.
 * Triangles with a common edge never do. The surface must be closed, each component of positive
 * volume. O(n log n) where triangles are small next to the whole; up to O(n^2) where the boxes
 * around them overlap, as those of a fan of very many do, but within pl_mesh_most_near. */
bool pl_mesh_check_crossing(const pl_mesh_tree *tree, int triangle_count,
                            pl_diagnostic *diagnostic);

/* ---- Nesting: mesh_nesting.c ---- */

/* The largest number of closed surfaces of a mesh. */
enum { PL_MAX_SURFACES = 4096 };

/* Turns each of `surface_count` components to its outer side, and reports one that encloses
 * no volume. surface[t] is the number of t's component, from 0 by lowest triangle. */
bool pl_mesh_turn_outward(const double (*vertices)[3], int (*triangles)[3], int triangle_count,
                          const int *surface, int surface_count, pl_diagnostic *diagnostic);

/* Of surfaces whose triangles do not cross: turns round those that lie within an odd number of
 * others. Reports surfaces that are partly in each other. `triangles` are those of the tree. */
bool pl_mesh_turn_cavities(const pl_mesh_tree *tree, int vertex_count, int (*triangles)[3],
                           int triangle_count, const int *surface, int surface_count,
                           pl_diagnostic *diagnostic);

#endif
