/* Which solver an island gets, and the direct solver. The choice follows from a predicted cost,
 * from counts and residuals, never from the clock. */
#ifndef PE_SOLVE_ISLAND_H
#define PE_SOLVE_ISLAND_H

#include "solve_newton.h"
#include "sparse/pattern_store.h"

/* What an island may cost, and how exactly it is to be solved. */
typedef struct pe_island_limits {
    double tolerance; /* m/s */
    double
        swept_tolerance; /* m/s: sweeps stop at this, and are made where the residual is above it */
    double max_updates;  /* contact points visited by sweeps */
    int max_iterations;  /* of all solvers together */
    pe_pattern_store *store; /* NULL: patterns are not kept */
    double patience;         /* how many times the cost of those sweeps a direct solve may have */
} pe_island_limits;

/* How an island was solved. */
typedef struct pe_island_report {
    pe_path path;
    pe_solve_report solve;
} pe_island_report;

/* Solves from the warm start in problem->impulse:
 *
 * - a warm start far below the tolerance is kept as it is;
 * - a quiet or new island gets the whole direct solver if its predicted cost is within bounds;
 * - another one gets a few Newton iterations where these are cheap compared with sweeps, then
 *   sweeps with momentum to swept_tolerance where they were not enough, then a few Newton iterations
 *   again. */
pe_status pe_solve_island(const pe_problem *problem, const pe_island_limits *limits,
                          pe_workspace work, pe_island_report *report, pe_error *error);

/* The direct solver, from the warm start and in this order until the residual is met:
 *
 * 1. Newton's method with these settings, whose pattern counts the manifolds that are expected to
 * carry;
 * 2. the interior point method on the convex problem, with De Saxce's shift renewed between rounds,
 * each round refined by Newton's method in the Tresca form.
 *
 * Iterations are factorisations. The best of all iterates is left. */
pe_status pe_solve_direct(const pe_problem *problem, const pe_newton_settings *settings,
                          const pe_solve_limits *limits, pe_workspace work, pe_solve_report *report,
                          pe_error *error);

#endif
