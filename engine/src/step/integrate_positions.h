/* Poses by velocities: second order between impacts, no sinking in at them. */
#ifndef PE_ADVANCE_H
#define PE_ADVANCE_H

#include "model/integrate.h"
#include "problem/problem_build.h"

/* Moves the bodies of a solved island over dt and gives them their new velocities.
 *
 * A body moves by the mean of old and new velocity, exact for constant forces and second order
 * else. Where a contact closes within the step this would carry its bodies into each other, and
 * where its impulse acts along the velocities it would add energy, p.(u_old + u_new)/2:
 *
 *   phi + h u_n < min(0, phi) at the mean velocities, or p.(u_old + u_new) > 0 over a manifold
 *
 * lets both bodies move by the new velocities, with all that they push, and so on until there is
 * none. Those get their impulses at the step's start and fly freely from there: they lose at least
 * |v_new - v_old|_M^2/2 of energy. `free` (slots) is the motion without contacts. */
pe_status pe_integrate_island(pe_world *world, const pe_island_problem *island,
                              const pe_free_motion *free, double dt, pe_error *error);

/* The same for a body that touches nothing. One that no torque acts on turns by a rule of fourth
 * order, but in the fast profile. */
void pe_integrate_free(pe_world *world, int slot, const pe_free_motion *free, double dt);

#endif
