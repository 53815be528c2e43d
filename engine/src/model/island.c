#include "island.h"

/* Gaps up to this, in m, are closed. */
static const double TOUCHING = 1e-6;

/* The root of a slot's tree, with every visited link cut in half (Tarjan and van Leeuwen 1984). */
static int find_root(int *parent, int slot)
{
    while (parent[slot] != slot) {
        parent[slot] = parent[parent[slot]];
        slot = parent[slot];
    }
    return slot;
}

void pe_islands_take(pe_world *world, size_t manifolds, pe_islands *islands)
{
    size_t slots = (size_t)world->slot_count;
    *islands = (pe_islands){
        .start = pe_scratch(world, slots + 1, sizeof(int)),
        .manifolds = pe_scratch(world, manifolds + 1, sizeof(int)),
        .body_start = pe_scratch(world, slots + 1, sizeof(int)),
        .bodies = pe_scratch(world, slots, sizeof(int)),
        .place = pe_scratch(world, slots, sizeof(int)),
    };
}

/* Lists items 0 .. count - 1 by their group, ascending in each, with group -1 left out. Fills start
 * (groups + 1). */
static void sort_by_group(const int *group, int count, int groups, int *start, int *sorted)
{
    memset(start, 0, ((size_t)groups + 1) * sizeof(int));
    for (int i = 0; i < count; ++i) {
        if (group[i] >= 0) {
            start[group[i] + 1] += 1;
        }
    }
    for (int k = 0; k < groups; ++k) {
        start[k + 1] += start[k];
    }
    for (int i = 0; i < count; ++i) {
        if (group[i] >= 0) {
            sorted[start[group[i]]++] = i;
        }
    }
    /* Each start has walked to its group's end: move them back. */
    for (int k = groups; k > 0; --k) {
        start[k] = start[k - 1];
    }
    start[0] = 0;
}

static void join(const pe_world *world, const pe_manifold *m, int *parent)
{
    const pe_body *bodies = pe_bodies(world);
    if (!bodies[m->a].is_static && !bodies[m->b].is_static) {
        int p = find_root(parent, m->a), q = find_root(parent, m->b);
        /* The smaller slot is the root, so that an island's root is its first body. */
        parent[p > q ? p : q] = p < q ? p : q;
    }
}

/* Fills the lists of bodies from the numbers of the roots. */
static void list_bodies(const pe_world *world, int *parent, const int *number, pe_islands *islands)
{
    /* Static and unused slots are roots of themselves without a contact: number -1. */
    int *island_of_body = islands->place;
    for (int slot = 0; slot < world->slot_count; ++slot) {
        island_of_body[slot] = number[find_root(parent, slot)];
    }
    sort_by_group(island_of_body, world->slot_count, islands->count, islands->body_start,
                  islands->bodies);
    for (int slot = 0; slot < world->slot_count; ++slot) {
        islands->place[slot] = -1;
    }
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
            islands->place[islands->bodies[i]] = i - islands->body_start[k];
        }
    }
}

pe_status pe_islands_find(pe_world *world, pe_islands *islands, pe_error *error)
{
    size_t slots = (size_t)world->slot_count;
    int count = world->contacts.manifold_count;
    int *parent = pe_scratch(world, slots, sizeof *parent);
    int *number = pe_scratch(world, slots, sizeof *number);
    int *island_of = pe_scratch(world, (size_t)count + 1, sizeof *island_of);
    pe_islands_take(world, (size_t)count, islands);
    if (pe_scratch_failed(world)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the islands of %zu bodies", slots);
    }
    const pe_body *bodies = pe_bodies(world);
    const pe_manifold *manifolds = pe_manifolds(&world->contacts);
    for (int slot = 0; slot < world->slot_count; ++slot) {
        parent[slot] = slot;
        number[slot] = -1;
    }
    for (int i = 0; i < count; ++i) {
        join(world, &manifolds[i], parent);
    }
    /* Mark the roots that have contacts and number them in order. */
    for (int i = 0; i < count; ++i) {
        int body = bodies[manifolds[i].a].is_static ? manifolds[i].b : manifolds[i].a;
        island_of[i] = find_root(parent, body);
        number[island_of[i]] = 0;
    }
    for (int slot = 0; slot < world->slot_count; ++slot) {
        number[slot] = number[slot] == 0 ? islands->count++ : -1;
    }
    for (int i = 0; i < count; ++i) {
        island_of[i] = number[island_of[i]];
    }
    sort_by_group(island_of, count, islands->count, islands->start, islands->manifolds);

    list_bodies(world, parent, number, islands);
    return PE_OK;
}

static bool touches(const pe_contacts *contacts, const pe_manifold *m)
{
    (void)contacts;
    return m->least_separation <= TOUCHING;
}

static bool pushed(const pe_contacts *contacts, const pe_manifold *m)
{
    for (int j = m->first; j < m->first + m->count; ++j) {
        pe_vec3 p = pe_manifold_points(contacts)[j].impulse;
        if (pe_dot(p, m->normal) > 0) {
            return true;
        }
    }
    return false;
}

static void join_all(const pe_world *world, const pe_contacts *contacts,
                     bool (*joins)(const pe_contacts *, const pe_manifold *), int *parent,
                     bool *joined)
{
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        if (joins(contacts, m)) {
            join(world, m, parent);
            joined[m->a] = joined[m->b] = true;
        }
    }
}

pe_status pe_islands_find_touching(pe_world *world, pe_islands *groups, pe_error *error)
{
    size_t slots = (size_t)world->slot_count;
    int *parent = pe_scratch(world, slots, sizeof *parent);
    int *number = pe_scratch(world, slots, sizeof *number);
    bool *joined = pe_scratch_zero(world, slots, sizeof *joined);
    pe_islands_take(world, 0, groups);
    if (pe_scratch_failed(world)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the groups of %zu bodies", slots);
    }
    for (int slot = 0; slot < world->slot_count; ++slot) {
        parent[slot] = slot;
        number[slot] = -1;
    }
    join_all(world, &world->solved, pushed, parent, joined);
    join_all(world, &world->contacts, touches, parent, joined);
    const pe_body *bodies = pe_bodies(world);
    for (int slot = 1; slot < world->slot_count; ++slot) {
        if (joined[slot] && bodies[slot].alive && !bodies[slot].is_static) {
            int root = find_root(parent, slot);
            number[root] = number[root] < 0 ? groups->count++ : number[root];
        }
    }
    list_bodies(world, parent, number, groups);
    return PE_OK;
}
