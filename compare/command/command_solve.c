/* plumb solve PROBLEM.json --solver NAME: one contact problem, solved again. */
#include "base/folding.h"
#include "base/hash.h"
#include "base/table.h"
#include "report/study_page.h"
#include "request.h"
#include "results/result.h"
#include "results/store.h"
#include "studies/solve/benchmark.h"
#include "studies/solve/problem_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_request request; /* names: the file; json, out */
    pe_solve_limits limits;
    pl_texts solvers;
    const char *file;
    bool cold, benchmark;
} options;

static pl_status check(void *user, pl_error *error)
{
    options *o = user;
    const pl_request *request = &o->request;
    const char *wrong = NULL;
    o->file = request->names.count > 0 ? request->names.items[0] : NULL;
    if (o->benchmark) {
        if (o->file != NULL || o->solvers.count > 0 || request->json != NULL || o->cold) {
            wrong = "--benchmark has its own problems, and runs all solvers on them";
        }
    } else if (request->out != NULL) {
        wrong = "--out goes with --benchmark";
    } else if (o->file == NULL) {
        wrong = "which problem? plumb run SCENARIO --engine plumb --capture STEP:FILE makes one";
    } else if (request->names.count > 1) {
        wrong = "one problem at a time";
    } else if (o->solvers.count == 0) {
        wrong = "which solver? --solver NAME, or --solver all";
    }
    return wrong == NULL ? PL_OK : pl_fail(error, PL_BAD_INPUT, "%s", wrong);
}

static void list_solvers(FILE *out)
{
    fputs("Solvers:\n", out);
    for (int i = 0; i < pe_solver_count(); ++i) {
        fprintf(out, "  %-16s %s\n", pe_solver(i).name, pe_solver(i).description);
    }
}

/* ---- One solver or several ---- */

