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
    int most_sweeps;
    int max_iterations;      /* of all solvers together */
    pe_pattern_store *store; /* NULL: patterns are not kept */
    double patience;         /* how many times the cost of those updates a direct solve may have */
    bool rough;              /* islands of one or two bodies that move may keep some residual */
    bool direct_waits;       /* the direct solver failed lately: see below */
    bool settling_waits;     /* so did the sweeps of an island that is nearly solved */
} pe_island_limits;

/* How an island was solved. */
typedef struct pe_island_report {
    pe_path path;
    bool direct_failed;   /* the direct solver ran, and failed or took too many iterations */
    bool settling_failed; /* the few plain sweeps gained less than a hundredth */
    pe_solve_report solve;
} pe_island_report;

/* Which solvers an island gets. */
typedef struct pe_island_plan {
    bool cold;  /* no impulse to start from */
    bool whole; /* the whole direct solver */
    bool trial; /* a few Newton iterations before and after the sweeps */
    int sweeps; /* that max_updates allows: a direct solve is weighed against their cost */
    pe_pattern pattern;
} pe_island_plan;

/* An island on its way through the solvers. */
typedef struct pe_solving {
    const pe_problem *problem; /* borrowed */
    pe_island_limits limits;
    pe_island_report report;
    pe_island_plan plan;
    int sweeps;       /* asked for; 0: none */
    double enough;    /* m/s: to which residual */
    double warm;      /* m/s: the residual of the warm start */
    double before;    /* m/s: that before sweeps */
    double least_aim; /* m/s: with less a tiny island gets no more than Newton and sweeps */
} pe_solving;

/* The three steps of a solve from the warm start in problem->impulse. The caller sets the problem and
 * the limits.
 *
 * - A warm start far below the tolerance is kept as it is.
 * - A quiet or new island gets the whole direct solver if its predicted cost is within bounds.
 * - Another one gets a few Newton iterations where these are cheap compared with sweeps, then
 *   sweeps with momentum to swept_tolerance where they were not enough, then a few Newton iterations
 *   again.
 * - One within swept_tolerance that is not solved gets a few plain sweeps, so that what is at rest
 *   settles over the steps.
 * - With direct_waits only quiet chains get the direct solver, and what is within 1e-6 m/s a few
 *   iterations of it.
 * - An island of one or two bodies gets pe_solve_tiny, a trial of the direct solver, a few sweeps,
 *   pe_solve_tiny again and the direct solver, one after the other until it is solved. If it is not
 *   quiet, and with `rough`, swept_tolerance is good enough for the last. */
pe_status pe_solving_begin(pe_solving *s, pe_workspace work, pe_error *error);

/* Sweeps islands that ask for the same at once, which fills the lanes. */
pe_status pe_solving_sweep(pe_solving *const *islands, int count, pe_workspace work,
                           pe_error *error);

/* Ends the solve of an island that was swept, if it asked for that. */
pe_status pe_solving_finish(pe_solving *s, pe_workspace work, pe_error *error);

/* The three steps in turn, for an island by itself. */
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
