/* Prints the solver benchmark. */
#include "solve_benchmark.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The problems to print. Solvers are compared with the first one. */
typedef struct tables {
    const benchmark_problem *problems;
    int problem_count, solver_count;
    int name_width;
} tables;

static const char *start_of(int start)
{
    return start == 0 ? "warm" : "cold";
}

static const solver_run *run_of(const tables *t, int problem, int start, int solver)
{
    return &t->problems[problem].runs[start * t->solver_count + solver];
}

/* The level, if the solver reached it; else NULL. */
static const level *reached_level(const tables *t, int problem, int start, int solver, int index)
{
    const solver_run *run = run_of(t, problem, start, solver);
    return index < run->count && run->levels[index].reached ? &run->levels[index] : NULL;
}

static const char *solver_name(const tables *t, int solver)
{
    return run_of(t, 0, 0, solver)->solver.name;
}

/* ---- Losses ---- */

static void print_unreached(const tables *t)
{
    int count = 0;
    printf("Not reached\n\nThe first level that a solver missed; smaller ones were not tried.\n\n");
    for (int i = 0; i < t->problem_count; ++i) {
        for (int k = 0; k < 2 * t->solver_count; ++k) {
            const solver_run *run = &t->problems[i].runs[k];
            const level *last = &run->levels[run->count - 1];
            if (last->reached) {
                continue;
            }
            if (count++ == 0) {
                printf("%-*s  start  solver          level, m/s  stopped by       residual, m/s\n",
                       t->name_width, "problem");
            }
            printf("%-*s  %s   %-14s  %10g  %-15s  %13.3g\n", t->name_width, t->problems[i].name,
                   start_of(run->cold), run->solver.name, level_tolerances[run->count - 1],
                   last->stop, last->residual.max);
        }
    }
    printf("%s%d of %d.\n", count == 0 ? "" : "\n", count, t->problem_count * 2 * t->solver_count);
}

typedef struct loss {
    double ratio; /* of CPU times */
    int problem, start, solver, level;
} loss;

static int compare_losses(const void *left, const void *right)
{
    const loss *a = left, *b = right;
    return (a->ratio < b->ratio) - (a->ratio > b->ratio);
}

/* CPU time over that of the first solver; NAN where one of the two did not reach the level or had
 * nothing to do, because the start was good enough. */
static double time_ratio(const tables *t, const loss *at)
{
    const level *own = reached_level(t, at->problem, at->start, at->solver, at->level);
    const level *base = reached_level(t, at->problem, at->start, 0, at->level);
    return own == NULL || base == NULL || base->iterations == 0 ? (double)NAN
                                                                : own->seconds / base->seconds;
}

static void print_slower(const tables *t)
{
    const int most = t->problem_count * 2 * t->solver_count * LEVELS;
    loss *losses = calloc((size_t)most, sizeof *losses);
    int count = 0;
    for (int i = 0; i < most && losses != NULL; ++i) {
        const int run = i / LEVELS, start = run / t->solver_count;
        loss at = {0, start / 2, start % 2, run % t->solver_count, i % LEVELS};
        at.ratio = time_ratio(t, &at);
        if (at.solver > 0 && at.ratio > 1) {
            losses[count++] = at;
        }
    }
    printf("\nSlower than %s\n\nCPU time over that of %s, where both reached the level.\n\n",
           solver_name(t, 0), solver_name(t, 0));
    if (count > 0) {
        qsort(losses, (size_t)count, sizeof *losses, compare_losses);
        printf("%-*s  start  solver          level, m/s  times as long\n", t->name_width,
               "problem");
    }
    for (int i = 0; i < count; ++i) {
        const loss *at = &losses[i];
        printf("%-*s  %s   %-14s  %10g  %13.2f\n", t->name_width, t->problems[at->problem].name,
               start_of(at->start), solver_name(t, at->solver), level_tolerances[at->level],
               at->ratio);
    }
    printf("%s%d of %d.\n", count == 0 ? "" : "\n", count, most - most / t->solver_count);
    free(losses);
}

/* ---- All problems ---- */

static void print_problem(const tables *t, const benchmark_problem *problem)
{
    const pe_contact_problem *data = problem->data;
    printf("\n%s: %d bodies, %d manifolds, %d contact points\n\n", problem->name, data->body_count,
           data->manifold_count, data->point_count);
    printf("%-14s  start  residual, m/s", "solver");
    for (int k = 0; k < LEVELS; ++k) {
        printf("  %13s %-5g", "to", level_tolerances[k]);
    }
    putchar('\n');
    for (int i = 0; i < 2 * t->solver_count; ++i) {
        const solver_run *run = &problem->runs[i];
        printf("%-14s  %s   %13.3g", run->solver.name, start_of(run->cold),
               run->levels[0].start.max);
        for (int k = 0; k < LEVELS; ++k) {
            const level *at = k < run->count && run->levels[k].reached ? &run->levels[k] : NULL;
            if (at == NULL) {
                printf("  %19s", "not reached");
            } else {
                printf("  %5d in %8.3g ms", at->iterations, 1e3 * at->seconds);
            }
        }
        putchar('\n');
    }
}

void print_tables(const benchmark_problem *problems, int problem_count, int solver_count)
{
    tables t = {problems, problem_count, solver_count, (int)strlen("problem")};
    for (int i = 0; i < problem_count; ++i) {
        const int width = (int)strlen(problems[i].name);
        t.name_width = width > t.name_width ? width : t.name_width;
    }
    print_unreached(&t);
    if (solver_count > 1) {
        print_slower(&t);
    }
    for (int i = 0; i < problem_count; ++i) {
        print_problem(&t, &problems[i]);
    }
}
