#include "benchmark.h"

#include "benchmark_report.h"
#include "results/result.h"
#include "results/store.h"

#include <stdlib.h>
#include <string.h>

/* What is known of a problem that could not be captured. */
static json_t *failed_problem(const pl_benchmark_problem *row, const char *message)
{
    return json_pack("{s:s, s:s, s:o, s:[]}", "name", row->name, "scenario", row->scenario, "error",
                     pl_json_text(message, strlen(message)), "cells");
}

static pl_status run_problem(const pl_benchmark_problem *row, json_t *problems, pl_error *error)
{
    pe_contact_problem *problem = NULL;
    json_t *result = NULL;
    pl_error failure = {.message = ""};
    pl_status status = PL_OK;
    fprintf(stderr, "%s: capturing\n", row->name);
    if (pl_benchmark_capture(row, &problem, &failure) == PL_OK) {
        status = pl_benchmark_solve(row, problem, stderr, &result, error);
        pe_contact_problem_destroy(problem);
    } else {
        result = failed_problem(row, failure.message);
    }
    if (status == PL_OK && json_array_append_new(problems, result) != 0) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    return status;
}

/* DIRECTORY/solver-benchmark.SUFFIX. Takes `text`. */
static pl_status write_text(const char *directory, const char *suffix, char *text, pl_error *error)
{
    char *path = malloc(strlen(directory) + 64);
    pl_status status = PL_OK;
    if (path == NULL || text == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for the benchmark's report");
    } else {
        sprintf(path, "%s/solver-benchmark.%s", directory, suffix);
        status = pl_write_text(path, text, strlen(text), error);
    }
    free(path);
    free(text);
    return status;
}

static pl_status write_all(const char *directory, const json_t *result, pl_error *error)
{
    char *markdown = pl_benchmark_markdown(result);
    if (markdown != NULL) {
        fputs(markdown, stdout);
    }
    pl_status status = write_text(directory, "md", markdown, error);
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

pl_status pl_benchmark_run(const pl_benchmark_problem *rows, int count, const char *directory,
                           int argc, char *const *argv, pl_error *error)
{
    json_t *result = pl_provenance(argc, argv);
    json_t *problems = json_array();
    char started[32];
    pl_timestamp(started);
    pl_status status = pl_make_directories(directory, error);
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = run_problem(&rows[i], problems, error);
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
