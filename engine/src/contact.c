#include "contact.h"

#include "collide.h"

/* Two points of a pair nearer than this, in m per metre of the smaller body, may be the same point
 * whose features were renamed. */
static const double MATCH_DISTANCE = 0.02;

static pe_status add_manifold(pe_world *world, pe_contacts *contacts, pe_pair pair,
                              const pe_hits *hits, pe_error *error)
{
    size_t manifolds = (size_t)contacts->manifold_count, points = (size_t)contacts->point_count;
    pe_status status = pe_array_reserve(&contacts->manifold_array, &world->allocator,
                                        sizeof(pe_manifold), manifolds + 1, manifolds, error);
    if (status == PE_OK) {
        status = pe_array_reserve(&contacts->point_array, &world->allocator, sizeof(pe_point),
                                  points + (size_t)hits->count, points, error);
    }
    if (status != PE_OK) {
        return status;
    }
    const pe_body *a = &pe_bodies(world)[pair.a], *b = &pe_bodies(world)[pair.b];
    const pe_pose *pose_a = &pe_poses(world)[pair.a], *pose_b = &pe_poses(world)[pair.b];
    const pe_surface *surface = pe_surface_of(world, a->material, b->material);
    pe_manifolds(contacts)[manifolds] = (pe_manifold){
        .a = pair.a,
        .b = pair.b,
        .normal = hits->normal,
        .first = contacts->point_count,
        .count = hits->count,
        .friction = surface->friction,
        .restitution = surface->restitution,
    };
    for (int i = 0; i < hits->count; ++i) {
        const pe_hit *hit = &hits->item[i];
        pe_vec3 half_gap = pe_scale(0.5 * hit->separation, hits->normal);
        pe_vec3 on_a = pe_sub(hit->position, half_gap), on_b = pe_add(hit->position, half_gap);
        pe_points(contacts)[points + (size_t)i] = (pe_point){
            .position = hit->position,
            .anchor_a = pe_unrotate(&pose_a->rotation, pe_sub(on_a, pose_a->position)),
            .anchor_b = pe_unrotate(&pose_b->rotation, pe_sub(on_b, pose_b->position)),
            .separation = hit->separation,
            .feature = hit->feature,
        };
    }
    contacts->manifold_count += 1;
    contacts->point_count += hits->count;
    return PE_OK;
}

pe_status pe_contacts_find(pe_world *world, const pe_pair *pairs, int count, double dt,
                           pe_error *error)
{
    const pe_body *bodies = pe_bodies(world);
    const pe_pose *poses = pe_poses(world);
    pe_contacts *found = &world->previous; /* its contents are two steps old: free to fill */
    found->manifold_count = found->point_count = 0;
    for (int i = 0; i < count; ++i) {
        int a = pairs[i].a, b = pairs[i].b;
        pe_hits hits;
        pe_collide((pe_placed){&bodies[a].shape, &poses[a], bodies[a].size},
                   (pe_placed){&bodies[b].shape, &poses[b], bodies[b].size},
                   pe_pair_margin(world, a, b, dt), &hits);
        if (hits.count > 0) {
            pe_status status = add_manifold(world, found, pairs[i], &hits, error);
            if (status != PE_OK) {
                return status;
            }
        }
    }
    pe_contacts swapped = world->contacts;
    world->contacts = *found;
    world->previous = swapped;
    return PE_OK;
}

/* Gives `point` the impulse of `old`, turned into the new contact's cone: what pulls is dropped. */
static void inherit(pe_point *point, const pe_point *old, pe_vec3 normal, double scale)
{
    pe_vec3 impulse = pe_scale(scale, old->impulse);
    point->impulse = pe_dot(impulse, normal) > 0 ? impulse : pe_v3(0, 0, 0);
}

static void match_points(const pe_manifold *now, pe_point *points, const pe_manifold *then,
                         const pe_point *old_points, double scale, double reach)
{
    unsigned used = 0, matched = 0; /* bit sets of old and new points */
    for (int i = 0; i < now->count; ++i) {
        for (int j = 0; j < then->count; ++j) {
            if (!(used >> j & 1) && points[i].feature == old_points[j].feature) {
                inherit(&points[i], &old_points[j], now->normal, scale);
                used |= 1u << j;
                matched |= 1u << i;
                break;
            }
        }
    }
    for (int i = 0; i < now->count; ++i) {
        int nearest = -1;
        double least = reach * reach;
        for (int j = 0; j < then->count && !(matched >> i & 1); ++j) {
            pe_vec3 d = pe_sub(points[i].anchor_a, old_points[j].anchor_a);
            if (!(used >> j & 1) && pe_dot(d, d) < least) {
                least = pe_dot(d, d);
                nearest = j;
            }
        }
        if (nearest >= 0) {
            inherit(&points[i], &old_points[nearest], now->normal, scale);
            used |= 1u << nearest;
        }
    }
}

void pe_contacts_match(pe_world *world, double dt)
{
    const pe_contacts *now = &world->contacts, *then = &world->previous;
    double scale = world->previous_dt > 0 ? dt / world->previous_dt : 1;
    int j = 0;
    for (int i = 0; i < now->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(now)[i];
        /* Both are sorted by (a, b): one walk finds the pairs they share. */
        const pe_manifold *old = pe_manifolds(then);
        while (j < then->manifold_count &&
               (old[j].a < m->a || (old[j].a == m->a && old[j].b < m->b))) {
            ++j;
        }
        if (j < then->manifold_count && old[j].a == m->a && old[j].b == m->b) {
            const pe_body *a = &pe_bodies(world)[m->a], *b = &pe_bodies(world)[m->b];
            double size =
                a->size > 0 ? (b->size > 0 ? pe_min(a->size, b->size) : a->size) : b->size;
            match_points(m, pe_points(now) + m->first, &old[j], pe_points(then) + old[j].first,
                         scale, MATCH_DISTANCE * size);
        }
    }
}
