/* One solver on one contact problem, with its time. */
#ifndef PLUMB_MEASURE_SOLVER_H
#define PLUMB_MEASURE_SOLVER_H

#include "plumb/base.h"
#include "plumb/contact_problem.h"

/* The process's CPU time in s (CLOCK_PROCESS_CPUTIME_ID). */
double pl_cpu_seconds(void);

typedef struct pl_solver_run {
    const char *solver;
    pe_contact_solution solution; /* of the first repeat; all give the same but times */
    double seconds;               /* CPU time of the solver: the median of the repeats */
    int repeats;
} pl_solver_run;

/* Solves again and again, an odd number of times up to 9, until half a second is used. The caller
 * frees run->solution. PL_BAD_INPUT: no such solver, which suggests the nearest one, or limits out
 * of range. */
pl_status pl_measure_solver(const pe_contact_problem *problem, const char *solver,
                            const pe_solve_limits *limits, pl_solver_run *run, pl_error *error);

/* "converged", "iteration limit", "stalled". */
const char *pl_solve_stop_name(pe_solve_stop stop);

#endif
