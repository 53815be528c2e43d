#include "contact.h"

#include "contact_centre.h"
#include "contact_match.h"
#include "contact_reduce.h"
#include "contact_reuse.h"

#include <string.h>

pe_contact_rules pe_contact_rules_exact(void)
{
    return (pe_contact_rules){.reuse_tolerance = 1e-9, .most_points = PE_MAX_POINTS};
}

/* The size of the smaller of two bodies; a plane has none. */
static double pair_size(const pe_body *a, const pe_body *b)
{
    return a->size > 0 && b->size > 0 ? pe_min(a->size, b->size) : pe_max(a->size, b->size);
}

/* One pass over the pairs: the new list grows beside the one that it will replace. */
typedef struct finder {
    pe_world *world;
    const pe_contact_rules *rules;
    const double *spin;      /* (slot_count), as pe_spin_speed, of the pairs' bodies */
    double dt, slack;        /* s; m, pe_margin_slack */
    const pe_contacts *then; /* both sorted by (a, b) */
    int next;                /* the first manifold of `then` that no pair has passed yet */
    pe_contacts *now;
    pe_error *error;
} finder;

/* Whether the manifold comes before the pair. */
static bool precedes(const pe_manifold *m, pe_pair pair)
{
    return m->a < pair.a || (m->a == pair.a && m->b < pair.b);
}

static pe_status begin(finder *f, const pe_pair *pairs, int count)
{
    double *spin = pe_scratch(f->world, (size_t)f->world->slot_count, sizeof *spin);
    if (spin == NULL) {
        return pe_fail(f->error, PE_NO_MEMORY, "no memory for %d bodies", f->world->slot_count);
    }
    bool few = 2 * count < f->world->slot_count;
    for (int i = 0; i < count && few; ++i) {
        spin[pairs[i].a] = pe_spin_speed(f->world, pairs[i].a);
        spin[pairs[i].b] = pe_spin_speed(f->world, pairs[i].b);
    }
    for (int slot = 0; slot < f->world->slot_count && !few; ++slot) {
        spin[slot] = pe_spin_speed(f->world, slot);
    }
    f->spin = spin;
    f->slack = pe_margin_slack(f->world, f->dt);
    f->then = &f->world->contacts;
    f->now = &f->world->previous; /* its contents are of no more use: free to fill */
    f->now->manifold_count = f->now->point_count = 0;
    return PE_OK;
}

/* Makes the new list the world's. */
static void finish(const finder *f)
{
    pe_contacts swapped = f->world->contacts;
    f->world->contacts = f->world->previous;
    f->world->previous = swapped;
}

/* Room for one manifold more with `count` points. */
static pe_status reserve(finder *f, int count)
{
    pe_contacts *now = f->now;
    size_t manifolds = (size_t)now->manifold_count, points = (size_t)now->point_count;
    pe_status status = pe_array_reserve(&now->manifold_array, &f->world->allocator,
                                        sizeof(pe_manifold), manifolds + 1, manifolds, f->error);
    if (status == PE_OK) {
        status =
            pe_array_reserve(&now->point_array, &f->world->allocator, sizeof(pe_manifold_point),
                             points + (size_t)count, points, f->error);
    }
    return status;
}

/* Appends manifold `index` of the old list with its points as they are. */
static pe_status copy_manifold(finder *f, int index)
{
    const pe_manifold *old = &pe_manifolds(f->then)[index];
    pe_status status = reserve(f, old->count);
    if (status != PE_OK) {
        return status;
    }
    pe_contacts *now = f->now;
    pe_manifold *m = &pe_manifolds(now)[now->manifold_count++];
    *m = *old;
    m->first = now->point_count;
    memcpy(pe_manifold_points(now) + m->first, pe_manifold_points(f->then) + old->first,
           (size_t)old->count * sizeof(pe_manifold_point));
    now->point_count += old->count;
    return PE_OK;
}

static void place_point(pe_manifold_point *point, const pe_pair_point *hit, pe_vec3 normal,
                        const pe_pose *a, const pe_pose *b)
{
    pe_vec3 half_gap = pe_scale(0.5 * hit->separation, normal);
    pe_vec3 on_a = pe_sub(hit->position, half_gap), on_b = pe_add(hit->position, half_gap);
    point->position = hit->position;
    point->anchor_a = pe_unrotate(&a->rotation, pe_sub(on_a, a->position));
    point->anchor_b = pe_unrotate(&b->rotation, pe_sub(on_b, b->position));
    point->separation = hit->separation;
    point->feature = hit->feature;
    point->impulse = pe_v3(0, 0, 0);
}

