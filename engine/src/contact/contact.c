/* A pass over the pairs builds the new list of contacts next to the old one. */
#include "contact.h"

#include "model/view.h"
#include "pair_contacts.h"

#include <string.h>

pe_contact_rules pe_contact_rules_exact(void)
{
    return (pe_contact_rules){.reuse_tolerance = 1e-9, .most_points = PE_MAX_POINTS};
}

static void compute_spin_of(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_search *s = context;
    for (int slot = begin; slot < end; ++slot) {
        s->spin[slot] = pe_spin_speed(s->world, slot);
    }
}

/* Computes pe_spin_speed of the pairs' bodies, or of all where there are few. */
static pe_status compute_spin(pe_search *s, const pe_pair_list *pairs)
{
    const pe_world *world = s->world;
    s->spin = pe_scratch(s->world, (size_t)world->slot_count, sizeof *s->spin);
    if (s->spin == NULL) {
        return pe_fail(s->error, PE_NO_MEMORY, "no memory for %d bodies", world->slot_count);
    }
    if (2 * pairs->count >= world->slot_count) {
        pe_pool_run(world->pool, world->slot_count, PE_BODY_GRAIN, compute_spin_of, s);
        return PE_OK;
    }
    for (int i = 0; i < pairs->count; ++i) {
        pe_pair pair = pairs->items[i];
        s->spin[pair.a] = pe_spin_speed(world, pair.a);
        s->spin[pair.b] = pe_spin_speed(world, pair.b);
    }
    return PE_OK;
}

/* Computes how deep each dynamic body, or one that it touches, lay in others in the list before. */
static pe_status compute_depth(pe_search *s)
{
    const size_t slots = (size_t)s->world->slot_count;
    const pe_body *bodies = pe_bodies(s->world);
    const pe_manifold *old = pe_manifolds(s->old);
    double *own = pe_scratch_zero(s->world, slots, sizeof *own);
    s->depth = pe_scratch_zero(s->world, slots, sizeof *s->depth);
    if (own == NULL || s->depth == NULL) {
        return pe_fail(s->error, PE_NO_MEMORY, "no memory for %d bodies", s->world->slot_count);
    }
    for (int i = 0; i < s->old->manifold_count; ++i) {
        const double depth = -old[i].least_separation;
        own[old[i].a] = bodies[old[i].a].is_static ? 0 : pe_max(own[old[i].a], depth);
        own[old[i].b] = bodies[old[i].b].is_static ? 0 : pe_max(own[old[i].b], depth);
    }
    for (int i = 0; i < s->old->manifold_count; ++i) {
        const double depth = pe_max(own[old[i].a], own[old[i].b]);
        s->depth[old[i].a] = pe_max(s->depth[old[i].a], depth);
        s->depth[old[i].b] = pe_max(s->depth[old[i].b], depth);
    }
    return PE_OK;
}

/* ---- All pairs ---- */

/* The pairs of a search. With more than one thread each finds the manifolds of some pairs in a list of
 * its own, from which they are copied to the places that they have in the whole list. */
enum { PAIR_GRAIN = 256 };

/* What a piece of the pairs has found, in the list of one thread. */
typedef struct found_piece {
    const pe_contacts *list;
    int manifold, manifold_count, point, point_count; /* in that list */
    int to_manifold, to_point;                        /* in the whole list */
    pe_status status;
    pe_error error;
} found_piece;

typedef struct all_pairs {
    const pe_search *search;
    const pe_pair_list *pairs;
    const bool *moved;
    found_piece *pieces;
} all_pairs;

