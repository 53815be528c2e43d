/* The solvers of the contact problem: one interface, a solver a file. */
#ifndef PE_SOLVE_H
#define PE_SOLVE_H

#include "problem.h"

typedef struct pe_solve_limits {
    double tolerance; /* m/s, on pe_problem_residual */
    int max_iterations;
    double max_updates; /* contact points visited */
} pe_solve_limits;

typedef struct pe_solve_report {
    int iterations;  /* 0: the warm start was good enough */
    double residual; /* m/s, of the impulses as left, velocities rebuilt from them */
    bool converged;
} pe_solve_report;

/* Projected Gauss-Seidel with a round friction cone, warm-started from problem->impulse: each sweep
 * visits the points in order, and at each takes the normal impulse that stops approach, then the
 * tangential one that stops slip, held to the disc of radius mu p_n. Leaves impulses and velocities
 * in step. No allocation. (Jourdan, Alart, Jean 1998.) */
void pe_solve_gauss_seidel(const pe_problem *problem, const pe_solve_limits *limits,
                           pe_solve_report *report);

#endif
