/* plumb solve PROBLEM.json --solver NAME: one contact problem, solved again. */
#include "commands.h"

#include "results/result.h"
#include "results/store.h"
#include "selection.h"
#include "studies/solve/benchmark.h"
#include "studies/solve/problem_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    pe_solve_limits limits;
    pl_texts solvers;
    const char *file, *json, *out;
    bool cold, benchmark;
} options;

enum {
    KEY_SOLVER = 0x200,
    KEY_TOLERANCE,
    KEY_ITERATIONS,
    KEY_COLD,
    KEY_JSON,
    KEY_BENCHMARK,
    KEY_OUT
};

static const struct argp_option argp_options[] = {
    {"solver", KEY_SOLVER, "NAME", 0, "The solver, or \"all\" (repeatable; listed below)", 0},
    {"tolerance", KEY_TOLERANCE, "M/S", 0,
     "Solved when the residual is at most this (default 1e-8)", 0},
    {"max-iterations", KEY_ITERATIONS, "N", 0, "Sweeps or Newton iterations (default 10000)", 0},
    {"cold", KEY_COLD, NULL, 0, "Start from zero impulses, not from those of the file", 0},
    {"json", KEY_JSON, "FILE", 0, "Write everything as a JSON object (- is standard output)", 0},
    {"benchmark", KEY_BENCHMARK, NULL, 0,
     "Capture the benchmark's own problems and race all solvers on them", 1},
    {"out", KEY_OUT, "DIR", 0,
     "Write solver-benchmark.md, .csv and .json of --benchmark there (default report)", 1},
    {0}};

