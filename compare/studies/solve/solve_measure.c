#include "solve_measure.h"

#include "problem_file.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST_REPEATS = 9, MOST_SOLVERS = 32 };
static const double ENOUGH_SECONDS = 0.5;

double pl_cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static pl_status check_name(const char *solver, pl_error *error)
{
    const char *names[MOST_SOLVERS];
    int count = pe_solver_count();
    for (int i = 0; i < count && i < MOST_SOLVERS; ++i) {
        names[i] = pe_solver(i).name;
        if (strcmp(names[i], solver) == 0) {
            return PL_OK;
        }
    }
    const char *nearest = pl_nearest_name(solver, names, count);
    return pl_fail(error, PL_BAD_INPUT, "there is no solver %s; %s%s%s", solver,
                   nearest == NULL ? "see plumb solve --help" : "did you mean ",
                   nearest == NULL ? "" : nearest, nearest == NULL ? "" : "?");
}

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

pl_status pl_measure_solver(const pe_contact_problem *problem, const char *solver,
                            const pe_solve_limits *limits, pl_solver_run *run, pl_error *error)
{
    pl_status status = check_name(solver, error);
    if (status != PL_OK) {
        return status;
    }
    double seconds[MOST_REPEATS], used = 0;
    *run = (pl_solver_run){.solver = solver};
    while (run->repeats < MOST_REPEATS && (run->repeats % 2 == 0 || used < ENOUGH_SECONDS)) {
        pe_contact_solution solution;
        pe_error failure;
        pe_status solved =
            pe_contact_problem_solve(problem, solver, limits, pl_cpu_seconds, &solution, &failure);
        if (solved != PE_OK) {
            pe_contact_solution_free(&run->solution);
            return solved == PE_BAD_ARGUMENT ? pl_fail(error, PL_BAD_INPUT, "%s", failure.message)
                                             : pl_engine_error(solved, &failure, error);
        }
        seconds[run->repeats++] = solution.seconds;
        used += solution.seconds;
        if (run->repeats == 1) {
            run->solution = solution;
        } else {
            pe_contact_solution_free(&solution);
        }
    }
    qsort(seconds, (size_t)run->repeats, sizeof seconds[0], compare_numbers);
    run->seconds = seconds[run->repeats / 2];
    return PL_OK;
}

const char *pl_solve_stop_name(pe_solve_stop stop)
{
    switch (stop) {
    case PE_STOP_CONVERGED:
        return "converged";
    case PE_STOP_ITERATIONS:
        return "iteration limit";
    case PE_STOP_STALLED:
        break;
    }
    return "stalled";
}