typedef struct session {
    pe_contact_problem *problem;
    json_t *source;
    const char **solvers; /* (count) */
    int count;
    json_t *runs; /* of the solvers so far, as in plumb.solve/1, each with its `start` */
    pl_journal *journal;
    const char *binary; /* hash of our engine's */
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
    s->runs = json_array();
    if (s->solvers == NULL || s->runs == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    int count = 0;
    for (int i = 0; i < o->solvers.count; ++i) {
        bool all = strcmp(o->solvers.items[i], "all") == 0;
        for (int k = 0; k < (all ? pe_solver_count() : 1); ++k) {
            const char *name = all ? pe_solver(k).name : o->solvers.items[i];
            bool known = false;
            for (int j = 0; j < count; ++j) {
                known = known || strcmp(s->solvers[j], name) == 0;
            }
            if (!known) {
                s->solvers[count++] = name;
            }
        }
    }
    s->count = count;
    return PL_OK;
}

/* A number of the object; NAN for null. */
static double number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static int integer(const json_t *object, const char *key)
{
    return (int)json_integer_value(json_object_get(object, key));
}

/* The residuals of the start, which are the same for all solvers. */
static const json_t *start_of(const session *s)
{
    return json_object_get(json_array_get(s->runs, 0), "start");
}

static void print_problem(const options *o, const session *s)
{
    pl_folding folding;
    FILE *out = pl_folding_begin(&folding, stdout);
    const pe_contact_problem *p = s->problem;
    fprintf(out, "%s: %d bodies, %d manifolds, %d contact points", o->file, p->body_count,
            p->manifold_count, p->point_count);
    const char *scenario = json_string_value(json_object_get(s->source, "scenario"));
    const json_t *step = json_object_get(s->source, "step");
    if (scenario != NULL && json_is_number(step)) {
        fprintf(out, "; %s, step %.0f", scenario, json_number_value(step));
    }
    fprintf(out, "\n%s start: residual %.3g m/s, rms %.3g\n", o->cold ? "cold" : "warm",
            number(start_of(s), "max"), number(start_of(s), "rms"));
    pl_folding_end(&folding);
}

static void print_table(const session *s)
{
    pl_table table = {0};
    pl_table_columns(&table, "solver|outcome|>iterations|>time, ms|>residual, m/s|>rms, m/s");
    size_t index;
    const json_t *run;
    json_array_foreach(s->runs, index, run)
    {
        pl_table_add(&table, pl_json_get_text(run, "solver"));
        pl_table_add(&table, pl_json_get_text(run, "outcome"));
        pl_table_format_cell(&table, "%d", integer(run, "iterations"));
        pl_table_number(&table, 1e3 * number(run, "seconds"), 4);
        pl_table_number(&table, number(run, "residual_max"), 3);
        pl_table_number(&table, number(run, "residual_rms"), 3);
    }
    putchar('\n');
    pl_table_print(&table, stdout);
    pl_table_free(&table);
}

/* One row of the history, with a bar as long as the residual has decades above the least one. */
static void add_mark(pl_table *table, const json_t *mark, double least, double decades)
{
    const double residual = number(mark, "residual");
    enum { NUMBERS_WIDTH = 42 }; /* of the columns before the bar */
    static const char bar[] = "************************************";
    const bool shown = isfinite(residual) && residual > 0 && decades > 0;
    const int room = pl_window_width(stdout) - NUMBERS_WIDTH, longest = (int)strlen(bar);
    const int most = room < 8 ? 7 : room < longest ? room - 1 : longest - 1;
    const int length = shown ? 1 + (int)(most * log10(residual / least) / decades) : 0;
    pl_table_format_cell(table, "%d", integer(mark, "iterations"));
    pl_table_number(table, residual, 3);
    pl_table_number(table, 1e3 * number(mark, "seconds"), 4);
    pl_table_format_cell(table, "%.*s", length, bar);
}

/* About so many rows, evenly spaced, the first and last among them. */
static void print_history(const json_t *history)
{
    enum { ROWS = 20 };
    double least = INFINITY, most = 0;
    int count = (int)json_array_size(history);
    for (int i = 0; i < count; ++i) {
        double e = number(json_array_get(history, (size_t)i), "residual");
        least = e > 0 && e < least ? e : least;
        most = isfinite(e) && e > most ? e : most;
    }
    double decades = most > least ? log10(most / least) : 0;
    int rows = count < ROWS ? count : ROWS;
    pl_table table = {0};
    pl_table_columns(&table, ">iterations|>residual, m/s|>time, ms|");
    for (int row = 0; row < rows; ++row) {
        int i = rows == 1 ? 0 : (int)((long)row * (count - 1) / (rows - 1));
        add_mark(&table, json_array_get(history, (size_t)i), least, decades);
    }
    putchar('\n');
    pl_table_print(&table, stdout);
    pl_table_free(&table);
}

/* ---- JSON ---- */

static json_t *numbers(const double *values, int rows, int columns)
{
    json_t *array = json_array();
    for (int i = 0; i < rows; ++i) {
        json_t *row = json_array();
        for (int k = 0; k < columns; ++k) {
            /* NOLINTNEXTLINE(clang-analyzer-core.*): values is not NULL where rows > 0 */
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
    return json_pack(
        "{s:s, s:s, s:i, s:o, s:o, s:f, s:i, s:f, s:o, s:o, s:o, s:{s:o, s:o}}", "solver",
        run->solver, "outcome", pl_solve_stop_name(s->stop), "iterations", s->iterations,
        "residual_max", pl_json_number_or_null(s->residual.max), "residual_rms",
        pl_json_number_or_null(s->residual.rms), "seconds", run->seconds, "repeats", run->repeats,
        "factor_flops", s->factor_flops, "history", history_json(s), "impulses",
        numbers(s->impulses[0], problem->point_count, 3), "velocities",
        numbers(s->velocities[0], problem->body_count, 6), "start", "max",
        pl_json_number_or_null(s->start.max), "rms", pl_json_number_or_null(s->start.rms));
}

static pl_status write_json(const options *o, const session *s, pl_error *error)
{
    const pe_contact_problem *p = s->problem;
    json_t *start = json_incref(json_object_get(json_array_get(s->runs, 0), "start"));
    size_t index;
    json_t *run;
    json_array_foreach(s->runs, index, run)
    {
        json_object_del(run, "start");
    }
    json_t *whole = json_pack(
        "{s:s, s:s, s:O?, s:i, s:i, s:i, s:s, s:f, s:i, s:o, s:o, s:o}", "schema", "plumb.solve/1",
        "file", o->file, "source", s->source, "bodies", p->body_count, "manifolds",
        p->manifold_count, "points", p->point_count, "start", o->cold ? "cold" : "warm",
        "tolerance", o->limits.tolerance, "max_iterations", o->limits.max_iterations,
        "start_residual_max", pl_json_number_or_null(number(start, "max")), "start_residual_rms",
        pl_json_number_or_null(number(start, "rms")), "solvers", json_incref(s->runs));
    pl_status status = whole == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                                     : pl_results_write_json(o->request.json, whole, error);
    json_decref(whole);
    json_decref(start);
    return status;
}

/* ---- The command ---- */

/* What tells solves apart: the problem, the solver, its limits, and our engine's binary. */
static pl_status key_of(const options *o, const session *s, const char *solver,
                        char key[PL_HASH_TEXT_SIZE], pl_error *error)
{
    const double limits[] = {o->limits.tolerance, o->limits.max_iterations};
    char *text = pl_problem_to_text(s->problem, NULL);
    if (text == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    uint64_t hash = pl_hash_text(pl_hash_numbers(PL_HASH_START, limits, 2), text);
    hash = pl_hash_text(pl_hash_text(hash, solver), s->binary);
    pl_hash_hex(hash, key);
    free(text);
    return PL_OK;
}

/* Adds the run of a solver to the session's: that of the journal, or a new one. */
static pl_status solve_one(const options *o, session *s, const char *solver, pl_error *error)
{
    char key[PL_HASH_TEXT_SIZE];
    pl_solver_run run;
    pl_status status = key_of(o, s, solver, key, error);
    json_t *json = status == PL_OK ? pl_journal_take(s->journal, key) : NULL;
    if (status == PL_OK && json == NULL) {
        status = pl_measure_solver(s->problem, solver, &o->limits, &run, error);
        if (status == PL_OK) {
            json = run_json(&run, s->problem);
            pe_contact_solution_free(&run.solution);
            status = json == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                                  : pl_journal_add(s->journal, key, json, error);
        }
    }
    if (status == PL_OK && json_array_append(s->runs, json) != 0) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    json_decref(json);
    return status;
}

static pl_status solve_all(const options *o, session *s, pl_error *error)
{
    pl_status status = pl_problem_read_file(o->file, &s->problem, &s->source, error);
    if (status == PL_OK) {
        status = choose_solvers(o, s, error);
    }
    if (status == PL_OK && o->cold) {
        drop_warm_start(s->problem);
    }
    for (int i = 0; i < s->count && status == PL_OK; ++i) {
        status = solve_one(o, s, s->solvers[i], error);
    }
    return status;
}

static int solve(const pl_call *call, const options *o)
{
    session s = {.problem = NULL};
    pl_error error = {.message = ""};
    int code = PL_EXIT_FAILED;
    pl_engine_choice engine;
    pl_status status = pl_request_journal(call, &o->request, &s.journal, &error);
    if (status == PL_OK) {
        status = pl_engine_choose("plumb", &engine, &error);
    }
    if (status == PL_OK) {
        s.binary = engine.engine->binary;
        status = solve_all(o, &s, &error);
    }
    if (status == PL_OK && !pl_is_stdout(o->request.json)) {
        print_problem(o, &s);
        print_table(&s);
        if (json_array_size(s.runs) == 1) {
            print_history(json_object_get(json_array_get(s.runs, 0), "history"));
        }
    }
    size_t index;
    const json_t *run;
    json_array_foreach(s.runs, index, run)
    {
        const bool converged =
            strcmp(pl_json_get_text(run, "outcome"), pl_solve_stop_name(PE_STOP_CONVERGED)) == 0;
        code = converged ? PL_EXIT_OK : code;
    }
    if (status == PL_OK && o->request.json != NULL) {
        status = write_json(o, &s, &error);
    }
    code = pl_call_end_study(call, s.journal, status, &error, 0, code);
    free(s.solvers);
    json_decref(s.runs);
    json_decref(s.source);
    pe_contact_problem_destroy(s.problem);
    return code;
}

/* The page of the benchmark, made of its JSON. */
static pl_status write_page(const char *directory, pl_error *error)
{
    char path[4096], kind[PL_STUDY_KIND_SIZE];
    json_t *study = NULL;
    snprintf(path, sizeof path, "%.4000s/solver-benchmark.json", directory);
    pl_status status = pl_study_read(path, &study, kind, error);
    if (status == PL_OK) {
        status = pl_study_page_write(directory, kind, study, error);
    }
    json_decref(study);
    return status;
}

static int run_benchmark(const pl_call *call, const pl_request *request)
{
    pl_error error = {.message = ""};
    pl_journal *journal = NULL;
    char *path = pl_benchmark_path(request->out, "json");
    int count;
    const pl_benchmark_problem *rows = pl_benchmark_problems(&count);
    pl_status status = path == NULL ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                                    : pl_request_outputs(request, path, &error);
    free(path);
    if (status == PL_OK) {
        status = pl_request_journal(call, request, &journal, &error);
    }
    if (status == PL_OK) {
        status = pl_benchmark_run(rows, count, request->out, journal, call->program_argc,
                                  call->program_argv, &error);
    }
    if (status == PL_OK) {
        status = write_page(request->out, &error);
    }
    return pl_call_end_study(call, journal, status, &error, 0, PL_EXIT_OK);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default(),
                 .limits = {.tolerance = 1e-8, .max_iterations = 10000}};
    pl_call_parse(call, &o);
    int code = PL_EXIT_OK;
    if (o.benchmark) {
        o.request.out = o.request.out == NULL ? "report" : o.request.out;
        code = run_benchmark(call, &o.request);
    } else {
        code = solve(call, &o);
    }
    free(o.solvers.items);
    pl_request_free(&o.request);
    return code;
}

static const pl_option OPTIONS[] = {
    {"solver", "NAME", "The solver, or \"all\" (repeatable; listed below)", PL_OPTION_TEXTS,
     .field = offsetof(options, solvers), .values = "SOLVER"},
    {"tolerance", "M/S", "The residual at which a problem counts as solved (default 1e-8)",
     PL_OPTION_NUMBER, .field = offsetof(options, limits.tolerance), .takes = "m/s", .min = 1e-300,
     .max = 1e300},
    {"max-iterations", "N", "Largest number of sweeps or Newton iterations (default 10000)",
     PL_OPTION_INTEGER, .field = offsetof(options, limits.max_iterations), .max = 1000000000},
    {"cold", NULL, "Start from zero impulses, not from those of the file", PL_OPTION_FLAG,
     .field = offsetof(options, cold)},
    {"json", "FILE", "Write all results as a JSON object (- is standard output)", PL_OPTION_TEXT,
     .field = offsetof(options, request.json)},
    {"benchmark", NULL, "Capture the problems of the benchmark and run all solvers on them",
     PL_OPTION_FLAG, .field = offsetof(options, benchmark)},
    {"out", NULL,
     "Where --benchmark writes solver-benchmark.md, .csv, .json and its page (default report); "
     "until "
     "the end also plumb-*.unfinished.jsonl, which is else in the working directory",
     .kind = PL_OPTION_HELP},
    {0}};

const pl_command pl_command_solve = {
    .name = "solve",
    .summary = "solve one captured contact problem again",
    .arguments = "PROBLEM.json --solver NAME\n--benchmark",
    .description =
        "Solves a captured contact problem again, and prints the residual against iterations and "
        "CPU time. Exits with 3 when no solver reached the tolerance.",
    .notes = "Examples:\n"
             "  plumb run tower --engine plumb --capture 60:tower.json\n"
             "  plumb solve tower.json --solver newton --tolerance 1e-10\n"
             "  plumb solve tower.json --solver all --cold\n"
             "  plumb solve --benchmark --out report",
    .options = OPTIONS,
    .shared = {pl_study_options},
    .list = list_solvers,
    .check = check,
    .run = run};
