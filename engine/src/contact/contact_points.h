/* Which points of a new manifold are kept, and the point that is added for fast bodies. */
#ifndef PE_CONTACT_POINTS_H
#define PE_CONTACT_POINTS_H

#include "narrow_phase/collide.h"

/* Keeps 4 of the points: a deepest one, the one farthest from it, and those that widen the polygon
 * most on either side of the line between the two. Depths and widths that differ by less than
 * rounding and rocking at rest (1e-5 of `size`, the smaller body's, in m) tie, and ties go to the
 * lower feature, so that the choice does not flip from step to step. Fewer than 4 remain when the
 * points lie on one line. The points are then sorted by feature. */
void pe_pair_manifold_reduce(pe_pair_manifold *manifold, double size);

/* Adds a point that keeps a fast body's centre on its side of the contact, to the manifold of two
 * convex bodies at this margin, in m, or notes at which margins the point would be there.
 *
 * The points of a manifold predict gaps by velocities, to first order. A plate that meets a wall
 * with its edge at 200 m/s stops at that edge and turns about it by radians within the step: its
 * centre moves on, through the wall. So where two convex bodies may approach each other by more
 * than half the radius of the smaller, its centre may come no further than the plane of the
 * contact. */
void pe_pair_manifold_hold_centre(pe_pair_manifold *manifold, const pe_body *a,
                                  const pe_pose *pose_a, const pe_body *b, const pe_pose *pose_b,
                                  double margin);

#endif
