/* Impacts at their own time: when a contact is one, which islands take them, and their sub-steps. */
#ifndef PE_IMPACT_H
#define PE_IMPACT_H

#include "step.h"

/* m/s: by how much gravity changes a velocity in a step. */
static inline double pe_fall(const pe_world *world, double dt)
{
    return dt * pe_length(world->def.gravity);
}

/* m/s: no impact. Contacts that bounce would do so ever faster below the speed that gravity gives in a
 * step; others stop at once, and a quarter of that is enough. */
static inline double pe_slow_closing(const pe_world *world, const pe_manifold *m, double dt)
{
    return pe_max((m->restitution > 0 ? 1 : 0.25) * pe_fall(world, dt), 1e-9);
}

/* m: a gap up to this is closed, and penetration up to this is no overshoot. Where impacts bounce, an
 * error of the gap is one of their energy. */
static const double PE_CLOSED = 1e-8;
static const double PE_CLOSED_TO_BOUNCE = 1e-11;

/* m: a gap of the manifold up to this is closed. */
static inline double pe_closed_gap(const pe_manifold *m)
{
    return m->restitution > 0 ? PE_CLOSED_TO_BOUNCE : PE_CLOSED;
}

/* Whether a contact of the island closes within the step faster than gravity alone would make it. */
bool pe_impact_is_due(const pe_step *step, const pe_islands *islands, int k);

/* Whether a contact of the island has restitution. */
bool pe_may_bounce(const pe_world *world, const pe_islands *islands, int k);

/* Whether an impact is due and the island small enough (pe_world_def.impact_bodies) to be taken
 * through sub-steps; eight times as many bodies are if it may bounce and only impacts push. Bodies
 * with torques on them are left to the ordinary step, because the energy guard computes the torques'
 * work over a whole one. */
bool pe_impact_has_own_time(const pe_step *step, const pe_islands *islands, int k);

/* Does the work of pe_island_step in sub-steps: the island moves up to its first impact, with the
 * contacts that are not about to impact. That impact is solved in an instant, at the poses at which
 * it happens, and so on over the rest of dt. After a few impacts the rest is an ordinary step, and
 * sooner where the contacts of large meshes take long to find. An ordinary step alone would spread
 * an impact over two steps, or let it act at the step's start and over the gap. (Event detection in
 * the manner of Pfeiffer and Glocker 1996, Multibody Dynamics with Unilateral Contacts, within a
 * time-stepping scheme.)
 *
 * The island's points in world->contacts get the impulses of all sub-steps. The impulse of a point
 * that is no longer in that list goes to the nearest point of the pair. step->free stays that of
 * the whole step. */
pe_status pe_impact_step(pe_step *step, const pe_islands *islands, int k, pe_path *path);

#endif
