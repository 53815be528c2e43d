/* The contacts of one pair in a pass over all pairs (contact.c). */
#ifndef PE_PAIR_CONTACTS_H
#define PE_PAIR_CONTACTS_H

#include "contact.h"

/* One pass over the pairs. */
typedef struct pe_search {
    pe_world *world;
    const pe_contact_rules *rules;
    double *spin;           /* (slot_count), as pe_spin_speed, of the pairs' bodies */
    double *depth;          /* (slot_count), m: of a dynamic body, how deep it or one that it
                               touches lay in others in the list before */
    double dt, slack;       /* s; m, pe_margin_slack */
    const pe_contacts *old; /* both lists are sorted by (a, b) */
    int next;               /* the first manifold of `old` that no pair has passed yet */
    pe_contacts *found;
    pe_error *error;
} pe_search;

/* Whether the manifold comes before the pair. */
static inline bool pe_precedes_pair(const pe_manifold *m, pe_pair pair)
{
    return m->a < pair.a || (m->a == pair.a && m->b < pair.b);
}

/* Whether a pass in which these bodies have moved (NULL: all) looks at the pair. */
static inline bool pe_looks_at(const bool *moved, int a, int b)
{
    return moved == NULL || moved[a] || moved[b];
}

/* Appends to search->found, from the first old manifold on that no pair has passed yet, those of bodies
 * that have not moved, up to the pair. */
pe_status pe_copy_unmoved(pe_search *search, const bool *moved, pe_pair until);

/* Appends the pair's manifolds: the old ones moved along with the bodies, or new ones, or none. The
 * pairs of a search come in order, and search->next is at their first old manifold, or before it. */
pe_status pe_find_pair(pe_search *search, pe_pair pair);

#endif
