/* The signed distance of spheres, capsules, boxes and hulls by brute force, without simplices, arcs
 * or bounds. Apart, the distance is the least over all vertices and faces and all pairs of edges;
 * overlapping, the depth is the least overlap over all normals of faces and crosses of edges, each
 * over all vertices. */
#ifndef PLUMB_TEST_POLYTOPE_TRUTH_H
#define PLUMB_TEST_POLYTOPE_TRUTH_H

#include "placed_shape.h"

enum { MOST_CORE_VERTICES = 160 };

/* The core in the world, and the radius of the ball that sweeps it. */
typedef struct polytope_core {
    int vertex_count, edge_count, face_count;
    pe_vec3 vertices[MOST_CORE_VERTICES];
    int edges[2 * MOST_CORE_VERTICES][2];
    struct {
        pe_vec3 normal;
        int count, corners[MOST_CORE_VERTICES];
    } faces[MOST_CORE_VERTICES];
    double radius;
} polytope_core;

/* In the world. */
void polytope_core_of(const placed_shape *b, polytope_core *c);

/* The extent along a unit direction, without its ball. */
double core_farthest(const polytope_core *c, pe_vec3 d);

/* The gap of the shapes along a unit direction from a to b. */
double core_gap_along(const polytope_core *a, const polytope_core *b, pe_vec3 d);

/* The signed distance. */
double core_gap(const polytope_core *a, const polytope_core *b);

/* The distance (m) of x outside the shape; negative inside. */
double core_outside(const polytope_core *c, pe_vec3 x);

#endif
