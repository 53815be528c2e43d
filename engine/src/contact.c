#include "contact.h"

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
    const double *spin;      /* (slot_count), as pe_spin_speed */
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

static pe_status begin(finder *f)
{
    double *spin = pe_scratch(f->world, (size_t)f->world->slot_count, sizeof *spin);
    if (spin == NULL) {
        return pe_fail(f->error, PE_NO_MEMORY, "no memory for %d bodies", f->world->slot_count);
    }
    for (int slot = 0; slot < f->world->slot_count; ++slot) {
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
        status = pe_array_reserve(&now->point_array, &f->world->allocator, sizeof(pe_point),
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
    memcpy(pe_points(now) + m->first, pe_points(f->then) + old->first,
           (size_t)old->count * sizeof(pe_point));
    now->point_count += old->count;
    return PE_OK;
}

static void place_point(pe_point *point, const pe_hit *hit, pe_vec3 normal, const pe_pose *a,
                        const pe_pose *b)
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

/* Fills the pair's manifold: the old one carried along, or a new one of the hits with the impulses
 * of the old one. `old` may be NULL. */
static void fill_manifold(const finder *f, const pe_manifold *old, const pe_hits *hits,
                          const pe_relative *relative, double size, pe_manifold *m)
{
    const pe_pose *a = &pe_poses(f->world)[m->a], *b = &pe_poses(f->world)[m->b];
    pe_point *points = pe_points(f->now) + m->first;
    const pe_point *old_points = old != NULL ? pe_points(f->then) + old->first : NULL;
    m->kept = hits == NULL;
    if (hits == NULL) {
        m->built = old->built;
        pe_manifold_carry(m, a, b, old_points, points);
        return;
    }
    m->normal = hits->normal;
    m->built = pe_manifold_built(hits, relative, &a->rotation, &b->rotation);
    for (int i = 0; i < hits->count; ++i) {
        place_point(&points[i], &hits->item[i], hits->normal, a, b);
    }
    if (old != NULL) {
        pe_points_match(points, m->count, m->normal, old_points, old->count, size);
    }
}

/* The old manifold of the pair, or NULL. Pairs come in order, so that one walk finds them all. */
static const pe_manifold *old_of(finder *f, pe_pair pair)
{
    const pe_manifold *old = pe_manifolds(f->then);
    int count = f->then->manifold_count;
    while (f->next < count && precedes(&old[f->next], pair)) {
        ++f->next;
    }
    bool same = f->next < count && old[f->next].a == pair.a && old[f->next].b == pair.b;
    return same ? &old[f->next++] : NULL;
}

/* Finds the pair's manifold: the old one carried along, or a new one, or none. */
static pe_status find_pair(finder *f, pe_pair pair)
{
    pe_world *world = f->world;
    const pe_body *a = &pe_bodies(world)[pair.a], *b = &pe_bodies(world)[pair.b];
    const pe_pose *pose_a = &pe_poses(world)[pair.a], *pose_b = &pe_poses(world)[pair.b];
    pe_vec3 closing =
        pe_sub(pe_motions(world)[pair.a].velocity, pe_motions(world)[pair.b].velocity);
    double spin = f->spin[pair.a] + f->spin[pair.b];
    double margin = f->dt * (pe_length(closing) + spin) + f->slack;
    pe_relative relative = pe_relative_pose(a, pose_a, b, pose_b);
    double size = pair_size(a, b);
    const pe_manifold *old = old_of(f, pair);
    bool holds =
        old != NULL && old->count <= f->rules->most_points &&
        pe_manifold_holds(&old->built, &relative, f->rules->reuse_tolerance * size, margin);
    pe_hits hits;
    if (!holds) {
        pe_collide((pe_placed){&a->shape, pose_a, a->size}, (pe_placed){&b->shape, pose_b, b->size},
                   margin, &hits);
        if (hits.count > f->rules->most_points) {
            pe_hits_reduce(&hits, size);
        }
    }
    int count = holds ? old->count : hits.count;
    pe_status status = count > 0 ? reserve(f, count) : PE_OK;
    if (count == 0 || status != PE_OK) {
        return status;
    }
    const pe_surface *surface = pe_surface_of(world, a->material, b->material);
    pe_manifold *m = &pe_manifolds(f->now)[f->now->manifold_count++];
    m->a = pair.a;
    m->b = pair.b;
    m->first = f->now->point_count;
    m->count = count;
    m->friction = surface->friction;
    m->restitution = surface->restitution;
    f->now->point_count += count;
    fill_manifold(f, old, holds ? NULL : &hits, &relative, size, m);
    return PE_OK;
}

pe_status pe_contacts_find_by(pe_world *world, const pe_contact_rules *rules, const pe_pair *pairs,
                              int count, double dt, pe_error *error)
{
    finder f = {.world = world, .rules = rules, .dt = dt, .error = error};
    pe_status status = begin(&f);
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
        pe_point *points = pe_points(&world->contacts);
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
    pe_status status = begin(&f);
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
