/* Which pairs of bodies are near enough to be looked at closely. */
#ifndef PE_BROAD_PHASE_H
#define PE_BROAD_PHASE_H

#include "broad_phase_state.h"
#include "model/world.h"

/* How far, in m, the surfaces of two bodies can come towards each other within a step of dt, and
 * the contact margin: pairs with a smaller gap need contacts now. Bound: relative velocity, each
 * body's rotation at its bounding radius, and one step of gravity. */
double pe_pair_margin(const pe_world *world, int a, int b, double dt);

/* Its parts: pe_pair_margin is dt times the relative speed and both bodies' pe_spin_speed, and the
 * slack. pe_spin_speed, in m/s, is what its rotation gives the outermost point of a body. */
double pe_spin_speed(const pe_world *world, int slot);
double pe_margin_slack(const pe_world *world, double dt);

/* All pairs whose gap may be below their margin, and few others, sorted by (a, b), in the step's
 * arena. Pairs are kept from call to call: what does not move costs next to nothing (see
 * broad_phase.c). On PE_NO_MEMORY the next call makes up for it. */
pe_status pe_broad_phase(pe_world *world, double dt, pe_pair **pairs, int *count, pe_error *error);

/* The same at the poses now, but only the pairs with a body flagged in `moved` (slot_count); NULL:
 * all of them. */
pe_status pe_broad_phase_moved(pe_world *world, double dt, const bool *moved, pe_pair **pairs,
                               int *count, pe_error *error);

/* Releases what the broad phase keeps. */
void pe_broad_free(pe_broad *broad, const pe_allocator *allocator);

#endif
