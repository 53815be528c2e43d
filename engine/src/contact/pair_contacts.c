/* Manifolds are reused by relative pose. With x the position and q the orientation of the smaller
 * body in the axes of the larger one, and x0, q0 those at which the manifold was built, no point at
 * a distance of at most r from the smaller body's centre has moved by more than
 *
 *     |x - x0| + 2 r |q - q0|,
 *
 * because a rotation by the angle t has |q - q0| = 2 sin(t/4) and moves it by 2 r sin(t/2). The
 * pose at building counts, not the last one: slow motion must not transport a manifold for ever. */
#include "pair_contacts.h"

#include "contact_points.h"
#include "model/ranges.h"
#include "passing.h"

#include <string.h>

/* Two points of a pair nearer than this, in m per metre of the smaller body, may be the same point
 * whose features were renamed. */
static const double MATCH_DISTANCE = 0.02;

/* Cosine of the angle up to which two manifolds face the same way. */
static const double SAME_DIRECTION = 0.9;

/* m: islands that are solved directly keep no more than this (correct_islands.c). */
static const double EXACT_DEPTH = 1e-8;

/* A pair of bodies under examination. */
typedef struct examined {
    pe_pair pair;
    const pe_body *a, *b;
    const pe_pose *pose_a, *pose_b;
    double size;            /* m, of the smaller body; a plane has none */
    double margin;          /* m */
    const pe_manifold *old; /* (old_count): its old manifolds */
    int old_count, old_point_count;
    const pe_manifold_point *old_points; /* (old_point_count): of all of them */

    /* Of the smaller body in the axes of the larger. A plane is larger than anything; of two equal
     * bodies b counts as the smaller. */
    pe_vec3 position;
    pe_quat orientation;
    double radius; /* bounding, of the smaller one */
} examined;

/* ---- The new list ---- */

/* Makes room for one manifold more with `count` points. */
static pe_status reserve(pe_search *s, int count)
{
    pe_contacts *found = s->found;
    size_t manifolds = (size_t)found->manifold_count, points = (size_t)found->point_count;
    pe_status status = pe_array_reserve(&found->manifold_array, &s->world->allocator,
                                        sizeof(pe_manifold), manifolds + 1, manifolds, s->error);
    if (status == PE_OK) {
        status =
            pe_array_reserve(&found->point_array, &s->world->allocator, sizeof(pe_manifold_point),
                             points + (size_t)count, points, s->error);
    }
    return status;
}

/* Appends a manifold of the pair with `count` points, which are to be filled. */
static pe_status append(pe_search *s, const examined *e, int count, pe_manifold **manifold)
{
    pe_status status = reserve(s, count);
    if (status == PE_OK) {
        const pe_material_pair *material =
            pe_material_pair_of(s->world, e->a->material, e->b->material);
        pe_manifold *m = &pe_manifolds(s->found)[s->found->manifold_count++];
        m->a = e->pair.a;
        m->b = e->pair.b;
        m->first = s->found->point_count;
        m->count = count;
        m->friction = material->friction;
        m->restitution = material->restitution;
        s->found->point_count += count;
        *manifold = m;
    }
    return status;
}

pe_status pe_copy_unmoved(pe_search *s, const bool *moved, pe_pair until)
{
    const pe_manifold *old = pe_manifolds(s->old);
    for (; s->next < s->old->manifold_count && pe_precedes_pair(&old[s->next], until); ++s->next) {
        const pe_manifold *from = &old[s->next];
        if (pe_looks_at(moved, from->a, from->b)) {
            continue;
        }
        pe_status status = reserve(s, from->count);
        if (status != PE_OK) {
            return status;
        }
        pe_manifold *m = &pe_manifolds(s->found)[s->found->manifold_count++];
        *m = *from;
        m->first = s->found->point_count;
        memcpy(pe_manifold_points(s->found) + m->first, pe_manifold_points(s->old) + from->first,
               (size_t)from->count * sizeof(pe_manifold_point));
        s->found->point_count += from->count;
    }
    return PE_OK;
}

/* ---- Manifolds that are kept ---- */

/* Notes how the pair lies, for a manifold made just now. */
static pe_built built_now(const examined *e, const pe_pair_manifold *manifold)
{
    const pe_pose *owner = manifold->normal_on_b ? e->pose_b : e->pose_a;
    return (pe_built){
        .position = e->position,
        .orientation = e->orientation,
        .normal = pe_unrotate(&owner->rotation, manifold->normal),
        .least_margin = manifold->least_margin,
        .end_margin = manifold->end_margin,
        .normal_on_b = manifold->normal_on_b,
    };
}

