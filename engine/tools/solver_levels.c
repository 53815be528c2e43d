/* Measures one solver in a process of its own. */
#include "solve_benchmark.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

const double level_tolerances[LEVELS] = {1e-3, 1e-4, 1e-6, 1e-8};

/* The limits of one solve: factorisations; or sweeps, whose number times the number of points is
 * also limited, to half a second of sweeps at 10 ns per point. */
enum { MOST_FACTORISATIONS = 300, LEAST_SWEEPS = 300, MOST_SWEEPS = 100000 };
static const double MOST_UPDATES = 5e7;

/* A level is solved again until ENOUGH_SECONDS of CPU time are used. MOST_SECONDS is the wall time
 * of a process. */
enum { MOST_REPEATS = 9, MOST_SECONDS = 60 };
static const double ENOUGH_SECONDS = 0.5;

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int iteration_limit(const pe_contact_problem *problem, pe_solver_info solver)
{
    const double most = MOST_UPDATES / (problem->point_count + 1);
    return solver.factorises ? MOST_FACTORISATIONS
                             : (int)fmin(MOST_SWEEPS, fmax(LEAST_SWEEPS, most));
}

static int compare_numbers(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

static level solve_level(const pe_contact_problem *problem, pe_solver_info solver, double tolerance)
{
    const pe_solve_limits limits = {tolerance, iteration_limit(problem, solver)};
    double seconds[MOST_REPEATS], used = 0;
    level found = {.reached = false};
    int repeats = 0;
    while (repeats < MOST_REPEATS && (repeats % 2 == 0 || used < ENOUGH_SECONDS)) {
        pe_contact_solution s;
        if (pe_contact_problem_solve(problem, solver.name, &limits, cpu_seconds, &s, NULL) !=
            PE_OK) {
            found.stop = "out of memory"; /* problem, solver and limits are valid */
            return found;
        }
        found.stop = s.stop == PE_STOP_CONVERGED    ? "converged"
                     : s.stop == PE_STOP_ITERATIONS ? "iteration limit"
                                                    : "stalled";
        found.reached = s.stop == PE_STOP_CONVERGED;
        found.iterations = s.iterations;
        found.start = s.start;
        found.residual = s.residual;
        seconds[repeats++] = s.seconds;
        used += s.seconds;
        pe_contact_solution_free(&s);
    }
    qsort(seconds, (size_t)repeats, sizeof *seconds, compare_numbers);
    found.seconds = seconds[repeats / 2];
    return found;
}

/* The process of a run: writes one level after the other, up to the first that is not reached. The
 * texts that they point to have the same address in the parent. */
_Noreturn static void measure(const pe_contact_problem *problem, pe_solver_info solver, bool cold,
                              int pipe)
{
    alarm(MOST_SECONDS);
    for (int i = 0; i < problem->point_count && cold; ++i) {
        memset(problem->points[i].impulse, 0, sizeof problem->points[i].impulse);
    }
    for (int i = 0; i < LEVELS; ++i) {
        const level found = solve_level(problem, solver, level_tolerances[i]);
        if (write(pipe, &found, sizeof found) != sizeof found || !found.reached) {
            break;
        }
    }
    _exit(0);
}

bool solve_levels(const pe_contact_problem *problem, pe_solver_info solver, bool cold,
                  solver_run *run)
{
    int ends[2], status = 0;
    *run = (solver_run){.solver = solver, .cold = cold};
    fflush(NULL);
    if (pipe(ends) != 0) {
        return false;
    }
    const pid_t child = fork();
    if (child == 0) {
        measure(problem, solver, cold, ends[1]);
    }
    close(ends[1]);
    while (child > 0 && run->count < LEVELS &&
           read(ends[0], &run->levels[run->count], sizeof(level)) == sizeof(level)) {
        ++run->count;
    }
    close(ends[0]);
    if (child < 0 || waitpid(child, &status, 0) != child) {
        return false;
    }
    if (run->count < LEVELS && (run->count == 0 || run->levels[run->count - 1].reached)) {
        const bool late = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
        level *last = &run->levels[run->count++];
        *last = (level){.seconds = (double)NAN, .residual = {(double)NAN, (double)NAN}};
        last->stop = late ? "time limit" : "crashed";
    }
    return true;
}
