/* Impacts at their own time within the step. */
#ifndef PE_IMPACT_H
#define PE_IMPACT_H

#include "contact/contact.h"
#include "island_step.h"

/* Whether an island small enough (pe_world_def.impact_bodies) has a contact that closes within dt
 * faster than gravity alone would make it. What bodies with torques on them do is left to the
 * ordinary step: the energy guard reckons the torques' work over a whole one. */
bool pe_impact_is_due(const pe_world *world, const pe_islands *islands, int k, double dt);

/* What pe_island_step does, in parts: the island moves up to its first impact, with the contacts
 * that are not about to strike; that impact is solved in an instant, at the poses that it happens
 * at; and so on over what is left of dt, which after a few impacts is an ordinary step. An ordinary
 * step alone would spread an impact over two, or let it act at the step's start and over the gap.
 * (Event detection in the manner of Pfeiffer and Glocker 1996, Multibody Dynamics with Unilateral
 * Contacts, within a time-stepping scheme.)
 *
 * The island's points in world->contacts get the impulses of all parts, those of contacts that are
 * gone from a part on the nearest point of the pair. `free` (slots) is left alone: it is the whole
 * step's. */
pe_status pe_impact_step(pe_world *world, const pe_islands *islands, int k,
                         const pe_contact_rules *rules, double dt, pe_solve_tally *tally,
                         pe_path *path, pe_error *error);

#endif