/* Whether no point of either body has moved relative to the other by `distance` or more since then,
 * and the margin asks for the same points. */
static bool still_holds(const pe_built *built, const examined *e, double distance)
{
    pe_vec3 dx = pe_sub(e->position, built->position);
    pe_quat q = e->orientation, p = built->orientation;
    double dw = q.w - p.w;
    pe_vec3 dv = pe_v3(q.x - p.x, q.y - p.y, q.z - p.z);
    double r = e->radius, shift2 = pe_dot(dx, dx), turn2 = dw * dw + pe_dot(dv, dv);
    /* (s + t)^2 <= 2 (s^2 + t^2) spares the roots. */
    return 2 * shift2 + 8 * r * r * turn2 < distance * distance &&
           built->least_margin <= e->margin && e->margin < built->end_margin;
}

static bool can_reuse(const pe_search *s, const examined *e)
{
    for (int i = 0; i < e->old_count; ++i) {
        if (e->old[i].count > s->rules->most_points ||
            !still_holds(&e->old[i].built, e, s->rules->reuse_tolerance * e->size)) {
            return false;
        }
    }
    return e->old_count > 0;
}

/* Fills the manifold's normal and its points from the old ones, moved along with the bodies: the
 * normal rotates with the body that it belongs to, position and separation are those of the two
 * surface points, and the rest stays. `built` and `count` are set already. */
