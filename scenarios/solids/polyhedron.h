/* Making polyhedra: from the hull of points, or from triangles that enclose a solid.
 *
 * Both report faults at "points"[i], "vertices"[i] or "triangles"[i], as the scene file has them. A
 * polyhedron made again from its own vertices and triangles is the same, bit for bit, so a scene
 * that is written and read does not change. */
#ifndef PLUMB_POLYHEDRON_H
#define PLUMB_POLYHEDRON_H

#include "base/diagnostic.h"
#include "base/exact.h"
#include "plumb/scene.h"

/* Beyond these sizes squares and cubes of lengths leave the range of doubles. */
#define PL_MAX_COORDINATE 1e50 /* m */
#define PL_MIN_THICKNESS 1e-50 /* m, volume over surface */

enum {
    PL_MAX_HULL_POINTS = 1 << 16, /* qhull takes seconds for thousands of corners in one plane */
    PL_MAX_VERTICES = 1 << 21,
    PL_MAX_TRIANGLES = 1 << 21,
};

/* Returns an unnamed polyhedron with space for so many vertices and triangles, all else zero; NULL
 * when out of memory. */
pl_polyhedron *pl_polyhedron_create(int vertex_count, int triangle_count);

/* Frees a polyhedron. NULL is allowed. */
void pl_polyhedron_free(pl_polyhedron *polyhedron);

/* Checks that `count` triples, the value of `key`, are finite and at most PL_MAX_COORDINATE. */
bool pl_polyhedron_check_points(const char *key, const double (*points)[3], int count,
                                pl_diagnostic *diagnostic);

/* Fills volume, centre, axes, inertia and radius from a closed surface. False, without a
 * diagnostic, when it encloses no volume beyond rounding, or a negative one, or is a million times
 * as long as wide. */
bool pl_polyhedron_measure(pl_polyhedron *polyhedron);

/* Sums over the triangles of a closed surface, without rounding: they do not depend on its order.
 * Begins as zeros. */
typedef struct pl_surface_sums {
    pl_exact_sum six_volumes; /* six times the volume */
    pl_exact_sum two_areas;   /* twice the area */
    double largest;           /* absolute coordinate, m */
} pl_surface_sums;

/* Adds a triangle. */
void pl_surface_add(pl_surface_sums *sums, const double (*vertices)[3], const int corner[3]);

/* Whether the magnitude of volume over surface is more than rounding of the coordinates. */
bool pl_surface_is_thick(const pl_surface_sums *sums);

/* The largest absolute coordinate. */
double pl_largest_coordinate(const double (*points)[3], int count);

/* Makes *polyhedron, which the caller frees, from the hull of points. False after a
 * diagnostic. */
bool pl_polyhedron_of_hull(const double (*points)[3], int count, pl_polyhedron **polyhedron,
                           pl_diagnostic *diagnostic);

/* Makes *polyhedron, which the caller frees, from a closed surface. False after a diagnostic. */
bool pl_polyhedron_of_mesh(const double (*vertices)[3], int vertex_count, const int (*triangles)[3],
                           int triangle_count, pl_polyhedron **polyhedron,
                           pl_diagnostic *diagnostic);

#endif
