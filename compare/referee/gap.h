/* The distance between two shapes: the referee's own geometry, independent of every engine's.
 *
 * gap > 0: the shapes are apart by at least this much (a lower bound of the distance for box-box
 * and for box-plane exact; exact otherwise). gap < 0: they overlap, and -gap is the exact
 * penetration depth, the least translation that separates them. m. */
#ifndef PLUMB_GAP_H
#define PLUMB_GAP_H

#include "plumb/scene.h"

typedef struct pl_placed_shape {
    const pl_shape *shape;
    double position[3];
    double orientation[4]; /* ignored for a plane */
} pl_placed_shape;

/* Closed forms for plane, sphere and box; PL_UNSUPPORTED for a pair that has none (plane-plane,
 * whose gap has no meaning here). */
pl_status pl_gap_closed_form(const pl_placed_shape *a, const pl_placed_shape *b, double *gap);

/* The same number for any pair of bounded convex shapes by libccd (GJK/EPA; box-box apart: the
 * exact distance), and for a convex shape against a plane by its support point. Never more than the
 * true gap but for rounding, and within 1e-7 of the sum of the bounding radii of libccd's own bound
 * from the other side; typically 1e-12. Allocates. PL_FAILED when the two bounds do not meet within
 * its limit of iterations, PL_NO_MEMORY. Source: van den Bergen 2003, ch. 4. */
pl_status pl_gap_convex(const pl_placed_shape *a, const pl_placed_shape *b, double *gap);

/* The closed form where there is one, libccd otherwise. */
pl_status pl_gap(const pl_placed_shape *a, const pl_placed_shape *b, double *gap);

#endif
