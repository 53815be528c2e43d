/* One problem, all solvers. Each solver runs in a process of its own, so that one that crashes or
 * hangs is a row like any other. Every level is a solve of its own, stopped there: what the level
 * costs is then what a user who asks for it pays. */
#include "benchmark.h"

#include "results/result.h"
#include "runner/process.h"
#include "solve_measure.h"

#include <math.h>
#include <string.h>

const double pl_benchmark_levels[PL_BENCHMARK_LEVELS] = {1e-3, 1e-4, 1e-6, 1e-8};

/* Bounds of one solve: factorisations, or sweeps, of which there are so many that points times
 * sweeps is bounded too. A sweep costs about 10 ns a point, so that this is half a second of
 * sweeps. */
enum { MOST_FACTORISATIONS = 300, LEAST_SWEEPS = 300, MOST_SWEEPS = 100000 };
static const double MOST_UPDATES = 5e7;
static const pl_limits LIMITS = {.timeout = 60};

typedef struct solver_run_def {
    const pe_contact_problem *problem; /* with the start that it shall have */
    pe_solver_info solver;
} solver_run_def;

static int iteration_limit(const solver_run_def *l)
{
    if (l->solver.factorises) {
        return MOST_FACTORISATIONS;
    }
    double most = MOST_UPDATES / (l->problem->point_count + 1);
    return (int)fmin(MOST_SWEEPS, fmax(LEAST_SWEEPS, most));
}

static json_t *level_json(double level, const pl_solver_run *run)
{
    const pe_contact_solution *s = &run->solution;
    return json_pack("{s:f, s:b, s:s, s:i, s:f, s:o, s:o}", "tolerance", level, "reached",
                     s->stop == PE_STOP_CONVERGED, "stop", pl_solve_stop_name(s->stop),
                     "iterations", s->iterations, "seconds", run->seconds, "residual_max",
                     pl_json_number_or_null(s->residual.max), "residual_rms",
                     pl_json_number_or_null(s->residual.rms));
}

/* In the child: writes one level a line, as they come, and stops at the first that is not reached.
 */
static void solve_levels(void *user, FILE *answer)
{
    const solver_run_def *l = user;
    bool reached = true;
    for (int i = 0; i < PL_BENCHMARK_LEVELS && reached; ++i) {
        pe_solve_limits limits = {pl_benchmark_levels[i], iteration_limit(l)};
        pl_solver_run run;
        pl_error error = {.message = ""};
        json_t *level = NULL;
        if (pl_measure_solver(l->problem, l->solver.name, &limits, &run, &error) == PL_OK) {
            level = level_json(limits.tolerance, &run);
            reached = run.solution.stop == PE_STOP_CONVERGED;
            pe_contact_solution_free(&run.solution);
        } else {
            level = json_pack("{s:f, s:b, s:s}", "tolerance", limits.tolerance, "reached", 0,
                              "stop", error.message);
            reached = false;
        }
        json_dumpf(level, answer, JSON_COMPACT | JSON_REAL_PRECISION(17));
        fputc('\n', answer);
        fflush(answer);
        json_decref(level);
    }
}

/* What ended a process that did not answer for all levels. */
static json_t *missing_level(const pl_process *process, double level)
{
    return json_pack("{s:f, s:b, s:s}", "tolerance", level, "reached", 0, "stop",
                     process->timed_out ? "time limit" : "crashed");
}

static json_t *collect_levels(const pl_process *process)
{
    json_t *levels = json_array();
    size_t at = 0;
    bool reached = true;
    while (at < process->text_length) {
        const char *line = process->text + at;
        const char *end = memchr(line, '\n', process->text_length - at);
        size_t length = end == NULL ? process->text_length - at : (size_t)(end - line);
        json_t *level = json_loadb(line, length, 0, NULL);
        if (level != NULL) {
            reached = json_is_true(json_object_get(level, "reached"));
            json_array_append_new(levels, level);
        }
        at += length + 1;
    }
    if (reached && json_array_size(levels) < PL_BENCHMARK_LEVELS) {
        json_array_append_new(levels,
                              missing_level(process, pl_benchmark_levels[json_array_size(levels)]));
    }
    return levels;
}