/* The old manifolds of a pair. */
typedef struct old_patches {
    const pe_manifold *items;
    int count, point_count;
    const pe_manifold_point *points; /* of all of them */
} old_patches;

/* Pairs come in order, so that one walk finds them all. */
static old_patches old_of(finder *f, pe_pair pair)
{
    const pe_manifold *old = pe_manifolds(f->then);
    int end = f->then->manifold_count;
    while (f->next < end && precedes(&old[f->next], pair)) {
        ++f->next;
    }
    old_patches found = {.items = &old[f->next]};
    for (; f->next < end && old[f->next].a == pair.a && old[f->next].b == pair.b; ++f->next) {
        found.count += 1;
        found.point_count += old[f->next].count;
    }
    if (found.count > 0) {
        found.points = pe_manifold_points(f->then) + found.items[0].first;
    }
    return found;
}

/* Appends a manifold of the pair with `count` points, which are to be filled. */
static pe_status append(finder *f, pe_pair pair, int count, pe_manifold **manifold)
{
    pe_status status = reserve(f, count);
    if (status == PE_OK) {
        const pe_body *bodies = pe_bodies(f->world);
        const pe_material_pair *surface =
            pe_material_pair_of(f->world, bodies[pair.a].material, bodies[pair.b].material);
        pe_manifold *m = &pe_manifolds(f->now)[f->now->manifold_count++];
        m->a = pair.a;
        m->b = pair.b;
        m->first = f->now->point_count;
        m->count = count;
        m->friction = surface->friction;
        m->restitution = surface->restitution;
        f->now->point_count += count;
        *manifold = m;
    }
    return status;
}

/* Appends the pair's old manifolds, carried along by the bodies. */
static pe_status carry_pair(finder *f, pe_pair pair, const old_patches *old)
{
    const pe_pose *a = &pe_poses(f->world)[pair.a], *b = &pe_poses(f->world)[pair.b];
    pe_status status = PE_OK;
    for (int i = 0; i < old->count && status == PE_OK; ++i) {
        const pe_manifold *then = &old->items[i];
        pe_manifold *m;
        status = append(f, pair, then->count, &m);
        if (status == PE_OK) {
            m->kept = true;
            m->built = then->built;
            pe_manifold_carry(m, a, b, pe_manifold_points(f->then) + then->first,
                              pe_manifold_points(f->now) + m->first);
        }
    }
    return status;
}

/* Appends new manifolds of the patches, with the impulses of the old ones. */
static pe_status build_pair(finder *f, pe_pair pair, const old_patches *old,
                            const pe_pair_manifold *patches, int count, const pe_relative *relative,
                            double size)
{
    const pe_pose *a = &pe_poses(f->world)[pair.a], *b = &pe_poses(f->world)[pair.b];
    pe_matched matched;
    memset(matched.point, 0, (size_t)old->point_count * sizeof *matched.point);
    pe_status status = PE_OK;
    for (int i = 0; i < count && status == PE_OK; ++i) {
        const pe_pair_manifold *hits = &patches[i];
        pe_manifold *m;
        status = append(f, pair, hits->count, &m);
        if (status != PE_OK) {
            break;
        }
        pe_manifold_point *points = pe_manifold_points(f->now) + m->first;
        m->kept = false;
        m->normal = hits->normal;
        m->built = pe_manifold_built(hits, relative, &a->rotation, &b->rotation);
        m->least_separation = HUGE_VAL;
        for (int k = 0; k < hits->count; ++k) {
            place_point(&points[k], &hits->item[k], hits->normal, a, b);
            m->least_separation = pe_min(m->least_separation, hits->item[k].separation);
        }
        if (old->count > 0) {
            pe_points_match(points, m->count, m->normal, old->items, old->count, old->points, size,
                            &matched);
        }
    }
    return status;
}

static bool is_convex(const pe_body *b)
{
    return b->shape.kind != PE_SHAPE_MESH || b->geometry->convex;
}

