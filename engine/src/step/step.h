/* One step on its way, and the phases that it passes through.
 *
 * All phases take the step's context, which holds what they share. Arrays have one item for every
 * slot of the world, unless noted, and live in the step's arena. */
#ifndef PE_STEP_H
#define PE_STEP_H

#include "contact/contact.h"
#include "problem/problem_build.h"
#include "solver/solve_island.h"

/* Islands of a piece, in loops over islands on the threads of the world. */
enum { PE_ISLAND_GRAIN = 64 };

/* The context of a step. */
typedef struct pe_step {
    pe_world *world;
    double dt; /* s */
    pe_contact_rules rules;
    pe_error *error; /* NULL allowed */
    pe_step_stats stats;
    double residual_squares; /* (m/s)^2, summed over the points that were solved */
    int residual_points;

    /* At the step's start. */
    pe_islands islands;
    pe_saved_pose *poses; /* the world's start_pose_array */
    pe_twist *twists;
    pe_free_motion *free; /* the step without contacts */

    bool *soft;            /* (islands): solved by soft contact */
    bool *held;            /* (islands): kept at rest as they were, from velocities of zero */
    bool *moves;           /* bodies whose island was not left as it is (pe_island_hold) */
    bool *solved_directly; /* bodies whose island was not swept */

    bool stale;   /* contacts are to be found before the step: bodies, materials or dt changed */
    bool repeats; /* same forces, dt and bodies as in the step before */

    bool *corrected;                  /* bodies that position correction moved */
    pe_saved_pose *uncorrected_poses; /* of these, before it did; NULL: not yet */
    pe_twist *uncorrected_twists;
    int *parted; /* (slots): a forest of the bodies that correction pushed apart; NULL: not yet */
    pe_islands end_islands; /* of the contacts that were found last */
    bool has_end_islands;
    const int
        *group_place; /* (slots): below 0 where the energy guard left the body alone; NULL before */
    double *way; /* (slots) m: how far correction has moved a point of the body; NULL: not yet */
    double *overlap; /* (slots) m: deepest overlap of the body before correction */
    double shallow;  /* m: the energy guard does not put back bodies that were moved farther */
} pe_step;

/* PE_BAD_ARGUMENT unless dt is a finite number above 0. */
pe_status pe_check_dt(double dt, pe_error *error);

/* ---- Islands (island_step.c) ---- */

/* An island on its way through the step. The caller sets the interval. */
typedef struct pe_island_item {
    pe_interval interval;
    pe_island_problem island;
    pe_solving solving;
    pe_record record; /* of the island */
    bool exact;       /* solved as exactly as rounding allows */
    pe_solve_history history;
    pe_solve_mark marks[PE_HISTORY];
} pe_island_item;

/* An island in which two bodies in contact differ in mass by more is uneven. */
static const double PE_UNEVEN = 8;

/* The largest ratio of the masses of two bodies in contact in island k; 1 where there are none. */
double pe_island_mass_ratio(const pe_world *world, const pe_islands *islands, int k);

/* Holds island k, if the last step tried to solve it in vain from the same state: its bodies were at
 * rest and were put back by the energy guard, and the solvers wait. Returns whether it is held. It
 * keeps its poses and impulses then, which is what the same work would end with. */
bool pe_island_hold(pe_step *step, int k);

/* Builds the island's contact problem and begins to solve it: item->solving may ask for sweeps. */
pe_status pe_island_begin(pe_step *step, pe_island_item *item);

/* Ends the solve, moves the bodies as pe_island_step does, and stores the impulses. */
pe_status pe_island_end(pe_step *step, pe_island_item *item);

/* Leaves an island as it was at the step's start, with velocities of zero, if it was still and its
 * velocities have hardly changed. Flags it in step->held if its velocities were zero. */
void pe_hold_island(pe_step *step, int k);

/* Whether all bodies of island k are slower than `most`, in m/s, and have no applied force. */
bool pe_is_slow(const pe_step *step, const pe_islands *islands, int k, double most);

/* Steps all islands: their velocities, and the poses that follow from them. Fills step->soft and
 * step->solved_directly (solve_islands.c). */
pe_status pe_solve_islands(pe_step *step);

/* Builds and solves the island's contact problem, and counts it in step->stats. */
pe_status pe_island_solve(pe_step *step, pe_interval *interval, pe_island_problem *island);

/* The same, and moves the bodies by it (pe_island_move) and stores the impulses in the contacts. */
pe_status pe_island_step(pe_step *step, pe_interval *interval);

/* How a body of an island has moved in an interval. */
typedef struct pe_moved {
    double (*mean)[6]; /* (bodies + 1): mean velocities; the last item is that of static bodies */
    bool *late;        /* (bodies + 1): moved by its new velocity, as by an impulse at the start */
} pe_moved;

