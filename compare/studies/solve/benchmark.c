/* Captures contact problems from scenarios and solves them by every solver. */
#include "benchmark.h"

#include "adapters/contact_problems.h"
#include "base/folding.h"
#include "base/statistics.h"
#include "engines/process.h"
#include "engines/registry.h"
#include "plumb/scenario.h"
#include "problem_file.h"
#include "results/result.h"
#include "results/store.h"
#include "runner/session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- Problems, captured by running scenarios on our engine in this process ---- */

/* Stacks at rest are captured after they have settled, with the warm start of the step before;
 * piles and collapses while they move. Seeds above 100 are held out. */
static const pl_benchmark_problem PROBLEMS[] = {
    {"tower-10", "tower", {"n=10"}, .step = 2},
    {"tower-100", "tower", {"n=100"}, .step = 2},
    {"tower-1000", "tower", {"n=1000"}, .step = 2},
    {"tower-100-offset", "tower", {"n=100", "offset=0.05"}, .seed = 1, .step = 30},
    {"tower-100-offset-held-out", "tower", {"n=100", "offset=0.05"}, 101, 30, true},
    {"mass-ratio-1e3", "mass-ratio", {"k=3"}, .step = 2},
    {"mass-ratio-1e6", "mass-ratio", {"k=6"}, .step = 2},
    {"tower-100-top-1000", "tower", {"n=100", "top_mass=1000"}, .step = 2},
    {"tower-100-rising-1000", "tower", {"n=100", "rising_mass=1000"}, .step = 2},
    {"slope-stick-threshold", "slope-stick", {"angle=0.4636"}, .step = 30},
    {"slope-slide-threshold", "slope-slide", {"angle=0.4637"}, .step = 30},
    {"wall-10x10", "wall", {"rows=10", "columns=10"}, .step = 2},
    {"wall-25x40", "wall", {"rows=25", "columns=40"}, .step = 2},
    {"collapse-10x10-impact", "wall-collapse", {"rows=10", "columns=10"}, .step = 8},
    {"collapse-10x10", "wall-collapse", {"rows=10", "columns=10"}, .step = 40},
    {"collapse-25x40-impact", "wall-collapse", {"rows=25", "columns=40"}, .step = 8},
    {"collapse-25x40", "wall-collapse", {"rows=25", "columns=40"}, .step = 40},
    {"pile-100-spheres", "pile", {"n=100", "shape=0"}, .seed = 1, .step = 90},
    {"pile-100-boxes", "pile", {"n=100", "shape=1"}, .seed = 1, .step = 90},
    {"pile-100-both", "pile", {"n=100", "shape=2"}, .seed = 1, .step = 90},
    {"pile-500-spheres", "pile", {"n=500", "shape=0"}, .seed = 1, .step = 110},
    {"pile-500-boxes", "pile", {"n=500", "shape=1"}, .seed = 1, .step = 110},
    {"pile-500-both", "pile", {"n=500", "shape=2"}, .seed = 1, .step = 110},
    {"pile-1000-spheres", "pile", {"n=1000", "shape=0"}, .seed = 1, .step = 130},
    {"pile-1000-boxes", "pile", {"n=1000", "shape=1"}, .seed = 1, .step = 130},
    {"pile-100-both-held-out", "pile", {"n=100", "shape=2"}, 101, 80, true},
    {"pile-500-both-held-out", "pile", {"n=500", "shape=2"}, 102, 100, true},
    {"pile-1000-both-held-out", "pile", {"n=1000", "shape=2"}, 103, 120, true},
};
enum { PROBLEM_COUNT = sizeof PROBLEMS / sizeof PROBLEMS[0] };

const pl_benchmark_problem *pl_benchmark_problems(int *count)
{
    *count = PROBLEM_COUNT;
    return PROBLEMS;
}

static pl_status build_scene(const pl_benchmark_problem *row, pl_scene *scene, pl_error *error)
{
    const pl_scenario *scenario = pl_scenario_find(row->scenario, error);
    if (scenario == NULL) {
        return PL_BAD_INPUT;
    }
    double values[PL_MAX_PARAMS];
    int count = 0;
    while (count < PL_BENCHMARK_SETTINGS && row->settings[count] != NULL) {
        ++count;
    }
    pl_status status = pl_scenario_values(scenario, row->settings, count, values, error);
    return status == PL_OK ? pl_scenario_build(scenario, values, row->seed, scene, error) : status;
}

/* Runs up to the step before, then captures the problem. */
static pl_status step_and_capture(const pl_benchmark_problem *row, pl_session *session,
                                  pe_contact_problem **problem, pl_error *error)
{
    for (int step = 1; step < row->step; ++step) {
        pl_step_stats stats;
        pl_status status = pl_session_step(session, &stats, NULL, error);
        if (status != PL_OK) {
            return status;
        }
    }
    pe_contact_problem **problems = NULL;
    int count = 0;
    pl_status status =
        pl_contact_problems_of(&session->loaded.table)
            ->capture(session->instance, session->setup.dt, &problems, &count, error);
    if (status != PL_OK) {
        return status;
    }
    int largest = pl_capture_largest(problems, count);
    if (largest < 0) {
        return pl_fail(error, PL_FAILED, "%s: step %d has no contact", row->name, row->step);
    }
    *problem = pe_contact_problems_keep(problems, count, largest);
    return PL_OK;
}

