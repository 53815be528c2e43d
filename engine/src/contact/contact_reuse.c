/* Reuse of manifolds by relative pose.
 *
 * With x the position and q the orientation of the smaller body in the axes of the larger one, and
 * x0, q0 those at which the manifold was built, no point at a distance of at most r from the
 * smaller body's centre has moved by more than
 *
 *     |x - x0| + 2 r |q - q0|,
 *
 * because a turn by the angle t has |q - q0| = 2 sin(t/4) and moves it by 2 r sin(t/2). The pose at
 * building counts, not the last one: slow motion must not carry a manifold along for ever. */
#include "contact_reuse.h"

pe_relative pe_relative_pose(const pe_body *a, const pe_pose *pose_a, const pe_body *b,
                             const pe_pose *pose_b)
{
    double ra = a->bounding_radius, rb = b->bounding_radius;
    bool b_is_larger = rb == 0 || (ra > 0 && ra < rb);
    const pe_pose *large = b_is_larger ? pose_b : pose_a, *small = b_is_larger ? pose_a : pose_b;
    return (pe_relative){
        .position = pe_unrotate(&large->rotation, pe_sub(small->position, large->position)),
        .orientation = pe_quat_product(pe_quat_conjugate(large->orientation), small->orientation),
        .radius = b_is_larger ? ra : rb,
    };
}

static bool holds(const pe_built *built, const pe_relative *now, double distance, double margin)
{
    pe_vec3 dx = pe_sub(now->position, built->position);
    pe_quat q = now->orientation, p = built->orientation;
    double dw = q.w - p.w;
    pe_vec3 dv = pe_v3(q.x - p.x, q.y - p.y, q.z - p.z);
    double r = now->radius, shift2 = pe_dot(dx, dx), turn2 = dw * dw + pe_dot(dv, dv);
    /* (s + t)^2 <= 2 (s^2 + t^2) spares the roots. */
    return 2 * shift2 + 8 * r * r * turn2 < distance * distance && built->least_margin <= margin &&
           margin < built->end_margin;
}

bool pe_manifolds_hold(const pe_manifold *manifolds, int count, const pe_relative *now,
                       double distance, double margin)
{
    bool all = true;
    for (int i = 0; i < count && all; ++i) {
        all = holds(&manifolds[i].built, now, distance, margin);
    }
    return all;
}

pe_built pe_manifold_built(const pe_pair_manifold *hits, const pe_relative *now,
                           const pe_mat3 *rotation_a, const pe_mat3 *rotation_b)
{
    return (pe_built){
        .position = now->position,
        .orientation = now->orientation,
        .normal = pe_unrotate(hits->normal_on_b ? rotation_b : rotation_a, hits->normal),
        .least_margin = hits->least_margin,
        .end_margin = hits->end_margin,
        .normal_on_b = hits->normal_on_b,
    };
}

void pe_manifold_carry(pe_manifold *manifold, const pe_pose *a, const pe_pose *b,
                       const pe_manifold_point *old_points, pe_manifold_point *points)
{
    const pe_built *built = &manifold->built;
    pe_vec3 n = pe_rotate(built->normal_on_b ? &b->rotation : &a->rotation, built->normal);
    manifold->normal = n;
    manifold->least_separation = HUGE_VAL;
    for (int i = 0; i < manifold->count; ++i) {
        const pe_manifold_point *old = &old_points[i];
        pe_manifold_point *point = &points[i];
        pe_vec3 on_a = pe_add(a->position, pe_rotate(&a->rotation, old->anchor_a));
        pe_vec3 on_b = pe_add(b->position, pe_rotate(&b->rotation, old->anchor_b));
        point->position = pe_scale(0.5, pe_add(on_a, on_b));
        point->anchor_a = old->anchor_a;
        point->anchor_b = old->anchor_b;
        point->separation = pe_dot(n, pe_sub(on_b, on_a));
        manifold->least_separation = pe_min(manifold->least_separation, point->separation);
        point->feature = old->feature;
        point->impulse = old->impulse;
    }
}