/* Moves the bodies of a solved island over the interval (island_motion.c).
 *
 * A body moves by the mean of old and new velocity, which is exact for constant forces and of
 * second order otherwise. Where a contact closes within the step this would move its bodies into
 * each other, and where its impulse acts along the velocities it would add energy,
 * p.(u_old + u_new)/2. So where
 *
 *   phi + h u_n < min(0, phi) at the mean velocities, or p.(u_old + u_new) > 0 over a manifold
 *
 * both bodies move by the new velocities, with all bodies that they push, and so on until there is
 * no such contact. These bodies get their impulses at the step's start and move freely from there:
 * they lose at least |v_new - v_old|_M^2/2 of energy. */
pe_status pe_island_move(pe_step *step, const pe_interval *interval,
                         const pe_island_problem *island, pe_moved *moved);

/* Moves a body that touches nothing over dt, in s. Without a torque its rotation is integrated by a
 * rule of fourth order. `free` (slots): the motion without contacts. */
void pe_integrate_free(pe_world *world, int slot, const pe_free_motion *free, double dt);

/* Lists the island's contacts apart, with their impulses over the interval, which ends at `end`, in
 * s since the start of the step. `moved` NULL: an impact, which took no time. Called when the
 * impulses are stored and the bodies have moved (contact_report.c). */
pe_status pe_list_apart(pe_step *step, const pe_interval *interval, double end,
                        const pe_island_problem *island, const pe_moved *moved);

/* ---- Rest (rest_islands.c) ---- */

/* Puts held islands at rest (rest.h) which the rest of the step has left as they were. */
pe_status pe_rest_islands(pe_step *step);

/* Wakes, at the start of a step, the islands with an applied force, and all if contacts are stale. */
pe_status pe_wake_changed(pe_step *step);

/* Wakes islands at rest that have a contact in world->contacts, and has them take part in the step.
 * Called whenever contacts were found. */
pe_status pe_wake_touched(pe_step *step);

/* pe_contacts_update, and pe_wake_touched. */
pe_status pe_update_contacts(pe_step *step, const bool *moved);

/* ---- Islands in parts (island_parts.c) ---- */

/* Takes island k through the step in parts, if an impact that may bounce can have its own time in one
 * of them. The parts are the islands of the contacts that act: that pushed in the last step, or close
 * in this one. Each is stepped by itself, in sub-steps if it has an impact and is small. Parts that
 * have met then go back and are stepped again as one, with all others that they may reach; after
 * three such rounds the island is stepped whole. Where a part too large for sub-steps was stepped in
 * vain, the island is not divided again for 1, 2, 4, up to 64 impacts.
 *
 * *done: false where nothing is done, because no part has such an impact. *path is that of
 * the worst part, and step->solved_directly is set. */
pe_status pe_parts_step(pe_step *step, int k, bool *done, pe_path *path);

/* ---- Position correction (correct_islands.c, position_correction.c, overlap.c) ---- */

/* Corrects all penetration in islands that were solved directly, and that over some slops in all,
 * as the profile says. */
pe_status pe_correct_islands(pe_step *step);

/* One of the solvers of solve.h; the tolerance is in m. */
typedef pe_status pe_correction_solver(const pe_problem *problem, const pe_solve_limits *limits,
                                       pe_workspace work, pe_solve_report *report, pe_error *error);

/* What is corrected, how far, and by which work. */
typedef struct pe_correction_rules {
    double begin;   /* m, > aim + enough: islands with a deeper contact that counts are corrected */
    double aim;     /* m: the depth that is left alone */
    double enough;  /* m: solved when no contact is deeper than aim + enough */
    int max_sweeps; /* of an island and round */
    int max_rounds;

    /* Only islands whose first body is flagged in `among` (slots; NULL: all) are corrected, and
     * only contacts of flagged bodies count. */
    const bool *among;

    /* Solves islands whole, within these limits. Where it finds nothing better than the poses as
     * they are, the island is swept. NULL: islands are swept at once. */
    pe_correction_solver *solver;
    pe_solve_limits solver_limits;
} pe_correction_rules;

/* Begins at 3e-4 m, aims at 1e-4, has enough within 5e-5; 200 sweeps, 8 rounds; all islands, no
 * solver. */
pe_correction_rules pe_correction_rules_default(void);

/* What a correction did. */
typedef struct pe_correction_report {
    int rounds;
    int iterations;          /* of sweeps or solver, largest over islands and rounds */
    double penetration;      /* m, deepest before */
    double penetration_left; /* m, deepest after */
} pe_correction_report;

/* Removes penetration by moving bodies; momenta stay. Corrects each island that has a contact
 * deeper than rules->begin, finds the contacts of the moved bodies again, and repeats this while
 * there is such an island, at most rules->max_rounds times. The round with the least sum of squared
 * violations of phi >= -aim wins: if the last one is not it, bodies go back to there. Flags the bodies
 * that were moved in step->corrected. No point of a
 * body moves by more than a fifth of its least extent, and the way of its speed, in all corrections
 * of a step.
 *
 * world->contacts must be those at the poses now, and are so afterwards, with their impulses. On
 * PE_NO_MEMORY some bodies may have been moved, and world->contacts be those of other poses. */
