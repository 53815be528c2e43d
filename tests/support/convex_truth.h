/* The signed distance of two convex shapes, as a proven interval.
 *
 * With h the support functions and M = A - B the Minkowski difference,
 *
 *     signed distance = max over unit n of -f(n),    f(n) = h_A(n) + h_B(-n) = h_M(n):
 *
 * apart it is the distance, overlapping minus the least translation that separates, and n, from A
 * to B, is its direction (Cameron 1997). So every n proves a lower bound.
 *
 * The other side comes from branch and bound over directions. In the cone of three directions d_i,
 * and for any point p of M, f(n) >= p.n, and for unit n in the cone, which is the sum of c_i d_i
 * with c_i >= 0 and 1 <= sum c_i <= 1/rho (rho: distance of the origin from the plane of the d_i),
 *
 *     p.n >= v where v = min_i p.d_i >= 0, and p.n >= v/rho where v < 0.
 *
 * p is the best convex combination of the support points at the three d_i, that is the value of a
 * matrix game of 3 x 3. Cells are split where the bound is lowest until it meets the least f seen.
 * Apart, every point p of M proves another upper bound of the distance: |p|.
 *
 * Nothing here relies on features, simplices that hold the origin, or how well a triangle is
 * shaped: whatever p is chosen, the bound holds except for the rounding of sums of lengths. */
#ifndef PLUMB_TEST_CONVEX_TRUTH_H
#define PLUMB_TEST_CONVEX_TRUTH_H

#include "model/world.h"

/* A convex solid in its own axes: any but a plane. */
typedef struct truth_solid {
    const pe_shape *shape;
    const pe_vec3 *vertices; /* of a polyhedron, (vertex_count), m; else NULL */
    int vertex_count;
    const pe_pose *pose;
} truth_solid;

/* A - B: every shape is the sum of a centre, segments, discs, a ball and at most one hull. */
typedef struct truth_difference {
    pe_vec3 centre;
    double ball; /* radius, m */
    int segment_count, disc_count, hull_count;
    pe_vec3 segment[6]; /* half of each, m */
    pe_vec3 disc[2][2]; /* unit, across each other, in the plane of each */
    double disc_radius[2];
    struct {
        const pe_vec3 *vertices;
        int count;
        const pe_mat3 *rotation;
        double sign; /* -1: that of B */
    } hull[2];
} truth_difference;

truth_difference truth_subtract(truth_solid a, truth_solid b);

/* f(n), m; *point, when not NULL, is the supporting point of M without its ball. */
double truth_support(const truth_difference *m, pe_vec3 n, pe_vec3 *point);

typedef struct truth_distance {
    double low, high; /* m: the signed distance lies between */
    pe_vec3 normal;   /* unit, from A to B, with f(normal) = -low */
    int supports;     /* how many were evaluated */
} truth_distance;

/* Stops when high - low <= tolerance, in m, or after 10,000 supports. */
truth_distance truth_signed_distance(const truth_difference *m, double tolerance);

#endif
