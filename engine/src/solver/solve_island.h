/* Which solver an island gets: by predicted cost, from counts and residuals, never from the clock.
 */
#ifndef PE_SOLVE_ISLAND_H
#define PE_SOLVE_ISLAND_H

#include "solve.h"
#include "sparse/pattern_store.h"

typedef struct pe_island_limits {
    double tolerance;       /* m/s */
    double swept_tolerance; /* m/s: what sweeps stop at, and what is not good enough without them */
    double max_updates;     /* contact points visited by sweeps */
    int max_iterations;     /* of all solvers together */
    pe_pattern_store *store; /* NULL: patterns are not kept */
    double patience; /* how much dearer than those sweeps a direct solve may be to be preferred */
} pe_island_limits;

typedef struct pe_island_report {
    pe_path path;
    pe_solve_report solve;
} pe_island_report;

/* Solves from the warm start in problem->impulse:
 *
 * - a warm start far below the tolerance is kept as it is;
 * - a quiet or new island gets the direct solver, whole, if its predicted cost is within bounds;
 * - another gets a few Newton iterations where they are cheap beside sweeps, sweeps with momentum
 * to swept_tolerance where they did not do, and a few Newton iterations again from there. */
pe_status pe_solve_island(const pe_problem *problem, const pe_island_limits *limits,
                          pe_workspace work, pe_island_report *report, pe_error *error);

#endif