pe_status pe_correct_positions(pe_step *step, const pe_correction_rules *rules,
                               pe_correction_report *report);

/* Notes the overlap of all bodies before the first correction, to compare it with that after: bodies
 * that were not parted, as between static ones on both sides, are left alone for 1, 2, 4, up to 64
 * steps. An overlap is a contact deeper than a twentieth of the least extent of its smaller body. */
pe_status pe_overlap_begin(pe_step *step);
/* The same, after the last. */
pe_status pe_overlap_end(pe_step *step);

/* ---- Energy (energy_guard.c) ---- */

/* What the energy guard did. */
typedef struct pe_energy_report {
    int islands;    /* that had gained energy */
    double removed; /* J */
    int put_back;   /* islands in which bodies were put back */
} pe_energy_report;

/* Takes back the energy that islands have gained in the step except by the forces on them; called
 * when bodies have moved and positions are corrected.
 *
 * Contacts, with friction and restitution up to 1, can only take energy from an island. Unconverged
 * solves, bounces before the surface is reached and position correction give it some. An island
 * whose kinetic energy grew by more than the work of gravity and applied forces, which follow from
 * step->free, along the displacements of its bodies,
 *
 *   dE = sum T(end) - T(begin) - F . dx - h tau . w     (w the mean of both angular velocities),
 *
 * pays with its motion. What its bodies move besides the motion of the whole, which has all its
 * momenta, is scaled by sqrt(1 - dE/T(besides)); if that is not enough, all velocities are scaled
 * by sqrt(1 - dE/T(end)). If there is not that much motion, the energy
 * came from position correction. Then the island comes to rest, and goes back to where it was, to
 * lie as deep as before, unless a body was moved by more than step->shallow: deeper penetration is
 * removed at any cost. Growth within rounding is left alone.
 *
 * Soft contacts yield. To lift a load out of the depth that it sank to costs energy, which is not
 * taken back: the growth may be up to the sum over the contacts of soft islands of
 *
 *   (normal impulse / dt) x (depth removed in the step, at most that of its start),
 *
 * but not above what the bodies that rose have gained of height: motion gets none of it.
 *
 * Contacts that were solved directly do not sink, so that motion under them is no error, and may be
 * the beginning of a fall. There position correction alone is taken back, already if it would cost
 * half of the speed, and waits until motion can pay for it. The tiny lift by which contacts remove
 * rounding is left alone. Position correction alone is also taken back where an island that was
 * swept has moved too far to go back to where it was. Exact position correction that was taken back
 * is not tried again for 1, 2, 4, up to 64 steps.
 *
 * To scale all velocities costs momentum. So an island whose bodies were all solved directly, or have
 * no contact, and none of them corrected, may gain a millionth: the error of finite steps.
 *
 * `groups` are bodies that touch (pe_islands_find_touching; only their lists of bodies are read).
 * Bodies in no group are left alone except those in step->corrected, of which each is a group by
 * itself. Flags in `put_back` (slots, all false before) the bodies whose poses were changed: their
 * contacts in world->contacts are those of other poses then. */
void pe_energy_guard(const pe_step *step, const pe_islands *groups, bool *put_back,
                     pe_energy_report *report);

/* ---- Bounds of a step (motion_bound.c) ---- */

/* Where the contact problem of an island was solved so badly that its kinetic energy is over four
 * times what it was before the step and is without contacts, together: takes the bodies back to the
 * step's start, scales the new velocities to that energy, and moves the bodies by these. */
void pe_bound_energy(pe_step *step);

/* PE_NOT_FINITE, with the body and the number, unless all states are finite and within what
 * collision can take: 1e15 m, 1e30 m/s and rad/s. After the energy guard only what it or position
 * correction may have changed is looked at. */
pe_status pe_check_motion(const pe_step *step);

/* The same of these bodies, before collision within the step. */
pe_status pe_check_bodies(const pe_step *step, const int *slots, int count);

/* Takes back what a body, or by rotation its farthest point, has moved in the step beyond
 *
 *   dt (max(|v|, |v'|) + |v* - v|) + a quarter of the least extent,
 *
 * where v' is the velocity at the end and v* that without contacts: it moved by a velocity that the
 * energy guard took, or was pushed out too fast. A point at the bounding radius R may move as far by
 * rotation, and by R times the same of the angular velocity, with dt w^2 more for what rotation
 * without a torque may add.
 * Flags these bodies (slots), whose contacts in world->contacts are those of other poses then.
 * Returns whether there are any. */
bool pe_bound_motion(const pe_step *step, bool *put_back);

#endif
