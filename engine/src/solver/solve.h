/* The solvers of the contact problem: one interface, a solver a file. Every solver starts from
 * problem->impulse, leaves the best impulses that it found there and the velocities in step with
 * them, and says what it did. That it did not converge is no error; its status is PE_NO_MEMORY or
 * PE_OK. */
#ifndef PE_SOLVE_H
#define PE_SOLVE_H

#include "base/memory.h"
#include "plumb/contact_problem.h" /* limits, stop, mark */
#include "problem/problem.h"

/* Where a solver notes residuals as it goes; `clock` may be NULL. Not kept beyond capacity. */
typedef struct pe_solve_history {
    pe_solve_mark *marks;
    int capacity, count;
    double (*clock)(void);
    double began;
} pe_solve_history;

typedef struct pe_solve_report {
    int iterations;       /* 0: the warm start was good enough */
    pe_residual residual; /* of the impulses as left, velocities rebuilt from them */
    pe_solve_stop stop;
    double factor_flops;       /* of all factorisations made */
    pe_solve_history *history; /* set by the caller; NULL: none */
} pe_solve_report;

/* Notes a residual in report->history, if there is one. */
void pe_solve_note(pe_solve_report *report, int iterations, double residual);

/* Projected Gauss-Seidel with a round friction cone: each sweep visits the points in order, and at
 * each takes the normal impulse that stops approach, then the tangential one that stops slip, held
 * to the disc of radius mu p_n. (Jourdan, Alart, Jean 1998.) */
pe_status pe_solve_gauss_seidel(const pe_problem *problem, const pe_solve_limits *limits,
                                pe_workspace work, pe_solve_report *report, pe_error *error);

/* The same sweeps with momentum and restarts: the sweep is made at an extrapolated point. See
 * solve_momentum.c. */
pe_status pe_solve_momentum(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error);

#endif