/* Finds the pair's manifolds: the old ones carried along, or new ones, or none. */
static pe_status find_pair(finder *f, pe_pair pair)
{
    pe_world *world = f->world;
    const pe_body *a = &pe_bodies(world)[pair.a], *b = &pe_bodies(world)[pair.b];
    const pe_pose *pose_a = &pe_poses(world)[pair.a], *pose_b = &pe_poses(world)[pair.b];
    pe_vec3 closing = pe_sub(pe_twists(world)[pair.a].velocity, pe_twists(world)[pair.b].velocity);
    double spin = f->spin[pair.a] + f->spin[pair.b];
    double margin = f->dt * (pe_length(closing) + spin) + f->slack;
    pe_relative relative = pe_relative_pose(a, pose_a, b, pose_b);
    double size = pair_size(a, b);
    old_patches old = old_of(f, pair);
    bool few = true; /* points in each manifold */
    for (int i = 0; i < old.count; ++i) {
        few = few && old.items[i].count <= f->rules->most_points;
    }
    if (old.count > 0 && few &&
        pe_manifolds_hold(old.items, old.count, &relative, f->rules->reuse_tolerance * size,
                          margin)) {
        return carry_pair(f, pair, &old);
    }
    pe_workspace work = pe_step_memory(world);
    pe_arena_mark mark = pe_arena_fill(work.arena);
    pe_pair_manifold patches[PE_MAX_MANIFOLDS];
    int count =
        pe_collide((pe_placed){&a->shape, a->geometry, pose_a, a->size},
                   (pe_placed){&b->shape, b->geometry, pose_b, b->size}, margin, work, patches);
    pe_arena_rewind(work.arena, work.allocator, mark);
    if (count < 0) {
        return pe_fail(f->error, PE_NO_MEMORY, "no memory for the contacts of two meshes");
    }
    for (int i = 0; i < count; ++i) {
        if (patches[i].count > f->rules->most_points) {
            pe_pair_manifold_reduce(&patches[i], size);
        }
    }
    if (count > 0 && is_convex(a) && is_convex(b)) {
        pe_pair_manifold_hold_centre(&patches[0], a, pose_a, b, pose_b, margin);
    }
    return build_pair(f, pair, &old, patches, count, &relative, size);
}

pe_status pe_contacts_find_by(pe_world *world, const pe_contact_rules *rules, const pe_pair *pairs,
                              int count, double dt, pe_error *error)
{
    finder f = {.world = world, .rules = rules, .dt = dt, .error = error};
    pe_status status = begin(&f, pairs, count);
    for (int i = 0; i < count && status == PE_OK; ++i) {
        status = find_pair(&f, pairs[i]);
    }
    if (status == PE_OK) {
        finish(&f);
    }
    return status;
}

pe_status pe_contacts_find(pe_world *world, const pe_pair *pairs, int count, double dt,
                           pe_error *error)
{
    pe_contact_rules rules = pe_contact_rules_exact();
    return pe_contacts_find_by(world, &rules, pairs, count, dt, error);
}

void pe_contacts_match(pe_world *world, double dt)
{
    if (world->previous_dt > 0 && dt != world->previous_dt) {
        pe_manifold_point *points = pe_manifold_points(&world->contacts);
        for (int i = 0; i < world->contacts.point_count; ++i) {
            points[i].impulse = pe_scale(dt / world->previous_dt, points[i].impulse);
        }
    }
}

/* Copies the old manifolds of bodies that have not moved, up to the pair. */
static pe_status copy_unmoved(finder *f, const bool *moved, pe_pair until)
{
    const pe_manifold *old = pe_manifolds(f->then);
    for (; f->next < f->then->manifold_count && precedes(&old[f->next], until); ++f->next) {
        const pe_manifold *m = &old[f->next];
        bool stays = !moved[m->a] && !moved[m->b];
        pe_status status = stays ? copy_manifold(f, f->next) : PE_OK;
        if (status != PE_OK) {
            return status;
        }
    }
    return PE_OK;
}

pe_status pe_contacts_refind(pe_world *world, const pe_contact_rules *rules, const pe_pair *pairs,
                             int count, const bool *moved, double dt, pe_error *error)
{
    finder f = {.world = world, .rules = rules, .dt = dt, .error = error};
    pe_status status = begin(&f, pairs, count);
    for (int i = 0; i < count && status == PE_OK; ++i) {
        if (!moved[pairs[i].a] && !moved[pairs[i].b]) {
            continue;
        }
        status = copy_unmoved(&f, moved, pairs[i]);
        if (status == PE_OK) {
            status = find_pair(&f, pairs[i]);
        }
    }
    if (status == PE_OK) {
        status = copy_unmoved(&f, moved, (pe_pair){world->slot_count, 0});
    }
    if (status == PE_OK) {
        finish(&f);
    }
    return status;
}
