/* The solver benchmark: contact problems captured from scenarios, solved by every solver from a
 * warm and from a cold start, to smaller and smaller residuals. */
#ifndef PLUMB_SOLVER_BENCHMARK_H
#define PLUMB_SOLVER_BENCHMARK_H

#include "plumb/base.h"
#include "plumb/contact_problem.h"
#include "results/journal.h"

#include <jansson.h>

/* ---- One solver on one problem ---- */

/* The outcome of one solver on one contact problem. */
typedef struct pl_solver_run {
    const char *solver;
    pe_contact_solution solution; /* of the first repeat; the others differ in their times only */
    double seconds;               /* CPU time of the solver, s: the median of the repeats */
    int repeats;
} pl_solver_run;

/* Solves the problem an odd number of times, up to 9, until half a second is used. The caller frees
 * run->solution. PL_BAD_INPUT: an unknown solver (the message suggests the nearest), or limits out
 * of range. */
pl_status pl_measure_solver(const pe_contact_problem *problem, const char *solver,
                            const pe_solve_limits *limits, pl_solver_run *run, pl_error *error);

/* "converged", "iteration limit", "stalled". */
const char *pl_solve_stop_name(pe_solve_stop stop);

/* ---- The benchmark ---- */

enum { PL_BENCHMARK_SETTINGS = 4, PL_BENCHMARK_LEVELS = 4 };

/* An entry of the table of problems. */
typedef struct pl_benchmark_problem {
    const char *name;
    const char *scenario;
    const char *settings[PL_BENCHMARK_SETTINGS]; /* "NAME=VALUE"; NULL after the last */
    uint64_t seed;
    int step;      /* from 1: the step whose largest island is the problem */
    bool held_out; /* not used while solvers are tuned */
} pl_benchmark_problem;

/* The table, in the order of reports. Static storage. */
const pl_benchmark_problem *pl_benchmark_problems(int *count);

/* Runs the scenario on our engine up to the step and returns the problem of the largest island,
 * which the caller destroys. PL_FAILED: there is no contact. */
pl_status pl_benchmark_capture(const pl_benchmark_problem *entry, pe_contact_problem **problem,
                               pl_error *error);

/* Residuals to reach, m/s, from the largest to the smallest. */
extern const double pl_benchmark_levels[PL_BENCHMARK_LEVELS];

/* DIRECTORY/solver-benchmark.SUFFIX: malloc'd; NULL when out of memory. */
char *pl_benchmark_path(const char *directory, const char *suffix);

/* Runs the benchmark over `entries`, but for what the journal (NULL: none) has. Prints the summary on standard output and progress on standard
 * error, and writes solver-benchmark.json, .csv and .md into `directory`, which is made. The
 * command line is recorded. */
pl_status pl_benchmark_run(const pl_benchmark_problem *entries, int count, const char *directory,
                           pl_journal *journal, int argc, char *const *argv, pl_error *error);

/* ---- Reports ---- */

/* The whole result ("plumb.solver_benchmark/1") as malloc'd text for a terminal of this width, or as
 * Markdown for 0; NULL when out of memory. It begins with the levels that were not reached and with
 * the solvers slower than the first. */
char *pl_benchmark_text(const json_t *result, int width);

/* The whole result as malloc'd CSV, NULL when out of memory. It has a row per level of every
 * solver and start. */
char *pl_benchmark_csv(const json_t *result);

#endif