static void check(const options *o, struct argp_state *state)
{
    if (o->benchmark) {
        if (o->file != NULL || o->solvers.count > 0 || o->json != NULL || o->cold) {
            argp_error(state, "--benchmark has its own problems, and runs all solvers on them");
        }
        return;
    }
    if (o->out != NULL) {
        argp_error(state, "--out goes with --benchmark");
    }
    if (o->file == NULL) {
        argp_error(state, "which problem? plumb run SCENARIO --engine plumb --capture STEP:FILE "
                          "makes one");
    }
    if (o->solvers.count == 0) {
        argp_error(state, "which solver? --solver NAME, or --solver all");
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case KEY_SOLVER:
        pl_texts_add(&o->solvers, text);
        return 0;
    case KEY_TOLERANCE:
        o->limits.tolerance = pl_option_number(state, "--tolerance takes m/s", text, 1e-300, 1e300);
        return 0;
    case KEY_ITERATIONS:
        o->limits.max_iterations =
            (int)pl_option_integer(state, "--max-iterations takes an integer", text, 0, 1000000000);
        return 0;
    case KEY_COLD:
        o->cold = true;
        return 0;
    case KEY_JSON:
        o->json = text;
        return 0;
    case KEY_BENCHMARK:
        o->benchmark = true;
        return 0;
    case KEY_OUT:
        o->out = text;
        return 0;
    case ARGP_KEY_ARG:
        if (o->file != NULL) {
            argp_error(state, "one problem at a time");
        }
        o->file = text;
        return 0;
    case ARGP_KEY_END:
        check(o, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* The list of solvers goes before the examples. */
static char *filter_help(int key, const char *text, void *input)
{
    (void)input;
    char *made = NULL;
    size_t length = 0;
    FILE *stream = key == ARGP_KEY_HELP_POST_DOC ? open_memstream(&made, &length) : NULL;
    if (stream == NULL) {
        return (char *)text;
    }
    fputs("Solvers:\n", stream);
    for (int i = 0; i < pe_solver_count(); ++i) {
        fprintf(stream, "  %-16s %s\n", pe_solver(i).name, pe_solver(i).description);
    }
    fprintf(stream, "\n%s", text);
    return fclose(stream) == 0 ? made : (char *)text;
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "PROBLEM.json --solver NAME\n--benchmark",
    .doc = "Solves a captured contact problem again, and prints the residual against iterations "
           "and CPU time. Exits with 3 when no solver reached the tolerance.\v"
           "Examples:\n"
           "  plumb run tower --engine plumb --capture 60:tower.json\n"
           "  plumb solve tower.json --solver newton --tolerance 1e-10\n"
           "  plumb solve tower.json --solver all --cold\n"
           "  plumb solve --benchmark --out report",
    .help_filter = filter_help};

/* ---- One solver or several ---------------------------------------------------------------------
 */

typedef struct session {
    pe_contact_problem *problem;
    json_t *source;
    const char **solvers; /* (count) */
    int count;
    pl_solver_run *runs; /* (count), of which `done` are filled */
    int done;
} session;

static void drop_warm_start(pe_contact_problem *problem)
{
    for (int i = 0; i < problem->point_count; ++i) {
        memset(problem->points[i].impulse, 0, sizeof problem->points[i].impulse);
    }
}

/* The solvers asked for, each once, in the order asked. */
static pl_status choose_solvers(const options *o, session *s, pl_error *error)
{
    size_t most = (size_t)(o->solvers.count + 1) * (size_t)(pe_solver_count() + 1);
    s->solvers = calloc(most, sizeof *s->solvers);
    s->runs = calloc(most, sizeof *s->runs);
    if (s->solvers == NULL || s->runs == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    for (int i = 0; i < o->solvers.count; ++i) {
        bool all = strcmp(o->solvers.items[i], "all") == 0;
        for (int k = 0; k < (all ? pe_solver_count() : 1); ++k) {
            const char *name = all ? pe_solver(k).name : o->solvers.items[i];
            bool known = false;
            for (int j = 0; j < s->count; ++j) {
                known = known || strcmp(s->solvers[j], name) == 0;
            }
            if (!known) {
                s->solvers[s->count++] = name;
            }
        }
    }
    return PL_OK;
}

static void print_problem(const options *o, const session *s)
{
    const pe_contact_problem *p = s->problem;
    printf("%s: %d bodies, %d manifolds, %d contact points", o->file, p->body_count,
           p->manifold_count, p->point_count);
    const char *scenario = json_string_value(json_object_get(s->source, "scenario"));
    const json_t *step = json_object_get(s->source, "step");
    if (scenario != NULL && json_is_number(step)) {
        printf("; %s, step %.0f", scenario, json_number_value(step));
    }
    printf("\n%s start: residual %.3g m/s, rms %.3g\n", o->cold ? "cold" : "warm",
           s->runs[0].solution.start.max, s->runs[0].solution.start.rms);
}

static void print_table(const session *s)
{
    printf("\n%-16s %-16s %10s %12s %14s %12s\n", "solver", "outcome", "iterations", "time, ms",
           "residual, m/s", "rms, m/s");
    for (int i = 0; i < s->done; ++i) {
        const pl_solver_run *run = &s->runs[i];
        printf("%-16s %-16s %10d %12.4g %14.3g %12.3g\n", run->solver,
               pl_solve_stop_name(run->solution.stop), run->solution.iterations, 1e3 * run->seconds,
               run->solution.residual.max, run->solution.residual.rms);
    }
}

/* One row of the history, with a bar as long as the residual has decades above the least one. */
static void print_mark(const pe_solve_mark *mark, double least, double decades)
{
    enum { WIDTH = 36 };
    bool shown = isfinite(mark->residual) && mark->residual > 0 && decades > 0;
    int length = shown ? 1 + (int)(WIDTH * log10(mark->residual / least) / decades) : 0;
    printf("%10d %14.3g %12.4g  ", mark->iterations, mark->residual, 1e3 * mark->seconds);
    for (int i = 0; i < length; ++i) {
        putchar('*');
    }
    putchar('\n');
}

/* About so many rows, evenly spaced, the first and last among them. */
static void print_history(const pe_contact_solution *solution)
{
    enum { ROWS = 20 };
    double least = INFINITY, most = 0;
    int count = solution->history_count;
    for (int i = 0; i < count; ++i) {
        double e = solution->history[i].residual;
        least = e > 0 && e < least ? e : least;
        most = isfinite(e) && e > most ? e : most;
    }
    double decades = most > least ? log10(most / least) : 0;
    int rows = count < ROWS ? count : ROWS;
    printf("\n%10s %14s %12s\n", "iterations", "residual, m/s", "time, ms");
    for (int row = 0; row < rows; ++row) {
        int i = rows == 1 ? 0 : (int)((long)row * (count - 1) / (rows - 1));
        print_mark(&solution->history[i], least, decades);
    }
}

/* ---- JSON --------------------------------------------------------------------------------------
 */

static json_t *numbers(const double *values, int rows, int columns)
{
    json_t *array = json_array();
    for (int i = 0; i < rows; ++i) {
        json_t *row = json_array();
        for (int k = 0; k < columns; ++k) {
            json_array_append_new(row, pl_json_number_or_null(values[i * columns + k]));
        }
        json_array_append_new(array, row);
    }
    return array;
}

static json_t *history_json(const pe_contact_solution *solution)
{
    json_t *array = json_array();
    for (int i = 0; i < solution->history_count; ++i) {
        const pe_solve_mark *mark = &solution->history[i];
        json_array_append_new(array, json_pack("{s:i, s:o, s:o}", "iterations", mark->iterations,
                                               "residual", pl_json_number_or_null(mark->residual),
                                               "seconds", pl_json_number_or_null(mark->seconds)));
    }
    return array;
}

static json_t *run_json(const pl_solver_run *run, const pe_contact_problem *problem)
{
    const pe_contact_solution *s = &run->solution;
    return json_pack("{s:s, s:s, s:i, s:o, s:o, s:f, s:i, s:f, s:o, s:o, s:o}", "solver",
                     run->solver, "outcome", pl_solve_stop_name(s->stop), "iterations",
                     s->iterations, "residual_max", pl_json_number_or_null(s->residual.max),
                     "residual_rms", pl_json_number_or_null(s->residual.rms), "seconds",
                     run->seconds, "repeats", run->repeats, "factor_flops", s->factor_flops,
                     "history", history_json(s), "impulses",
                     numbers(s->impulses[0], problem->point_count, 3), "velocities",
                     numbers(s->velocities[0], problem->body_count, 6));
}

static pl_status write_json(const options *o, const session *s, pl_error *error)
{
    const pe_contact_problem *p = s->problem;
    json_t *runs = json_array();
    for (int i = 0; i < s->done; ++i) {
        json_array_append_new(runs, run_json(&s->runs[i], p));
    }
    json_t *whole =
        json_pack("{s:s, s:s, s:O?, s:i, s:i, s:i, s:s, s:f, s:i, s:o, s:o, s:o}", "schema",
                  "plumb.solve/1", "file", o->file, "source", s->source, "bodies", p->body_count,
                  "manifolds", p->manifold_count, "points", p->point_count, "start",
                  o->cold ? "cold" : "warm", "tolerance", o->limits.tolerance, "max_iterations",
                  o->limits.max_iterations, "start_residual_max",
                  pl_json_number_or_null(s->runs[0].solution.start.max), "start_residual_rms",
                  pl_json_number_or_null(s->runs[0].solution.start.rms), "solvers", runs);
    pl_status status = whole == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                                     : pl_results_write_json(o->json, whole, error);
    json_decref(whole);
    return status;
}

/* ---- The command -------------------------------------------------------------------------------
 */

static pl_status solve_all(const options *o, session *s, pl_error *error)
{
    pl_status status = pl_problem_read_file(o->file, &s->problem, &s->source, error);
    if (status == PL_OK) {
        status = choose_solvers(o, s, error);
    }
    if (status == PL_OK && o->cold) {
        drop_warm_start(s->problem);
    }
    while (status == PL_OK && s->done < s->count) {
        status = pl_measure_solver(s->problem, s->solvers[s->done], &o->limits, &s->runs[s->done],
                                   error);
        s->done += status == PL_OK;
    }
    return status;
}

static int solve(const pl_call *call, const options *o)
{
    session s = {.problem = NULL};
    pl_error error = {.message = ""};
    int code = PL_EXIT_FAILED;
    pl_status status = solve_all(o, &s, &error);
    if (status == PL_OK && (o->json == NULL || strcmp(o->json, "-") != 0)) {
        print_problem(o, &s);
        print_table(&s);
        if (s.done == 1) {
            print_history(&s.runs[0].solution);
        }
    }
    if (status == PL_OK && o->json != NULL) {
        status = write_json(o, &s, &error);
    }
    for (int i = 0; i < s.done; ++i) {
        code = s.runs[i].solution.stop == PE_STOP_CONVERGED ? PL_EXIT_OK : code;
        pe_contact_solution_free(&s.runs[i].solution);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    }
    free(s.solvers);
    free(s.runs);
    json_decref(s.source);
    pe_contact_problem_destroy(s.problem);
    return code;
}

int pl_command_solve(const pl_call *call)
{
    options o = {.limits = {.tolerance = 1e-8, .max_iterations = 10000}};
    pl_call_parse(call, &argp, &o);
    int code = PL_EXIT_OK;
    if (o.benchmark) {
        pl_error error = {.message = ""};
        int count;
        const pl_benchmark_problem *rows = pl_benchmark_problems(&count);
        pl_status status = pl_benchmark_run(rows, count, o.out == NULL ? "report" : o.out,
                                            call->program_argc, call->program_argv, &error);
        code = status == PL_OK ? PL_EXIT_OK : pl_call_fail(call, &error);
    } else {
        code = solve(call, &o);
    }
    free(o.solvers.items);
    return code;
}
