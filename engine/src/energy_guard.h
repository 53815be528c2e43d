/* No island gains energy in a step but from the loads on it. */
#ifndef PE_ENERGY_GUARD_H
#define PE_ENERGY_GUARD_H

#include "integrate.h"
#include "island.h"

typedef struct pe_energy_report {
    int islands;    /* that had gained energy */
    double removed; /* J, taken back */
    int put_back;   /* islands that had no motion to take it from: world->contacts are stale then */
} pe_energy_report;

/* Contacts, with friction and restitution up to 1, can only take energy from an island; unconverged
 * solves, bounces before the surface is reached and projections give it some. To be called at the
 * end of a step, when bodies have moved and been projected. An island whose kinetic energy grew by
 * more than what gravity and loads did along the way of its bodies,
 *
 *   dE = sum T(end) - T(begin) - F . dx - h tau . w     (w the mean of both angular velocities),
 *
 * gets its velocities scaled by sqrt(1 - dE/T(end)). If there is not that much motion, what lifted
 * it was the projection. Then the island comes to rest, and goes back to where it was, to lie as
 * deep as before, unless a body was moved by more than `shallow`, in m: what is deeper is pushed
 * out at any price. Growth within rounding is left alone.
 *
 * To scale velocities costs momentum. So an island whose first body is flagged in `solved` (slots),
 * and of which no body is in `moved`, may gain a millionth: its contacts took what they had to, and
 * what is left is the error of moving in finite steps.
 *
 * `islands` are groups that touch (pe_islands_find_touching; their lists of bodies alone are read),
 * `free` (slots) is the step's motion without contacts, from which F and tau follow; `poses` and
 * `motions` (slots) are from its begin. Bodies in no group are left alone but those in `moved`
 * (slots; NULL: none), moved by projection: each is a group by itself. */
void pe_energy_guard(pe_world *world, const pe_islands *islands, const pe_free_motion *free,
                     const pe_pose *poses, const pe_motion *motions, const bool *moved,
                     const bool *solved, double shallow, double dt, pe_energy_report *report);

#endif
