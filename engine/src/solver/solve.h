/* The solvers of the contact problem, which share one interface. Every solver starts from
 * problem->impulse, leaves the best impulses that it found there and the velocities in step with
 * them, and fills a report. Not converging is no error: the status is PE_OK or PE_NO_MEMORY. */
#ifndef PE_SOLVE_H
#define PE_SOLVE_H

#include "base/memory.h"
#include "plumb/contact_problem.h"
#include "problem/problem.h"

/* Where a solver notes residuals as it runs, up to `capacity` of them. */
typedef struct pe_solve_history {
    pe_solve_mark *marks;
    int capacity, count;
    double (*clock)(void); /* s; NULL: no times */
    double began;
} pe_solve_history;

/* How a solve ended. */
typedef struct pe_solve_report {
    int iterations;       /* 0: the warm start was good enough */
    pe_residual residual; /* of the impulses as left, with velocities rebuilt from them */
    pe_solve_stop stop;
    double factor_flops;       /* of all factorisations made */
    double most_flops;         /* set by the caller: the bound of factor_flops; 0: none */
    pe_solve_history *history; /* set by the caller; NULL: none */
} pe_solve_report;

/* Whether so many more flops are within the bound. A solver that may not factor ends. */
static inline bool pe_solve_may_factor(const pe_solve_report *report, double flops)
{
    return report->most_flops == 0 || report->factor_flops + flops <= report->most_flops;
}

/* A solver of contact problems, with its own default settings. */
typedef pe_status (*pe_solve_function)(const pe_problem *problem, const pe_solve_limits *limits,
                                       pe_workspace work, pe_solve_report *report, pe_error *error);

/* Notes a residual in report->history, if there is one. */
static inline void pe_solve_note(pe_solve_report *report, int iterations, double residual)
{
    pe_solve_history *history = report->history;
    if (history != NULL && history->count < history->capacity) {
        history->marks[history->count++] = (pe_solve_mark){
            .iterations = iterations,
            .residual = residual,
            .seconds = history->clock != NULL ? history->clock() - history->began : 0,
        };
    }
}

/* Projected Gauss-Seidel with a round friction cone: a sweep visits the points in order; each takes
 * the normal impulse that stops approach, then the tangential one that stops slip, held to the disc
 * of radius mu p_n. (Jourdan, Alart, Jean 1998.) */
pe_status pe_solve_gauss_seidel(const pe_problem *problem, const pe_solve_limits *limits,
                                pe_workspace work, pe_solve_report *report, pe_error *error);

/* The same sweeps with momentum and restarts (pe_momentum in sweep.h). */
pe_status pe_solve_momentum(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error);

/* Either of the two, by `with_momentum`, for several independent problems at once. The numbers of
 * each, and its report in reports (count), are what they would be alone, to the bit. */
pe_status pe_solve_together(const pe_problem *const *problems, int count,
                            const pe_solve_limits *limits, bool with_momentum, pe_workspace work,
                            pe_solve_report *reports, pe_error *error);

enum { PE_TINY_BODIES = 2 };

/* Newton's method for problems of at most PE_TINY_BODIES bodies: the proximal augmented Lagrangian of
 * solve_newton.h, with the friction bounded by mu times the normal impulse of the iterate. That
 * couples friction to the normal impulse in the derivative, which is then not symmetric: of twelve
 * rows at most, dense, and solved by elimination with pivots. (Alart and Curnier 1991.) Iterations
 * are eliminations, and are added to those in the report. */
pe_status pe_solve_tiny(const pe_problem *problem, const pe_solve_limits *limits, pe_workspace work,
                        pe_solve_report *report, pe_error *error);

/* Newton's method in the Tresca form, or in the cone form without an impulse to start from. */
pe_status pe_solve_newton(const pe_problem *problem, const pe_solve_limits *limits,
                          pe_workspace work, pe_solve_report *report, pe_error *error);

/* The interior point method from a cold start, with De Saxce's shift renewed until it repeats
 * itself: a fixed point that is not within reach for every problem. */
pe_status pe_solve_interior_point(const pe_problem *problem, const pe_solve_limits *limits,
                                  pe_workspace work, pe_solve_report *report, pe_error *error);

/* The direct solver of solve_island.h, which combines the last two. */
pe_status pe_solve_combined(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error);

#endif
