/* A triangle in a form that does not depend on how a mesh numbers its vertices: what is computed of
 * it, or of two of them, has the same bits for every order of vertices and triangles. */
#ifndef PLUMB_MESH_TRIANGLE_H
#define PLUMB_MESH_TRIANGLE_H

#include "plumb/vec.h"

#include <float.h>
#include <stdbool.h>
#include <stddef.h>

/* A triangle, its corners by x, then y, then z. */
typedef struct pl_mesh_triangle {
    const double *corner[3]; /* borrowed */
    double facing; /* 1: it faces the side from which the corners are counter-clockwise; -1 */
} pl_mesh_triangle;

/* -1, 0 or 1: by x, then y, then z. */
static inline int pl_compare_places(const double a[3], const double b[3])
{
    for (int k = 0; k < 3; ++k) {
        if (a[k] != b[k]) {
            return a[k] < b[k] ? -1 : 1;
        }
    }
    return 0;
}

static inline pl_mesh_triangle pl_mesh_triangle_of(const double (*vertices)[3], const int corner[3])
{
    pl_mesh_triangle made = {{vertices[corner[0]], vertices[corner[1]], vertices[corner[2]]}, 1};
    for (int i = 0; i < 3; ++i) {
        const int left = i % 2; /* 0 1, then 1 2, then 0 1 */
        const double *first = made.corner[left], *second = made.corner[left + 1];
        if (pl_compare_places(first, second) > 0) {
            made.corner[left] = second;
            made.corner[left + 1] = first;
            made.facing = -made.facing;
        }
    }
    return made;
}

/* The vector from corner i to corner k. */
static inline pl_vec pl_mesh_edge(const pl_mesh_triangle *t, int i, int k)
{
    return pl_vec_sub(pl_vec_of(t->corner[k]), pl_vec_of(t->corner[i]));
}

/* The direction that the triangle faces, of the length of twice its area. */
static inline pl_vec pl_mesh_normal(const pl_mesh_triangle *t)
{
    const pl_vec normal = pl_vec_cross(pl_mesh_edge(t, 0, 1), pl_mesh_edge(t, 0, 2));
    return pl_vec_scale(normal, t->facing);
}

/* Whether the triangle's height on its longest side is more than the rounding of its corners. */
static inline bool pl_mesh_has_area(const double (*vertices)[3], const int corner[3])
{
    const pl_mesh_triangle t = pl_mesh_triangle_of(vertices, corner);
    double largest = 0, longest = 0;
    for (int k = 0; k < 3; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
            largest = fmax(largest, fabs(t.corner[k][axis]));
        }
        longest = fmax(longest, pl_vec_length(pl_mesh_edge(&t, k, (k + 1) % 3)));
    }
    return pl_vec_length(pl_mesh_normal(&t)) > 4 * DBL_EPSILON * largest * longest;
}

#endif
