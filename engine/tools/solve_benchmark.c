/* solve_benchmark [--solver NAME]... [--json FILE] PROBLEM.json...: solves captured contact
 * problems by every solver, from a warm and from a cold start, to smaller and smaller residuals,
 * and prints the losses first. */
#include "solve_benchmark.h"

#include "problem_file.h"

#include <errno.h>
#include <getopt.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EXIT_USAGE = 2, EXIT_IO = 3, MOST_SOLVERS = 32 };

static const char usage[] =
    "Usage: solve_benchmark [--solver NAME]... [--json FILE] PROBLEM.json...\n"
    "\n"
    "Solves contact problems, which plumb run SCENARIO --engine plumb --capture STEP:FILE writes, "
    "from\n"
    "their warm start and from zero impulses, and prints what each solver reached in which CPU "
    "time.\n"
    "\n"
    "  --solver NAME  this solver (repeatable; all if left out); the first is what others are "
    "compared with\n"
    "  --json FILE    also write a JSON object per solver, start and level, each on its line\n"
    "  --help         print this text\n"
    "\n"
    "Solvers:\n";

static void print_help(FILE *out)
{
    fputs(usage, out);
    for (int i = 0; i < pe_solver_count(); ++i) {
        fprintf(out, "  %-14s %s\n", pe_solver(i).name, pe_solver(i).description);
    }
}

_Noreturn __attribute__((format(printf, 2, 3))) static void quit(int code, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("solve_benchmark: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    exit(code);
}

static void *allocate(size_t count, size_t size)
{
    void *made = calloc(count > 0 ? count : 1, size);
    if (made == NULL) {
        quit(EXIT_IO, "out of memory");
    }
    return made;
}

/* ---- Options ---- */

typedef struct options {
    pe_solver_info solvers[MOST_SOLVERS];
    int solver_count;
    FILE *json;
} options;

static pe_solver_info solver_named(const char *name)
{
    for (int i = 0; i < pe_solver_count(); ++i) {
        if (strcmp(pe_solver(i).name, name) == 0) {
            return pe_solver(i);
        }
    }
    quit(EXIT_USAGE, "there is no solver %s; --help lists them", name);
}

static options parse(int argc, char **argv)
{
    static const struct option known[] = {{"solver", required_argument, NULL, 's'},
                                          {"json", required_argument, NULL, 'j'},
                                          {"help", no_argument, NULL, 'h'},
                                          {0}};
    options o = {.json = NULL};
    const char *json = NULL;
    for (int option; (option = getopt_long(argc, argv, "", known, NULL)) != -1;) {
        if (option == 's' && o.solver_count < MOST_SOLVERS) {
            o.solvers[o.solver_count++] = solver_named(optarg);
        } else if (option == 'j') {
            json = optarg;
        } else if (option == 'h') {
            print_help(stdout);
            exit(EXIT_SUCCESS);
        } else {
            exit(EXIT_USAGE);
        }
    }
    if (optind == argc) {
        quit(EXIT_USAGE, "expected the files of contact problems; see --help");
    }
    for (int i = 0; i < pe_solver_count() && o.solver_count == i; ++i) {
        o.solvers[o.solver_count++] = pe_solver(i);
    }
    o.json = json == NULL ? NULL : fopen(json, "w");
    if (json != NULL && o.json == NULL) {
        quit(EXIT_IO, "%s: %s", json, strerror(errno));
    }
    return o;
}

/* ---- JSON lines ---- */

/* null for a number that is not finite. */
static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static void write_run(FILE *out, const benchmark_problem *problem, const solver_run *run)
{
    for (int k = 0; k < run->count; ++k) {
        const level *l = &run->levels[k];
        json_t *line = json_pack(
            "{s:s, s:i, s:i, s:i, s:s, s:s, s:f, s:o, s:b, s:s, s:i, s:o, s:o, s:o}", "problem",
            problem->path, "bodies", problem->data->body_count, "manifolds",
            problem->data->manifold_count, "points", problem->data->point_count, "solver",
            run->solver.name, "start", run->cold ? "cold" : "warm", "tolerance",
            level_tolerances[k], "start_residual", number(l->start.max), "reached", l->reached,
            "stop", l->stop, "iterations", l->iterations, "seconds", number(l->seconds),
            "residual_max", number(l->residual.max), "residual_rms", number(l->residual.rms));
        json_dumpf(line, out, JSON_COMPACT | JSON_REAL_PRECISION(17));
        fputc('\n', out);
        json_decref(line);
    }
}

/* ---- Problems ---- */

static benchmark_problem read_problem(const char *path)
{
    const char *slash = strrchr(path, '/');
    char message[PROBLEM_MESSAGE_SIZE];
    char *name = strdup(slash == NULL ? path : slash + 1);
    char *end = name == NULL ? NULL : strstr(name, ".json");
    if (end != NULL && end > name) {
        *end = '\0';
    }
    benchmark_problem problem = {path, name, problem_read_file(path, message), NULL};
    if (problem.data == NULL || name == NULL) {
        quit(EXIT_USAGE, "%s", name == NULL ? "out of memory" : message);
    }
    return problem;
}

static void solve_problem(const options *o, benchmark_problem *problem)
{
    problem->runs = allocate(2 * (size_t)o->solver_count, sizeof *problem->runs);
    for (int i = 0; i < 2 * o->solver_count; ++i) {
        const bool cold = i >= o->solver_count;
        const pe_solver_info solver = o->solvers[i % o->solver_count];
        fprintf(stderr, "%s, %s, %s\n", problem->name, cold ? "cold" : "warm", solver.name);
        if (!solve_levels(problem->data, solver, cold, &problem->runs[i])) {
            quit(EXIT_IO, "no process could be made: %s", strerror(errno));
        }
        if (o->json != NULL) {
            write_run(o->json, problem, &problem->runs[i]);
        }
    }
}

int main(int argc, char **argv)
{
    const options o = parse(argc, argv);
    const int count = argc - optind;
    benchmark_problem *problems = allocate((size_t)count, sizeof *problems);
    for (int i = 0; i < count; ++i) {
        problems[i] = read_problem(argv[optind + i]);
    }
    for (int i = 0; i < count; ++i) {
        solve_problem(&o, &problems[i]);
    }
    print_tables(problems, count, o.solver_count);
    for (int i = 0; i < count; ++i) {
        pe_contact_problem_destroy(problems[i].data);
        free(problems[i].name);
        free(problems[i].runs);
    }
    free(problems);
    if ((o.json != NULL && fclose(o.json) != 0) || fflush(stdout) != 0) {
        quit(EXIT_IO, "%s", strerror(errno));
    }
    return EXIT_SUCCESS;
}
