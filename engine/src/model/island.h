/* Contact islands: groups of dynamic bodies that push on each other, directly or through others. */
#ifndef PE_ISLAND_H
#define PE_ISLAND_H

#include "world.h"

/* Islands with at least one contact, ordered by their first body; island k has the manifolds
 * manifolds[start[k]] .. manifolds[start[k + 1] - 1] and the dynamic bodies
 * bodies[body_start[k]] .. bodies[body_start[k + 1] - 1], both ascending. The step's arena holds
 * it. */
typedef struct pe_islands {
    int count;
    int *start;      /* (count + 1) */
    int *manifolds;  /* (manifold_count): indices into the contacts */
    int *body_start; /* (count + 1) */
    int *bodies;     /* (body_start[count]): slots */
    int *place;      /* (slots): a body's index in its island's list; -1 when it is in none */
} pe_islands;

/* Takes the arrays of *islands from the step's arena, for up to `manifolds` manifolds. Callers
 * check pe_scratch_failed. */
void pe_islands_take(pe_world *world, size_t manifolds, pe_islands *islands);

/* Finds the islands of world->contacts, by union-find over the manifolds between dynamic bodies.
 * Static bodies do not join the bodies that rest on them. */
pe_status pe_islands_find(pe_world *world, pe_islands *islands, pe_error *error);

/* Finds the groups of bodies that pushed each other in the step, by world->solved, touch now, by
 * world->contacts, or were parted by position correction, by the forest `parted`, (slots), NULL: none.
 * Islands also hold bodies that are merely near. Only the lists of bodies and `place` are filled. */
pe_status pe_islands_find_touching(pe_world *world, const int *parted, pe_islands *groups,
                                   pe_error *error);

/* The root of an item's tree in a forest. */
int pe_root_of(int *parent, int item);

/* Joins two trees; the smaller of their roots is that of both. */
void pe_join_roots(int *parent, int a, int b);

/* Divides island k of `whole` by a forest over the places of its bodies: each tree is an island of
 * *parts, ordered by its first body. Manifolds between two trees are in no part. */
pe_status pe_islands_divide(pe_world *world, const pe_islands *whole, int k, int *parent,
                            pe_islands *parts, pe_error *error);

/* A walk over the points of island k in world->contacts or a list with the same manifolds. */
static inline pe_point_walk pe_walk_island(const pe_contacts *contacts, const pe_islands *islands,
                                           int k)
{
    return (pe_point_walk){.contacts = contacts,
                           .listed = islands->manifolds + islands->start[k],
                           .count = islands->start[k + 1] - islands->start[k]};
}

#endif
