#include "island.h"

#include <string.h>

/* The root of a slot's tree, with every visited link cut in half (Tarjan and van Leeuwen 1984). */
static int find_root(int *parent, int slot)
{
    while (parent[slot] != slot) {
        parent[slot] = parent[parent[slot]];
        slot = parent[slot];
    }
    return slot;
}

pe_status pe_islands_find(pe_world *world, pe_islands *islands, pe_error *error)
{
    size_t slots = (size_t)world->slot_count;
    int count = world->contacts.manifold_count;
    int *parent = pe_scratch(world, slots, sizeof *parent);
    int *number = pe_scratch(world, slots, sizeof *number);
    int *island_of = pe_scratch(world, (size_t)count + 1, sizeof *island_of);
    *islands = (pe_islands){
        .start = pe_scratch(world, slots + 1, sizeof(int)),
        .manifolds = pe_scratch(world, (size_t)count + 1, sizeof(int)),
    };
    if (parent == NULL || number == NULL || island_of == NULL || islands->start == NULL ||
        islands->manifolds == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the islands of %zu bodies", slots);
    }
    const pe_body *bodies = pe_bodies(world);
    const pe_manifold *manifolds = pe_manifolds(&world->contacts);
    for (int slot = 0; slot < world->slot_count; ++slot) {
        parent[slot] = slot;
        number[slot] = -1;
    }
    for (int i = 0; i < count; ++i) {
        if (!bodies[manifolds[i].a].is_static && !bodies[manifolds[i].b].is_static) {
            int p = find_root(parent, manifolds[i].a), q = find_root(parent, manifolds[i].b);
            /* The smaller slot is the root, so that an island's root is its first body. */
            parent[p > q ? p : q] = p < q ? p : q;
        }
    }
    /* Mark the roots that have contacts, number them in order, and sort manifolds by number. */
    for (int i = 0; i < count; ++i) {
        int body = bodies[manifolds[i].a].is_static ? manifolds[i].b : manifolds[i].a;
        island_of[i] = find_root(parent, body);
        number[island_of[i]] = 0;
    }
    for (int slot = 0; slot < world->slot_count; ++slot) {
        number[slot] = number[slot] == 0 ? islands->count++ : -1;
    }
    memset(islands->start, 0, ((size_t)islands->count + 1) * sizeof(int));
    for (int i = 0; i < count; ++i) {
        island_of[i] = number[island_of[i]];
        islands->start[island_of[i] + 1] += 1;
    }
    for (int k = 0; k < islands->count; ++k) {
        islands->start[k + 1] += islands->start[k];
    }
    for (int i = 0; i < count; ++i) {
        islands->manifolds[islands->start[island_of[i]]++] = i;
    }
    /* Each start has walked to its island's end: move them back. */
    for (int k = islands->count; k > 0; --k) {
        islands->start[k] = islands->start[k - 1];
    }
    islands->start[0] = 0;
    return PE_OK;
}
