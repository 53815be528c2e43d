/* The solver benchmark: problems captured from scenarios, every solver on each of them, from the
 * warm start and cold, to ever smaller residuals. */
#ifndef PLUMB_SOLVER_BENCHMARK_H
#define PLUMB_SOLVER_BENCHMARK_H

#include "plumb/contact_problem.h"
#include "plumb/scene.h"

#include <jansson.h>
#include <stdio.h>

enum { PL_BENCHMARK_SETTINGS = 4, PL_BENCHMARK_LEVELS = 4 };

/* A row of the table of problems. */
typedef struct pl_benchmark_problem {
    const char *name;
    const char *scenario;
    const char *settings[PL_BENCHMARK_SETTINGS]; /* "NAME=VALUE", ends with NULL */
    uint64_t seed;
    int step;      /* from 1: the step whose largest island it is */
    bool held_out; /* not looked at while solvers are tuned */
} pl_benchmark_problem;

/* The table, in the order of reports. Static storage. */
const pl_benchmark_problem *pl_benchmark_problems(int *count);

/* Runs the scenario on our engine up to that step, and gives the largest island's problem, which
 * the caller destroys. PL_FAILED: it has no contact then. */
pl_status pl_benchmark_capture(const pl_benchmark_problem *row, pe_contact_problem **problem,
                               pl_error *error);

/* Residuals to reach, m/s, from the largest to the smallest. */
extern const double pl_benchmark_levels[PL_BENCHMARK_LEVELS];

/* Solves one problem by every solver, each in a process of its own, warm and cold. *result is a new
 * reference: what the problem is, and its `cells`, one for each solver and start, with the `levels`
 * in order up to the first that was not reached. `progress` may be NULL. */
pl_status pl_benchmark_solve(const pl_benchmark_problem *row, const pe_contact_problem *problem,
                             FILE *progress, json_t **result, pl_error *error);

/* The whole benchmark over `rows`: prints the summary on standard output, progress on standard
 * error, and writes solver-benchmark.json, .csv and .md into `directory`, which is made. The
 * command line is noted as where it comes from. */
pl_status pl_benchmark_run(const pl_benchmark_problem *rows, int count, const char *directory,
                           int argc, char *const *argv, pl_error *error);

#endif
