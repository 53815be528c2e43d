/* The distance between two shapes: the referee's own geometry, independent of every engine's.
 *
 * gap > 0: the shapes are apart, by exactly this much (two boxes: by at least this much, a lower
 * bound). gap < 0: they overlap, and -gap is the penetration depth. Of two convex shapes that is
 * the least translation that separates them, exactly; where a mesh takes part see pl_gap_mesh. m.
 */
#ifndef PLUMB_GAP_H
#define PLUMB_GAP_H

#include "plumb/scene.h"
#include "surface.h"

typedef struct pl_placed_shape {
    const pl_shape *shape;
    double position[3];    /* of the shape's frame */
    double orientation[4]; /* ignored for a plane */
    /* The shape's own, kept by the caller over many questions, where it is to be measured against a
     * mesh or is one. NULL: pl_gap_mesh makes one for the time of the call. */
    const pl_surface *surface;
} pl_placed_shape;

/* Of any pair. A gap above `within` is only said to be so: *gap is then some number above it, which
 * costs far less. INFINITY asks for all. PL_UNSUPPORTED for two planes, whose gap has no meaning
 * here; else as the function below that it asks. */
pl_status pl_gap(const pl_placed_shape *a, const pl_placed_shape *b, double within, double *gap);

/* Closed forms: a plane with any bounded shape; a sphere with a sphere, box, capsule or cylinder;
 * two boxes; two capsules. PL_UNSUPPORTED for a pair that has none. */
pl_status pl_gap_closed_form(const pl_placed_shape *a, const pl_placed_shape *b, double *gap);

/* Any two bounded convex shapes, by GJK where they are apart and libccd's EPA where they overlap
 * (two boxes apart: the exact distance). Never more than the true gap but for rounding, and within
 * 1e-7 of the sum of the bounding radii of a bound from the other side; typically 1e-12. With a
 * cylinder the gap is exact to about 1e-9 of that sum. Where it overlaps it is so as a local
 * minimum over all directions, and the bound from the other side, within 3e-4 (mostly 1e-6), says
 * that no other is lower by more. Allocates. PL_FAILED when the two bounds do not meet within its
 * limit of iterations, PL_NO_MEMORY, PL_UNSUPPORTED for a plane or a mesh. Source: van den Bergen
 * 2003, ch. 4. */
pl_status pl_gap_convex(const pl_placed_shape *a, const pl_placed_shape *b, double within,
                        double *gap);

/* The distance of two bounded convex shapes as pl_gap_convex finds it, 0 where they overlap. A mesh
 * counts as its hull. Allocates nothing. */
double pl_distance_convex(const pl_placed_shape *a, const pl_placed_shape *b, double within);

/* A mesh and any bounded shape. Apart: the exact distance. Overlapping: minus the largest depth of
 *
 *   a vertex of either that is inside the other: its distance to the other's surface
 *   a stretch of an edge of either that runs inside the other: the depth of its middle, or where it
 *   crosses under an edge of the other, the least translation that takes it out (stretch.h)
 *
 * which for convex solids that overlap a little, in whatever features, is their least separating
 * translation (in the odd pose at a sharp corner somewhat less), and else the depth to which one
 * has locally sunk into the other. A cylinder's vertices are the points of it farthest against the
 * faces that it crosses, and an edge in it has its own depth as a convex shape. A sphere and a
 * capsule are measured by their cores, and their radius is added. Allocates. PL_NO_MEMORY;
 * PL_FAILED as pl_gap_convex, with a cylinder alone; PL_UNSUPPORTED without a mesh or with a plane.
 */
pl_status pl_gap_mesh(const pl_placed_shape *a, const pl_placed_shape *b, double within,
                      double *gap);

#endif