pl_status pl_benchmark_capture(const pl_benchmark_problem *entry, pe_contact_problem **problem,
                               pl_error *error)
{
    pl_scene scene = pl_scene_default();
    pl_engine_choice choice;
    pl_status status = build_scene(entry, &scene, error);
    if (status == PL_OK) {
        status = pl_engine_choose("plumb:accurate", &choice, error);
    }
    if (status == PL_OK) {
        pl_session session = pl_session_begin(&choice);
        status = pl_session_load(&session, error);
        if (status == PL_OK) {
            status = pl_session_create(&session, &scene, error);
        }
        if (status == PL_OK) {
            status = step_and_capture(entry, &session, problem, error);
        }
        pl_session_end(&session);
    }
    pl_scene_free(&scene);
    return status;
}

enum { MOST_REPEATS = 9, MOST_SOLVERS = 32 };
static const double ENOUGH_SECONDS = 0.5;

/* The process's CPU time, s. */
static double cpu_seconds(void)
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
    char suggestion[PL_SUGGESTION_SIZE];
    pl_did_you_mean(solver, names, count, suggestion);
    return pl_fail(error, PL_BAD_INPUT, "there is no solver %s%s", solver,
                   suggestion[0] == '\0' ? "; see plumb solve --help" : suggestion);
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
            pe_contact_problem_solve(problem, solver, limits, cpu_seconds, &solution, &failure);
        if (solved != PE_OK) {
            pe_contact_solution_free(&run->solution);
            return pl_fail(error,
                           solved == PE_BAD_ARGUMENT ? PL_BAD_INPUT
                           : solved == PE_NO_MEMORY  ? PL_NO_MEMORY
                                                     : PL_FAILED,
                           "%s", failure.message);
        }
        seconds[run->repeats++] = solution.seconds;
        used += solution.seconds;
        if (run->repeats == 1) {
            run->solution = solution;
        } else {
            pe_contact_solution_free(&solution);
        }
    }
    run->seconds = pl_median(seconds, run->repeats);
    return PL_OK;
}

const char *pl_solve_stop_name(pe_solve_stop stop)
{
    return stop == PE_STOP_CONVERGED    ? "converged"
           : stop == PE_STOP_ITERATIONS ? "iteration limit"
                                        : "stalled";
}

/* ---- All solvers on one problem ----
 *
 * Each solver runs in a process of its own, so that a crash or a hang becomes a result. Every level
 * is a solve of its own that stops there, so that its cost is that of a user who asks for this
 * level. */

/* The limits of one solve: factorisations; or sweeps, whose number times the number of points is
 * also limited. A sweep takes about 10 ns per point: the limit is half a second of sweeps. */
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

/* Runs in the child: writes one line per level, and stops at the first that is not reached. */
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

/* The level at which a process ended early, and why. */
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

enum { KEY_SIZE = 256 };

/* The journal's key, which names our engine's binary, of a problem, or of one solver from one start on it. */
static pl_status key_of(const pl_benchmark_problem *row, const char *solver, const char *start,
                        char key[KEY_SIZE], pl_error *error)
{
    pl_engine_choice engine;
    pl_status status = pl_engine_choose("plumb:accurate", &engine, error);
    if (status == PL_OK) {
        snprintf(key, KEY_SIZE, "%s %s %.60s %s", engine.engine->binary, row->name,
                 solver == NULL ? "" : solver, start == NULL ? "" : start);
    }
    return status;
}