/* The first old manifold that does not come before the pair. */
static int first_old(const pe_contacts *old, pe_pair pair)
{
    int low = 0, high = old->manifold_count;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (pe_precedes_pair(&pe_manifolds(old)[middle], pair)) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Appends the manifolds of pairs begin .. end - 1, and the old ones between them that are copied. */
static pe_status find_range(pe_search *s, const all_pairs *all, int begin, int end)
{
    const pe_pair_list *pairs = all->pairs;
    const bool *moved = all->moved;
    pe_status status = PE_OK;
    s->next = begin == 0 ? 0 : first_old(s->old, pairs->items[begin]);
    for (int i = begin; i < end && status == PE_OK; ++i) {
        pe_pair pair = pairs->items[i];
        if (!pe_looks_at(moved, pair.a, pair.b)) {
            continue;
        }
        if (moved != NULL) {
            status = pe_copy_unmoved(s, moved, pair);
        }
        if (status == PE_OK) {
            status = pe_find_pair(s, pair);
        }
    }
    if (status == PE_OK && moved != NULL) {
        const pe_pair past = {s->world->slot_count, 0};
        status = pe_copy_unmoved(s, moved, end < pairs->count ? pairs->items[end] : past);
    }
    return status;
}

static void find_piece(void *context, int worker, int begin, int end)
{
    const all_pairs *all = context;
    pe_search s = *all->search;
    found_piece *piece = &all->pieces[begin / PAIR_GRAIN];
    s.world = pe_view_of(s.world, worker);
    s.found = &s.world->previous;
    s.error = &piece->error;
    *piece = (found_piece){
        .list = s.found, .manifold = s.found->manifold_count, .point = s.found->point_count};
    piece->status = find_range(&s, all, begin, end);
    piece->manifold_count = s.found->manifold_count - piece->manifold;
    piece->point_count = s.found->point_count - piece->point;
}

static void copy_pieces(void *context, int worker, int begin, int end)
{
    (void)worker;
    const all_pairs *all = context;
    const pe_contacts *whole = all->search->found;
    for (int i = begin; i < end; ++i) {
        const found_piece *piece = &all->pieces[i];
        pe_manifold *m = pe_manifolds(whole) + piece->to_manifold;
        memcpy(m, pe_manifolds(piece->list) + piece->manifold,
               (size_t)piece->manifold_count * sizeof *m);
        memcpy(pe_manifold_points(whole) + piece->to_point,
               pe_manifold_points(piece->list) + piece->point,
               (size_t)piece->point_count * sizeof(pe_manifold_point));
        for (int j = 0; j < piece->manifold_count; ++j) {
            m[j].first += piece->to_point - piece->point;
        }
    }
}

/* Gives each piece its place in the whole list, for which it makes room. */
static pe_status place_pieces(const pe_search *s, found_piece *pieces, int count)
{
    pe_contacts *found = s->found;
    for (int i = 0; i < count; ++i) {
        found_piece *piece = &pieces[i];
        if (piece->status != PE_OK) {
            if (s->error != NULL) {
                *s->error = piece->error;
            }
            return piece->status;
        }
        piece->to_manifold = found->manifold_count;
        piece->to_point = found->point_count;
        found->manifold_count += piece->manifold_count;
        found->point_count += piece->point_count;
    }
    pe_status status =
        pe_array_reserve(&found->manifold_array, &s->world->allocator, sizeof(pe_manifold),
                         (size_t)found->manifold_count, 0, s->error);
    if (status == PE_OK) {
        status =
            pe_array_reserve(&found->point_array, &s->world->allocator, sizeof(pe_manifold_point),
                             (size_t)found->point_count, 0, s->error);
    }
    return status;
}

/* find_range of all pairs, by the threads of the world. */
static pe_status find_shared(pe_search *s, all_pairs *all)
{
    pe_world *world = s->world;
    const int count = pe_piece_count(all->pairs->count, PAIR_GRAIN);
    all->pieces = pe_scratch(world, (size_t)count, sizeof *all->pieces);
    if (all->pieces == NULL) {
        return pe_fail(s->error, PE_NO_MEMORY, "no memory for the contacts of %d pairs",
                       all->pairs->count);
    }
    pe_views_open(world);
    pe_pool_run(world->pool, all->pairs->count, PAIR_GRAIN, find_piece, all);
    pe_status status = place_pieces(s, all->pieces, count);
    if (status == PE_OK) {
        pe_pool_run(world->pool, count, 1, copy_pieces, all);
    }
    return status;
}

pe_status pe_contacts_find(pe_world *world, const pe_contact_rules *rules,
                           const pe_pair_list *pairs, const bool *moved, double dt, pe_error *error)
{
    pe_search s = {
        .world = world,
        .rules = rules,
        .dt = dt,
        .slack = pe_margin_slack(world, dt),
        .old = &world->contacts,
        .found = &world->previous, /* its contents are of no more use: free to fill */
        .error = error,
    };
    all_pairs all = {.search = &s, .pairs = pairs, .moved = moved};
    s.found->manifold_count = s.found->point_count = 0;
    pe_status status = compute_spin(&s, pairs);
    if (status == PE_OK) {
        status = compute_depth(&s);
    }
    if (status == PE_OK) {
        status = world->views != NULL && pairs->count > PAIR_GRAIN
                     ? find_shared(&s, &all)
                     : find_range(&s, &all, 0, pairs->count);
    }
    if (status == PE_OK) {
        pe_contacts_swap(&world->contacts, &world->previous);
    }
    return status;
}

pe_status pe_contacts_update(pe_world *world, const pe_contact_rules *rules, const bool *moved,
                             double dt, pe_error *error)
{
    pe_pair_list pairs;
    pe_status status = pe_broad_phase(world, dt, moved, &pairs, error);
    return status == PE_OK ? pe_contacts_find(world, rules, &pairs, moved, dt, error) : status;
}

void pe_contacts_scale_impulses(pe_world *world, double dt)
{
    if (world->previous_dt > 0 && dt != world->previous_dt) {
        pe_manifold_point *points = pe_manifold_points(&world->contacts);
        for (int i = 0; i < world->contacts.point_count; ++i) {
            points[i].impulse = pe_scale(dt / world->previous_dt, points[i].impulse);
        }
    }
}