static void transport(const examined *e, pe_manifold *manifold, const pe_manifold_point *old_points,
                      pe_manifold_point *points)
{
    const pe_pose *a = e->pose_a, *b = e->pose_b;
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

/* Appends the pair's old manifolds, transported by the bodies. */
static pe_status reuse_pair(pe_search *s, const examined *e)
{
    pe_status status = PE_OK;
    for (int i = 0; i < e->old_count && status == PE_OK; ++i) {
        const pe_manifold *old = &e->old[i];
        pe_manifold *m;
        status = append(s, e, old->count, &m);
        if (status == PE_OK) {
            m->kept = true;
            m->apart = false;
            m->built = old->built;
            transport(e, m, pe_manifold_points(s->old) + old->first,
                      pe_manifold_points(s->found) + m->first);
        }
    }
    return status;
}

/* ---- New manifolds ---- */

/* Which old points of a pair have given their impulse away. */
typedef struct taken_points {
    bool is_taken[PE_MAX_MANIFOLDS * PE_MAX_POINTS];
} taken_points;

static void inherit(const examined *e, int old, pe_vec3 normal, pe_manifold_point *point,
                    taken_points *taken)
{
    pe_vec3 impulse = e->old_points[old].impulse;
    point->impulse = pe_dot(impulse, normal) > 0 ? impulse : pe_v3(0, 0, 0);
    taken->is_taken[old] = true;
}

/* The impulse of the nearest old point that is left in a manifold that faces the same way. */
static void match_nearest(const examined *e, pe_vec3 normal, pe_manifold_point *point,
                          taken_points *taken)
{
    int nearest = -1;
    double reach = MATCH_DISTANCE * e->size, least = reach * reach;
    for (int i = 0; i < e->old_count; ++i) {
        int first = e->old[i].first - e->old[0].first;
        if (pe_dot(e->old[i].normal, normal) < SAME_DIRECTION) {
            continue;
        }
        for (int j = first; j < first + e->old[i].count; ++j) {
            pe_vec3 d = pe_sub(point->anchor_a, e->old_points[j].anchor_a);
            if (!taken->is_taken[j] && pe_dot(d, d) < least) {
                least = pe_dot(d, d);
                nearest = j;
            }
        }
    }
    if (nearest >= 0) {
        inherit(e, nearest, normal, point, taken);
    }
}

/* Gives each point of a new manifold the impulse of the old point of the pair on the same features,
 * or else of the nearest one; none: 0. */
static void match_points(const examined *e, const pe_manifold *m, pe_manifold_point *points,
                         taken_points *taken)
{
    unsigned unmatched = 0; /* bit set of new points */
    for (int i = 0; i < m->count; ++i) {
        int j = i; /* mostly the same index */
        if (i >= e->old_point_count || e->old_points[i].feature != points[i].feature) {
            for (j = 0; j < e->old_point_count && e->old_points[j].feature != points[i].feature;) {
                ++j;
            }
        }
        if (j < e->old_point_count && !taken->is_taken[j]) {
            inherit(e, j, m->normal, &points[i], taken);
        } else {
            unmatched |= 1u << i;
        }
    }
    for (int i = 0; unmatched >> i != 0; ++i) {
        if (unmatched >> i & 1) {
            match_nearest(e, m->normal, &points[i], taken);
        }
    }
}

static void place_point(const examined *e, const pe_pair_point *from, pe_vec3 normal,
                        pe_manifold_point *point)
{
    const pe_pose *a = e->pose_a, *b = e->pose_b;
    pe_vec3 half_gap = pe_scale(0.5 * from->separation, normal);
    pe_vec3 on_a = pe_sub(from->position, half_gap), on_b = pe_add(from->position, half_gap);
    point->position = from->position;
    point->anchor_a = pe_unrotate(&a->rotation, pe_sub(on_a, a->position));
    point->anchor_b = pe_unrotate(&b->rotation, pe_sub(on_b, b->position));
    point->separation = from->separation;
    point->feature = from->feature;
    point->impulse = pe_v3(0, 0, 0);
}

/* Appends the manifolds that the narrow phase has found, with the impulses of the old ones. */
static pe_status build_pair(pe_search *s, const examined *e, const pe_pair_manifold *manifolds,
                            int count)
{
    taken_points taken;
    memset(taken.is_taken, 0, (size_t)e->old_point_count * sizeof *taken.is_taken);
    for (int i = 0; i < count; ++i) {
        const pe_pair_manifold *from = &manifolds[i];
        pe_manifold *m;
        pe_status status = append(s, e, from->count, &m);
        if (status != PE_OK) {
            return status;
        }
        pe_manifold_point *points = pe_manifold_points(s->found) + m->first;
        m->kept = m->apart = false;
        m->normal = from->normal;
        m->built = built_now(e, from);
        m->least_separation = HUGE_VAL;
        for (int k = 0; k < from->count; ++k) {
            place_point(e, &from->item[k], from->normal, &points[k]);
            m->least_separation = pe_min(m->least_separation, from->item[k].separation);
        }
        if (e->old_count > 0) {
            match_points(e, m, points, &taken);
        }
    }
    return PE_OK;
}

/* ---- Pairs ---- */

/* Looks up the pair's old manifolds. Pairs come in order, so that one walk finds them all. */
static void find_old(pe_search *s, examined *e)
{
    const pe_manifold *old = pe_manifolds(s->old);
    int end = s->old->manifold_count;
    while (s->next < end && pe_precedes_pair(&old[s->next], e->pair)) {
        ++s->next;
    }
    if (s->next == end) {
        return;
    }
    e->old = &old[s->next];
    for (; s->next < end && old[s->next].a == e->pair.a && old[s->next].b == e->pair.b; ++s->next) {
        e->old_count += 1;
        e->old_point_count += old[s->next].count;
    }
    if (e->old_count > 0) {
        e->old_points = pe_manifold_points(s->old) + e->old[0].first;
    }
}

static void examine(pe_search *s, pe_pair pair, examined *e)
{
    const pe_world *world = s->world;
    const pe_body *a = &pe_bodies(world)[pair.a], *b = &pe_bodies(world)[pair.b];
    const pe_pose *pose_a = &pe_poses(world)[pair.a], *pose_b = &pe_poses(world)[pair.b];
    pe_vec3 closing = pe_sub(pe_twists(world)[pair.a].velocity, pe_twists(world)[pair.b].velocity);
    double spin = s->spin[pair.a] + s->spin[pair.b];
    double ra = a->bounding_radius, rb = b->bounding_radius;
    bool b_is_larger = rb == 0 || (ra > 0 && ra < rb), both = a->size > 0 && b->size > 0;
    const pe_pose *large = b_is_larger ? pose_b : pose_a, *small = b_is_larger ? pose_a : pose_b;
    *e = (examined){
        .pair = pair,
        .a = a,
        .b = b,
        .pose_a = pose_a,
        .pose_b = pose_b,
        .size = both ? pe_min(a->size, b->size) : pe_max(a->size, b->size),
        .margin = pe_min(s->dt * (pe_length(closing) + spin) + s->slack, PE_MOST_MARGIN),
        .position = pe_unrotate(&large->rotation, pe_sub(small->position, large->position)),
        .orientation = pe_quat_product(pe_quat_conjugate(large->orientation), small->orientation),
        .radius = b_is_larger ? ra : rb,
    };
    find_old(s, e);
}

static bool is_convex(const pe_body *b)
{
    return b->shape.kind != PE_SHAPE_MESH || b->geometry->convex;
}

static pe_placed placed(const pe_world *world, int slot)
{
    const pe_body *body = &pe_bodies(world)[slot];
    return (pe_placed){&body->shape, body->geometry, &pe_poses(world)[slot], body->size};
}

static pe_status no_memory(pe_error *error)
{
    return pe_fail(error, PE_NO_MEMORY, "no memory for the contacts of two meshes");
}

static pe_status collide(pe_world *world, pe_pair pair, double margin, pe_pair_manifold *manifolds,
                         int *count, pe_error *error)
{
    pe_workspace work = pe_step_memory(world);
    pe_arena_mark mark = pe_arena_fill(work.arena);
    *count = pe_collide(placed(world, pair.a), placed(world, pair.b), margin, work, manifolds);
    pe_arena_rewind(work.arena, work.allocator, mark);
    return *count >= 0 ? PE_OK : no_memory(error);
}

/* Whether the last step may have let the body sink in: soft contacts sag, and an island that is not
 * solved to the tolerance lets its bodies move on. */
static bool may_sag(const pe_world *world, int slot)
{
    return world->def.profile == PE_PROFILE_FAST ||
           pe_records(world)[slot].residual > world->def.tolerance;
}

/* Lets the pair pass if it would collide at the poses now but not in its motion. */
static pe_status let_pass(pe_search *s, const examined *e, pe_pair_manifold *manifolds, int *count)
{
    pe_world *world = s->world;
    const pe_pair pair = e->pair;
    const double depth =
        pe_max(e->a->is_static ? 0 : s->depth[pair.a], e->b->is_static ? 0 : s->depth[pair.b]);
    const bool sags = depth > EXACT_DEPTH || may_sag(world, pair.a) || may_sag(world, pair.b);
    const pe_approach approach = {
        .a = placed(world, pair.a),
        .b = placed(world, pair.b),
        .of_a = pe_twists(world)[pair.a],
        .of_b = pe_twists(world)[pair.b],
        .old = e->old,
        .old_points = pe_manifold_points(s->old),
        .old_count = e->old_count,
        .dt = s->dt,
        .fall = s->dt * s->dt * pe_length(world->def.gravity),
        .margin = e->margin,
        .depth = depth + (sags ? world->def.penetration_slop : 0),
    };
    pe_workspace work = pe_step_memory(world);
    pe_arena_mark mark = pe_arena_fill(work.arena);
    const bool has_memory = pe_pass(&approach, work, manifolds, count);
    pe_arena_rewind(work.arena, work.allocator, mark);
    return has_memory ? PE_OK : no_memory(s->error);
}

pe_status pe_pair_overlap(pe_world *world, int a, int b, double *depth, pe_error *error)
{
    pe_pair_manifold manifolds[PE_MAX_MANIFOLDS];
    int count;
    pe_status status = collide(world, (pe_pair){a, b}, 0, manifolds, &count, error);
    *depth = 0;
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j < manifolds[i].count; ++j) {
            *depth = pe_max(*depth, -manifolds[i].item[j].separation);
        }
    }
    return status;
}

/* Appends new manifolds of the pair, as the narrow phase finds them. */
static pe_status collide_pair(pe_search *s, const examined *e)
{
    pe_pair_manifold manifolds[PE_MAX_MANIFOLDS];
    int count;
    pe_status status = collide(s->world, e->pair, e->margin, manifolds, &count, s->error);
    if (status == PE_OK && count > 0) {
        status = let_pass(s, e, manifolds, &count);
    }
    if (status != PE_OK) {
        return status;
    }
    for (int i = 0; i < count; ++i) {
        if (manifolds[i].count > s->rules->most_points) {
            pe_pair_manifold_reduce(&manifolds[i], e->size);
        }
    }
    if (count > 0 && is_convex(e->a) && is_convex(e->b)) {
        pe_pair_manifold_hold_centre(&manifolds[0], e->a, e->pose_a, e->b, e->pose_b, e->margin);
    }
    return build_pair(s, e, manifolds, count);
}

pe_status pe_find_pair(pe_search *s, pe_pair pair)
{
    examined e;
    examine(s, pair, &e);
    return can_reuse(s, &e) ? reuse_pair(s, &e) : collide_pair(s, &e);
}