/* One solver from one start, in its own process. */
static pl_status run_solver(solver_run_def *l, const char *start, json_t *cells, pl_error *error)
{
    pl_process process;
    struct pollfd polls[PL_PROCESS_POLLS];
    pl_status status = pl_process_start(&process, &LIMITS, solve_levels, l, error);
    if (status != PL_OK) {
        return status;
    }
    bool ended = false;
    while (!ended) {
        pl_process_polls(&process, polls);
        poll(polls, PL_PROCESS_POLLS, 100);
        ended = pl_process_advance(&process, polls);
    }
    json_t *cell = json_pack("{s:s, s:s, s:o}", "solver", l->solver.name, "start", start, "levels",
                             collect_levels(&process));
    pl_process_free(&process);
    return json_array_append_new(cells, cell) == 0 ? PL_OK
                                                   : pl_fail(error, PL_NO_MEMORY, "out of memory");
}

static pl_status copy_cold(const pe_contact_problem *from, pe_contact_problem **copy,
                           pl_error *error)
{
    pe_error failure;
    pe_status status = pe_contact_problem_create(from->body_count, from->manifold_count,
                                                 from->point_count, NULL, copy, &failure);
    if (status != PE_OK) {
        return pl_fail(error, PL_NO_MEMORY, "%s", failure.message);
    }
    memcpy((*copy)->bodies, from->bodies, (size_t)from->body_count * sizeof *from->bodies);
    memcpy((*copy)->manifolds, from->manifolds,
           (size_t)from->manifold_count * sizeof *from->manifolds);
    for (int i = 0; i < from->point_count; ++i) {
        (*copy)->points[i] = from->points[i];
        memset((*copy)->points[i].impulse, 0, sizeof from->points[i].impulse);
    }
    return PL_OK;
}

/* The residual that a start has: with no iteration allowed. */
static json_t *start_residual(const pe_contact_problem *problem)
{
    const pe_solve_limits none = {.tolerance = HUGE_VAL, .max_iterations = 0};
    pe_contact_solution solution;
    if (pe_contact_problem_solve(problem, pe_solver(0).name, &none, NULL, &solution, NULL) !=
        PE_OK) {
        return json_null();
    }
    double residual = solution.start.max;
    pe_contact_solution_free(&solution);
    return pl_json_number_or_null(residual);
}

static json_t *describe(const pl_benchmark_problem *row, const pe_contact_problem *warm,
                        const pe_contact_problem *cold, json_t *cells)
{
    json_t *settings = json_array();
    for (int i = 0; i < PL_BENCHMARK_SETTINGS && row->settings[i] != NULL; ++i) {
        json_array_append_new(settings, json_string(row->settings[i]));
    }
    return json_pack("{s:s, s:s, s:o, s:I, s:i, s:b, s:i, s:i, s:i, s:o, s:o, s:O}", "name",
                     row->name, "scenario", row->scenario, "settings", settings, "seed",
                     (json_int_t)row->seed, "step", row->step, "held_out", row->held_out, "bodies",
                     warm->body_count, "manifolds", warm->manifold_count, "points",
                     warm->point_count, "warm_residual", start_residual(warm), "cold_residual",
                     start_residual(cold), "cells", cells);
}

pl_status pl_benchmark_solve(const pl_benchmark_problem *row, const pe_contact_problem *problem,
                             FILE *progress, json_t **result, pl_error *error)
{
    pe_contact_problem *cold = NULL;
    json_t *cells = json_array();
    pl_status status = copy_cold(problem, &cold, error);
    for (int i = 0; i < 2 * pe_solver_count() && status == PL_OK; ++i) {
        bool is_warm = i < pe_solver_count();
        solver_run_def l = {is_warm ? problem : cold, pe_solver(i % pe_solver_count())};
        if (progress != NULL) {
            fprintf(progress, "%s, %s, %s\n", row->name, is_warm ? "warm" : "cold", l.solver.name);
        }
        status = run_solver(&l, is_warm ? "warm" : "cold", cells, error);
    }
    if (status == PL_OK) {
        *result = describe(row, problem, cold, cells);
        status = *result == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory") : PL_OK;
    }
    pe_contact_problem_destroy(cold);
    json_decref(cells);
    return status;
}
