/* No island gains energy in a step but from the loads on it. */
#ifndef PE_ENERGY_GUARD_H
#define PE_ENERGY_GUARD_H

#include "model/integrate.h"
#include "model/island.h"

/* A step just before its end, when bodies have moved and been projected. */
typedef struct pe_energy_step {
    double dt;                  /* s */
    const pe_free_motion *free; /* (slots): the step's motion without contacts */
    const pe_pose *poses;       /* (slots): at the step's begin */
    const pe_twist *motions;
    const bool *moved;                /* (slots): bodies that projection moved; NULL: none */
    const pe_pose *unprojected_poses; /* (slots): before it did; read of bodies in `moved` alone */
    const pe_twist *unprojected_motions;
    const bool *solved; /* (slots): bodies whose contacts were solved directly, or had none */
    double shallow;     /* m: bodies that were moved farther are not put back */
} pe_energy_step;

typedef struct pe_energy_report {
    int islands;    /* that had gained energy */
    double removed; /* J, taken back */
    int put_back;   /* islands in which bodies were put back */
} pe_energy_report;

/* Contacts, with friction and restitution up to 1, can only take energy from an island; unconverged
 * solves, bounces before the surface is reached and projections give it some. An island whose
 * kinetic energy grew by more than what gravity and loads, which follow from step->free, did along
 * the way of its bodies,
 *
 *   dE = sum T(end) - T(begin) - F . dx - h tau . w     (w the mean of both angular velocities),
 *
 * gets its velocities scaled by sqrt(1 - dE/T(end)). If there is not that much motion, what lifted
 * it was the projection. Then the island comes to rest, and goes back to where it was, to lie as
 * deep as before, unless a body was moved by more than step->shallow: what is deeper is pushed out
 * at any price. Growth within rounding is left alone.
 *
 * Contacts that were solved do not sink, so that motion under them is no error, and may be the
 * begin of a fall. There projection alone is taken back, already if it would cost half of the
 * speed, and waits until motion can pay; what contacts lift to take back rounding is left alone.
 *
 * To scale velocities costs momentum. So an island all of whose bodies are in step->solved and none
 * in step->moved may gain a millionth: its contacts took what they had to, and what is left is the
 * error of moving in finite steps.
 *
 * `islands` are groups that touch (pe_islands_find_touching; their lists of bodies alone are read).
 * Bodies in no group are left alone but those in step->moved: each is a group by itself.
 *
 * Flags in `put_back` (slots, all false before) the bodies whose poses were changed: their contacts
 * in world->contacts are those of other poses then. */
void pe_energy_guard(pe_world *world, const pe_islands *islands, const pe_energy_step *step,
                     bool *put_back, pe_energy_report *report);

#endif
