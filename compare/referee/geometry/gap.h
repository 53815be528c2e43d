/* The distance between two shapes: the referee's own geometry, independent of every engine's.
 *
 * gap > 0: the shapes are apart by exactly this distance (two boxes: by at least this distance).
 * gap < 0: they overlap, and -gap is the penetration depth: for two convex shapes exactly the
 * length of the minimum translation vector, for a mesh see pl_gap_mesh. All gaps are in m. */
#ifndef PLUMB_GAP_H
#define PLUMB_GAP_H

#include "plumb/scene.h"
#include "surface.h"

/* A shape at a pose in the world. All pointers are borrowed. */
typedef struct pl_placed_shape {
    const pl_shape *shape;
    double position[3];    /* m, of the shape's frame */
    double orientation[4]; /* ignored for a plane */
    /* The shape's own surface, if the caller keeps one for many calls. Used if the shape is a mesh
     * or is measured against one. If it is NULL, pl_gap_mesh makes one for each call. */
    const pl_surface *surface;
} pl_placed_shape;

/* The gap of any pair. A gap above `within` is not computed: *gap is then some number above
 * `within`, which costs much less. INFINITY computes every gap. PL_UNSUPPORTED for two planes,
 * which have no gap; otherwise fails as the function below that it calls. */
pl_status pl_gap(const pl_placed_shape *a, const pl_placed_shape *b, double within, double *gap);

/* Closed forms: a plane with any bounded shape; a sphere with a sphere, box, capsule or cylinder;
 * two boxes; two capsules. PL_UNSUPPORTED for any other pair. */
pl_status pl_gap_closed_form(const pl_placed_shape *a, const pl_placed_shape *b, double *gap);

/* Any two bounded convex shapes: by GJK if they are apart, by EPA of libccd if they overlap. Two
 * boxes have their exact distance here. The result is at most the true gap, except for rounding,
 * and an upper bound is within 1e-7 of the sum of the bounding radii, typically 1e-12. With a
 * cylinder, the result is exact to about 1e-9 of that sum; of an overlap it is a local minimum over
 * all directions, and an upper bound within 3e-4 (mostly 1e-6) shows that no other minimum is much
 * lower. Allocates. PL_FAILED if the two bounds do not meet within the limit of iterations,
 * PL_UNSUPPORTED for a plane or a mesh. Source: van den Bergen 2003, ch. 4. */
pl_status pl_gap_convex(const pl_placed_shape *a, const pl_placed_shape *b, double within,
                        double *gap);

/* The distance of two bounded convex shapes as in pl_gap_convex; 0 if they overlap. A mesh counts
 * as its hull. Allocates nothing. */
double pl_distance_convex(const pl_placed_shape *a, const pl_placed_shape *b, double within);

/* A mesh and any bounded shape. Apart: the exact distance. Overlapping: minus the largest depth of
 *
 *   a vertex of either that is inside the other: its distance to the other's surface
 *   an edge segment of either that lies inside the other: the depth of its midpoint, or if it
 *     crosses under an edge of the other, the least translation that moves it out (see gap_mesh.c)
 *
 * Of convex solids with a small overlap this is the length of the minimum translation vector, for
 * all pairs of features (in rare poses at a sharp corner it is somewhat less). Otherwise it is the
 * depth to which one solid has locally penetrated the other. The vertices of a cylinder are its
 * farthest points against the faces that it crosses, and the depth of an edge in it is that of
 * convex shapes. Spheres and capsules are measured by their cores, and their radius is added.
 * Allocates. PL_FAILED as pl_gap_convex, with a cylinder only; PL_UNSUPPORTED without a mesh or with a
 * plane. */
pl_status pl_gap_mesh(const pl_placed_shape *a, const pl_placed_shape *b, double within,
                      double *gap);

#endif
