/* Distances to a mesh by brute force over all triangles. */
#ifndef PLUMB_TEST_MESH_TRUTH_H
#define PLUMB_TEST_MESH_TRUTH_H

#include "shape_pairs.h"

/* The distance of the two solids, b being a mesh, lies between; both are 0 if they overlap. */
typedef struct mesh_interval {
    double low, high; /* m: they differ by up to 1e-12 of the size, or more of a few cylinders */
} mesh_interval;

mesh_interval mesh_distance(const pair *p);

/* The distance of a point of the world from the surface of a polyhedron. */
double surface_distance(const placed *p, pe_vec3 x);

/* Whether the point is in the solid of a polyhedron, by its winding number (Van Oosterom and
 * Strackee 1983). */
bool is_in_polyhedron(const placed *p, pe_vec3 x);

#endif
