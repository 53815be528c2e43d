/* The solver benchmark: contact problems, solved by every solver from a warm and from a cold start,
 * to smaller and smaller residuals. */
#ifndef PLUMB_SOLVE_BENCHMARK_H
#define PLUMB_SOLVE_BENCHMARK_H

#include "plumb/contact_problem.h"

#include <stdbool.h>

enum { LEVELS = 4 };

/* The residuals to reach, m/s, from the largest to the smallest. */
extern const double level_tolerances[LEVELS];

/* The outcome of a solve that stops at one of these residuals. */
typedef struct level {
    bool reached;
    int iterations;    /* sweeps or factorisations */
    double seconds;    /* CPU time of the solver: the median of an odd number of repeats, up to 9 */
    pe_residual start; /* of the impulses that the solver starts from */
    pe_residual residual; /* of its solution */
    const char *stop;     /* why it ended, such as "converged" or "stalled"; static storage */
} level;

/* The levels that a solver reached from one start. */
typedef struct solver_run {
    pe_solver_info solver;
    bool cold;
    int count; /* of `levels`: up to the first that was not reached */
    level levels[LEVELS];
} solver_run;

/* A problem and the levels that each solver reached on it. */
typedef struct benchmark_problem {
    const char *path; /* of its file */
    char *name;       /* the file's name without folder and ".json" */
    pe_contact_problem *data;
    solver_run
        *runs; /* (2 x number of solvers): all from the warm start, then all from the cold one */
} benchmark_problem;

/* Solves a problem from its impulses or, `cold`, from zero. A process of its own does it, so that a
 * crash or a hang becomes a result. False: no process could be made (errno). */
bool solve_levels(const pe_contact_problem *problem, pe_solver_info solver, bool cold,
                  solver_run *run);

/* Prints all tables on standard output: first the levels that were not reached, then the solvers
 * that took longer than the first, then every problem. */
void print_tables(const benchmark_problem *problems, int problem_count, int solver_count);

#endif
