/* A bound on the energy of what stands on the ground.
 *
 * Contacts take energy, or give it to no one. One sweep a substep does not always see to that: a
 * light body jammed between a heavy one and the floor is pushed out faster than the relaxing sweep
 * can take back. So an island with a static body in it whose kinetic energy has grown by more than
 * what its loads have done,
 *
 *   T' > T + max(0, sum (m g + f).d + tau.theta)
 *
 * has its velocities scaled down to that. An island without one is left alone, for its momentum. */
#ifndef PE_SOFT_GUARD_H
#define PE_SOFT_GUARD_H

#include "soft/line.h"

/* The kinetic energy, in J, of each chosen island, into energy (islands->count). */
void pe_guard_measure(const pe_islands *islands, const bool *chosen, const pe_lines *lines,
                      double *energy);

/* Scales the velocities of the lines; `energy` is that of the step's start, the displacements those
 * of the whole step. Returns how many islands were scaled. */
int pe_guard_apply(const pe_world *world, const pe_islands *islands, const bool *chosen,
                   const pe_lines *lines, const double *energy);

#endif
