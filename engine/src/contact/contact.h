/* The contacts of a step: the narrow phase over all pairs, and what persists from step to step,
 * which is impulses and the manifolds of pairs at rest relative to each other. */
#ifndef PE_CONTACT_H
#define PE_CONTACT_H

#include "broad_phase/broad_phase.h"

/* When manifolds are kept, and how many points they have. */
typedef struct pe_contact_rules {
    /* A manifold is kept, its points transported by the two bodies, while no point of either body
     * has moved relative to the other by more than this since the manifold was built, in units of
     * the smaller body. Vertices then err by at most that. Points where edges cross err by that
     * over the sine of their angle, and separations by as much times the sine of the angle between
     * the two faces. 0: manifolds are never kept. */
    double reuse_tolerance;
    int most_points; /* of a manifold, 4 .. PE_MAX_POINTS; larger ones are reduced to 4 */
} pe_contact_rules;

/* Manifolds are kept within 1e-9, with up to PE_MAX_POINTS points. */
pe_contact_rules pe_contact_rules_exact(void);

/* Finds the manifolds of `pairs`, which are sorted by (a, b), at the poses now. They become
 * world->contacts, in the same order, and the list that was there becomes world->previous. Each
 * point takes over the impulse of the pair's old point on the same features, or else of the nearest
 * one that is left. An impulse that would pull is dropped.
 *
 * `moved` (slot_count), if not NULL, flags bodies that were moved within the step: only pairs with
 * such a body are looked at, and all other manifolds stay as they are, to the bit, impulses too.
 * `pairs` must hold all pairs of moved bodies whose gap is now below their margin. The pairs of the
 * step's start serve as long as no point of a body has moved by more than a half of the contact
 * margin. Indices of manifolds and points may change.
 *
 * Nothing is allocated beyond the largest list so far. On failure world->contacts is as it was. */
pe_status pe_contacts_find(pe_world *world, const pe_contact_rules *rules,
                           const pe_pair_list *pairs, const bool *moved, double dt,
                           pe_error *error);

/* pe_broad_phase, and pe_contacts_find with the pairs that it finds. */
pe_status pe_contacts_update(pe_world *world, const pe_contact_rules *rules, const bool *moved,
                             double dt, pe_error *error);

/* How deep two bodies overlap at the poses now, in m; 0 where they do not. */
pe_status pe_pair_overlap(pe_world *world, int a, int b, double *depth, pe_error *error);

/* Scales the impulses of world->contacts when dt, in s, is not the last step's. */
void pe_contacts_scale_impulses(pe_world *world, double dt);

#endif
