/* The contacts of a step: the narrow phase over all pairs, and what persists from step to step:
 * impulses, and the manifolds of pairs that stand still relative to each other. */
#ifndef PE_CONTACT_H
#define PE_CONTACT_H

#include "broad_phase/broad_phase.h"

typedef struct pe_contact_rules {
    /* A manifold is kept, its points carried along by the two bodies, while no point of either body
     * has moved relative to the other by more than this since the manifold was built, in units of
     * the smaller body. Vertices then err by at most that, points where edges cross by that over
     * the sine of their angle, and separations by as much times the sine of the angle between the
     * two faces. 0: never kept. */
    double reuse_tolerance;
    int most_points; /* a manifold, 4 .. PE_MAX_POINTS; what is over is reduced to that many */
} pe_contact_rules;

/* Every digit: reuse within 1e-9, PE_MAX_POINTS points. */
pe_contact_rules pe_contact_rules_exact(void);

/* Finds the manifolds of the pairs (count of them, sorted by (a, b)) into world->contacts, sorted
 * in the same way, and keeps the last step's in world->previous. Each point takes over the impulse
 * of the same pair's old point on the same features, or else of the nearest one that is left; an
 * impulse that would pull is dropped. On failure world->contacts is as it was. */
pe_status pe_contacts_find_by(pe_world *world, const pe_contact_rules *rules, const pe_pair *pairs,
                              int count, double dt, pe_error *error);

/* The same by the exact rules. */
pe_status pe_contacts_find(pe_world *world, const pe_pair *pairs, int count, double dt,
                           pe_error *error);

/* Scales the impulses that were taken over when dt is not the last step's. */
void pe_contacts_match(pe_world *world, double dt);

/* After some bodies were moved within the step: finds the manifolds of every pair with a body
 * flagged in `moved` (slot_count) again, at the poses now, just as pe_contacts_find_by would. The
 * pairs (sorted) must hold all those of moved bodies whose gap is now below their margin:
 * pe_broad_phase_moved gives just these, and the step's own pairs serve as long as no point of a
 * body has moved by more than a half of the contact margin. Pairs without a moved body are passed
 * over. All other manifolds stay as they are, to the bit, impulses too. The order stays (a, b), but
 * indices of manifolds and points may change. Nothing is allocated beyond the largest list so far.
 * On failure world->contacts is as it was; else world->previous is the list that was replaced. */
pe_status pe_contacts_refind(pe_world *world, const pe_contact_rules *rules, const pe_pair *pairs,
                             int count, const bool *moved, double dt, pe_error *error);

#endif
