/* Manifolds that outlive a step: when one still holds, and where its points are now. */
#ifndef PE_CONTACT_REUSE_H
#define PE_CONTACT_REUSE_H

#include "narrow_phase/collide.h"

/* How two bodies lie relative to each other: the smaller one in the axes of the larger. A plane is
 * larger than anything; of two equal bodies b counts as the smaller. */
typedef struct pe_relative {
    pe_vec3 position;
    pe_quat orientation;
    double radius; /* bounding, of the smaller one */
} pe_relative;

pe_relative pe_relative_pose(const pe_body *a, const pe_pose *pose_a, const pe_body *b,
                             const pe_pose *pose_b);

/* Whether no point of either body has moved relative to the other by `distance` or more since these
 * manifolds of one pair (count of them) were built, and `margin` asks for the same points. */
bool pe_manifolds_hold(const pe_manifold *manifolds, int count, const pe_relative *now,
                       double distance, double margin);

/* Notes how the pair lies for a manifold made of `hits` just now. */
pe_built pe_manifold_built(const pe_pair_manifold *hits, const pe_relative *now,
                           const pe_mat3 *rotation_a, const pe_mat3 *rotation_b);

/* Fills the manifold's normal and its points (`count` of them) from the old ones, moved along with
 * the bodies: the normal turns with the body that it belongs to, position and separation are those
 * of the two surface points, and the rest stays. `built` and `count` are set already. */
void pe_manifold_carry(pe_manifold *manifold, const pe_pose *a, const pe_pose *b,
                       const pe_manifold_point *old_points, pe_manifold_point *points);

#endif
