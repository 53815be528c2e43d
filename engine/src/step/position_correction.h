/* Penetration removed by moving bodies; no energy of motion enters.
 *
 *   min |d|_M  subject to  J_n d + phi >= -aim  at every contact, open ones too,
 *
 * is a contact problem without friction in which d, m and rad, stands for the velocity, phi + aim
 * for the bias, and nothing moves freely: pe_project_problem makes it, and any solver of contact
 * problems solves it. */
#ifndef PE_PROJECT_H
#define PE_PROJECT_H

#include "contact/contact.h"
#include "problem/problem_build.h"
#include "solver/solve.h"

/* One of the solvers of solve.h; the tolerance is in m. */
typedef pe_status pe_project_solver(const pe_problem *problem, const pe_solve_limits *limits,
                                    pe_workspace work, pe_solve_report *report, pe_error *error);

typedef struct pe_project_rules {
    double begin;   /* m, > aim + enough: islands with a deeper contact that counts are projected */
    double aim;     /* m: the depth that is left alone */
    double enough;  /* m: solved when no contact is deeper than aim + enough */
    int max_sweeps; /* an island and round */
    int max_rounds;

    /* Only islands whose first body is flagged in `among` (slots; NULL: all) are projected, and
     * only contacts of flagged bodies count. */
    const bool *among;

    /* Solves islands whole, within these limits; where it finds nothing better than standing still,
     * they are swept. NULL: they are swept at once. */
    pe_project_solver *solver;
    pe_solve_limits solver_limits;
} pe_project_rules;

/* Begins at 3e-4 m, aims at 1e-4, has enough within 5e-5; 200 sweeps, 8 rounds; all islands, no
 * solver. */
pe_project_rules pe_project_rules_default(void);

typedef struct pe_project_report {
    int rounds;
    int iterations;          /* of sweeps or solver, largest over islands and rounds */
    double penetration;      /* m, deepest before */
    double penetration_left; /* m, deepest after */
    const bool *moved;       /* (slots), in the step's arena: bodies that were moved; NULL: none */
    const pe_pose *poses;    /* (slots), likewise: before any was moved; NULL where `moved` is */
    const pe_twist *motions;
} pe_project_report;

/* Projects each island that has a contact deeper than rules->begin, finds the contacts of what it
 * moved again, and goes on so while there is such an island, at most rules->max_rounds times.
 *
 * world->contacts must be those at the poses now, and are so afterwards, impulses handed on
 * (pe_contacts_refind with `contact_rules` and `dt`). Momenta stay. The round with the least sum of
 * squared violations of phi >= -aim wins: if the last one is not it, bodies go back to there. What
 * is left is reported. An island is not swept whole: sweeping begins at the bodies of violated
 * contacts and reaches those that get pushed.
 *
 * PE_NO_MEMORY: some bodies may have been moved, and world->contacts be behind. */
pe_status pe_project_positions(pe_world *world, const pe_project_rules *rules,
                               const pe_contact_rules *contact_rules, double dt,
                               pe_project_report *report, pe_error *error);

/* The problem above for island k: impulses, velocities and free velocities 0. */
pe_status pe_project_problem(pe_world *world, const pe_islands *islands, int k, double aim,
                             pe_island_problem *built, pe_error *error);

#endif
