/* One island over a stretch of time: its contact problem, the solver that it gets, and the move. */
#ifndef PE_ISLAND_STEP_H
#define PE_ISLAND_STEP_H

#include "plumb/engine.h"
#include "problem/problem_build.h"

/* What the solves of a step add up to. */
typedef struct pe_solve_tally {
    pe_step_stats *stats; /* the worst residual, and how it came; the most iterations */
    double squares;       /* of the residual of every point, (m/s)^2 */
    int points;
} pe_solve_tally;

/* Builds and solves the problem of island k over dt. `free` (slots) is the motion without contacts.
 * *path is what solved it. */
pe_status pe_island_solve(pe_world *world, const pe_islands *islands, int k,
                          const pe_free_motion *free, double dt, pe_solve_tally *tally,
                          pe_island_problem *island, pe_path *path, pe_error *error);

/* The same, moves the bodies by it and stores the impulses in the contacts. */
pe_status pe_island_step(pe_world *world, const pe_islands *islands, int k,
                         const pe_free_motion *free, double dt, pe_solve_tally *tally,
                         pe_path *path, pe_error *error);

#endif
