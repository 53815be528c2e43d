/* The contact point that keeps a fast body's centre on its side.
 *
 * The points of a manifold hold what is near by velocities, to first order. A plate that meets a
 * wall with its edge at 200 m/s is stopped at that edge, and turns about it by radians within the
 * step: its centre flies on, and passes the wall. So where two convex bodies may approach each
 * other by more than half the radius of the smaller, its centre is held too: it may come no further
 * than the plane of the contact. */
#ifndef PE_CONTACT_CENTRE_H
#define PE_CONTACT_CENTRE_H

#include "narrow_phase/collide.h"

/* Adds that point to the patch of two convex bodies at this margin, or notes at which margins it
 * would be there. */
void pe_pair_manifold_hold_centre(pe_pair_manifold *hits, const pe_body *a, const pe_pose *pose_a,
                                  const pe_body *b, const pe_pose *pose_b, double margin);

#endif
