/* The contacts of a step: the narrow phase over all pairs, and the impulses that persist. */
#ifndef PE_CONTACT_H
#define PE_CONTACT_H

#include "broad_phase.h"

/* Finds the manifolds of the pairs (count of them, sorted) into world->contacts, and keeps the last
 * step's in world->previous. On failure world->contacts is as it was. */
pe_status pe_contacts_find(pe_world *world, const pe_pair *pairs, int count, double dt,
                           pe_error *error);

/* Gives each new point the impulse of the last step's point on the same features, or else of the
 * nearest unmatched one of the same pair; scaled when the step has changed. */
void pe_contacts_match(pe_world *world, double dt);

#endif