/* Runs one solver from one start in its own process, unless the journal has its cell. */
static pl_status run_solver(const pl_benchmark_problem *row, solver_run_def *l, const char *start,
                            pl_journal *journal, json_t *cells, pl_error *error)
{
    pl_process process;
    char key[KEY_SIZE];
    pl_status status = key_of(row, l->solver.name, start, key, error);
    json_t *cell = status == PL_OK ? pl_journal_take(journal, key) : NULL;
    if (cell != NULL) {
        return json_array_append_new(cells, cell) == 0
                   ? PL_OK
                   : pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    if (status == PL_OK) {
        status = pl_process_start(&process, &LIMITS, solve_levels, l, error);
    }
    if (status == PL_OK) {
        status = pl_process_wait(&process, error);
    }
    if (status != PL_OK) {
        return status;
    }
    cell = json_pack("{s:s, s:s, s:o}", "solver", l->solver.name, "start", start, "levels",
                     collect_levels(&process));
    pl_process_free(&process);
    status = pl_journal_add(journal, key, cell, error);
    return json_array_append_new(cells, cell) == 0 ? status
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

/* The residual of a start, measured by a solve without iterations. */
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

/* Solves one problem by every solver, warm and cold. *result is a new reference: the problem, and
 * its `cells`, one per solver and start, with the `levels` in order up to the first that was not
 * reached. */
static pl_status pl_benchmark_solve(const pl_benchmark_problem *row,
                                    const pe_contact_problem *problem, pl_journal *journal,
                                    json_t **result, pl_error *error)
{
    pe_contact_problem *cold = NULL;
    json_t *cells = json_array();
    pl_status status = copy_cold(problem, &cold, error);
    for (int i = 0; i < 2 * pe_solver_count() && status == PL_OK; ++i) {
        bool is_warm = i < pe_solver_count();
        solver_run_def l = {is_warm ? problem : cold, pe_solver(i % pe_solver_count())};
        pl_print_line(stderr, "%s, %s, %s", row->name, is_warm ? "warm" : "cold", l.solver.name);
        status = run_solver(row, &l, is_warm ? "warm" : "cold", journal, cells, error);
    }
    if (status == PL_OK) {
        *result = describe(row, problem, cold, cells);
        status = *result == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory") : PL_OK;
    }
    pe_contact_problem_destroy(cold);
    json_decref(cells);
    return status;
}

/* The result of a problem that could not be captured. */
static json_t *failed_problem(const pl_benchmark_problem *row, const char *message)
{
    return json_pack("{s:s, s:s, s:o, s:[]}", "name", row->name, "scenario", row->scenario, "error",
                     pl_json_text(message, strlen(message)), "cells");
}

static pl_status run_problem(const pl_benchmark_problem *row, pl_journal *journal, json_t *problems,
                             pl_error *error)
{
    pe_contact_problem *problem = NULL;
    char key[KEY_SIZE];
    pl_error failure = {.message = ""};
    pl_status status = key_of(row, NULL, NULL, key, error);
    json_t *result = status == PL_OK ? pl_journal_take(journal, key) : NULL;
    if (status != PL_OK || result != NULL) {
        return status != PL_OK || json_array_append_new(problems, result) == 0
                   ? status
                   : pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    pl_print_line(stderr, "%s: capturing", row->name);
    if (pl_benchmark_capture(row, &problem, &failure) == PL_OK) {
        status = pl_benchmark_solve(row, problem, journal, &result, error);
        pe_contact_problem_destroy(problem);
    } else {
        result = failed_problem(row, failure.message);
    }
    if (status == PL_OK) {
        status = pl_journal_add(journal, key, result, error);
    }
    if (status == PL_OK && json_array_append(problems, result) != 0) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    json_decref(result);
    return status;
}

char *pl_benchmark_path(const char *directory, const char *suffix)
{
    char *path = NULL;
    return asprintf(&path, "%s/solver-benchmark.%s", directory, suffix) < 0 ? NULL : path;
}

/* Writes DIRECTORY/solver-benchmark.SUFFIX, and frees `text`. */
static pl_status write_text(const char *directory, const char *suffix, char *text, pl_error *error)
{
    char *path = pl_benchmark_path(directory, suffix);
    pl_status status = PL_OK;
    if (path == NULL || text == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for the benchmark's report");
    } else {
        status = pl_write_text(path, text, strlen(text), error);
    }
    free(path);
    free(text);
    return status;
}

static pl_status write_all(const char *directory, const json_t *result, pl_error *error)
{
    char *text = pl_benchmark_text(result, pl_window_width(stdout));
    fputs(text == NULL ? "" : text, stdout);
    free(text);
    pl_status status = write_text(directory, "md", pl_benchmark_text(result, 0), error);
    if (status == PL_OK) {
        status = write_text(directory, "csv", pl_benchmark_csv(result), error);
    }
    if (status == PL_OK) {
        status = write_text(
            directory, "json",
            json_dumps(result, JSON_INDENT(1) | JSON_SORT_KEYS | JSON_REAL_PRECISION(17)), error);
    }
    return status;
}

pl_status pl_benchmark_run(const pl_benchmark_problem *entries, int count, const char *directory,
                           pl_journal *journal, int argc, char *const *argv, pl_error *error)
{
    json_t *result = pl_provenance(argc, argv);
    json_t *problems = json_array();
    char started[32];
    pl_timestamp(started);
    pl_status status = pl_make_directories(directory, error);
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = run_problem(&entries[i], journal, problems, error);
    }
    int failed = json_object_set_new(result, "schema", json_string("plumb.solver_benchmark/1"));
    failed |= json_object_set_new(result, "started", json_string(started));
    failed |= json_object_set(result, "problems", problems);
    if (status == PL_OK) {
        status = failed != 0 ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                             : write_all(directory, result, error);
    }
    json_decref(problems);
    json_decref(result);
    return status;
}
