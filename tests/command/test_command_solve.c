/* plumb run --capture and plumb solve as a user meets them. */
#include "check.h"
#include "contact_problem_for_tests.h"
#include "plumb/scenario.h"
#include "plumb_process.h"
#include "studies/solve/benchmark.h"
#include "studies/solve/problem_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A directory with the file of a problem in it. */
typedef struct desk {
    char *directory, *file;
} desk;

static int set_up(void **state)
{
    desk *d = malloc(sizeof *d);
    assert_non_null(d);
    d->directory = make_directory();
    d->file = path_in(d->directory, "tower.json");
    const double masses[] = {1, 1, 2, 1};
    pe_contact_problem *problem = problem_of_tower(masses, 4, 0.5);
    pl_error error;
    json_t *source = json_pack("{s:s, s:i}", "scenario", "tower", "step", 12);
    assert_int_equal(pl_problem_write_file(d->file, problem, source, &error), PL_OK);
    json_decref(source);
    pe_contact_problem_destroy(problem);
    *state = d;
    return 0;
}

static int tear_down(void **state)
{
    desk *d = *state;
    remove_directory(d->directory);
    free(d->file);
    free(d);
    return 0;
}

static plumb_output call(const desk *d, const char *const *arguments)
{
    return run_plumb(d->directory, arguments);
}

#define CALL(d, ...) call(d, (const char *const[]){__VA_ARGS__, NULL})

static void check(plumb_output output, int code, const char *out, const char *err)
{
    if (output.code != code) {
        print_error("exit code %d, expected %d\n%s%s", output.code, code, output.out, output.err);
    }
    assert_int_equal(output.code, code);
    assert_contains(output.out, out);
    assert_contains(output.err, err);
    free_output(&output);
}

static json_t *parse(const char *text)
{
    json_t *json = json_loads(text, 0, NULL);
    if (json == NULL) {
        fail_msg("no JSON: %s", text);
    }
    return json;
}

/* ---- solve ---- */

static void test_solve_prints_the_outcome_and_the_history(void **state)
{
    desk *d = *state;
    check(CALL(d, "solve", d->file, "--solver", "direct"), 0, "converged", "");
    plumb_output output = CALL(d, "solve", d->file, "--solver", "momentum");
    assert_contains(output.out, "4 bodies, 4 manifolds, 16 contact points; tower, step 12");
    assert_contains(output.out, "warm start: residual 0.164 m/s");
    assert_contains(output.out, "iterations  residual, m/s  time, ms");
    assert_contains(output.out, "  ****");
    free_output(&output);
}

static void test_solve_all_prints_a_row_for_every_solver(void **state)
{
    desk *d = *state;
    plumb_output output = CALL(d, "solve", d->file, "--solver", "all", "--solver", "newton");
    assert_int_equal(output.code, 0);
    for (int i = 0; i < pe_solver_count(); ++i) {
        char row[64];
        snprintf(row, sizeof row, "\n%s ", pe_solver(i).name);
        assert_int_equal(count_of(output.out, row), 1);
    }
    free_output(&output);
}

static void test_solve_exits_3_if_no_solver_converges(void **state)
{
    desk *d = *state;
    check(CALL(d, "solve", d->file, "--solver", "gauss_seidel", "--max-iterations", "2"), 3,
          "iteration limit", "");
    check(CALL(d, "solve", d->file, "--solver", "gauss_seidel", "--max-iterations", "2",
               "--tolerance", "1"),
          0, "converged", "");
}

static void test_solve_json_has_the_solution_and_its_history(void **state)
{
    desk *d = *state;
    plumb_output output =
        CALL(d, "solve", d->file, "--solver", "direct", "--solver", "momentum", "--json", "-");
    assert_int_equal(output.code, 0);
    json_t *json = parse(output.out);
    assert_string_equal(json_string_value(json_object_get(json, "schema")), "plumb.solve/1");
    const json_t *solvers = json_object_get(json, "solvers");
    assert_int_equal(json_array_size(solvers), 2);
    for (size_t i = 0; i < 2; ++i) {
        const json_t *solver = json_array_get(solvers, i);
        const json_t *history = json_object_get(solver, "history");
        const json_t *impulses = json_object_get(solver, "impulses");
        double carried = 0;
        assert_string_equal(json_string_value(json_object_get(solver, "outcome")), "converged");
        assert_int_equal(json_array_size(impulses), 16);
        assert_int_equal(json_array_size(json_object_get(solver, "velocities")), 4);
        assert_true(json_array_size(history) >= 2);
        for (size_t k = 0; k < 4; ++k) {
            carried += json_number_value(json_array_get(json_array_get(impulses, k), 0));
        }
        assert_close(carried, 5 * GRAVITY * STEP, 1e-6, 0);
    }
    json_decref(json);
    free_output(&output);
}

static void test_solve_cold_starts_from_zero_impulses(void **state)
{
    desk *d = *state;
    char *path = path_in(d->directory, "warm.json");
    pe_contact_problem *problem = problem_of_box_on_floor(1, 0.5);
    for (int k = 0; k < 4; ++k) {
        problem->points[k].impulse[0] = GRAVITY * STEP / 4;
    }
    pl_error error;
    assert_int_equal(pl_problem_write_file(path, problem, NULL, &error), PL_OK);
    pe_contact_problem_destroy(problem);
    plumb_output warm = CALL(d, "solve", path, "--solver", "direct", "--json", "-");
    plumb_output cold = CALL(d, "solve", path, "--solver", "direct", "--json", "-", "--cold");
    json_t *warm_json = parse(warm.out), *cold_json = parse(cold.out);
    assert_at_most(json_number_value(json_object_get(warm_json, "start_residual_max")), 1e-12);
    assert_close(json_number_value(json_object_get(cold_json, "start_residual_max")),
                 GRAVITY * STEP, 1e-12, 0);
    json_decref(warm_json);
    json_decref(cold_json);
    free_output(&warm);
    free_output(&cold);
    free(path);
}

static void test_solve_exits_2_on_bad_usage_with_reason(void **state)
{
    desk *d = *state;
    check(CALL(d, "solve"), 2, "", "which problem?");
    check(CALL(d, "solve", d->file), 2, "", "which solver?");
    check(CALL(d, "solve", d->file, "--solver", "newtn"), 2, "", "did you mean newton?");
    check(CALL(d, "solve", d->file, "x.json", "--solver", "all"), 2, "", "one problem at a time");
    check(CALL(d, "solve", d->file, "--solver", "all", "--tolerance", "0"), 2, "", "--tolerance");
    check(CALL(d, "solve", d->file, "--solver", "all", "--tolerance", "nan"), 2, "", "--tolerance");
    check(CALL(d, "solve", d->file, "--solver", "all", "--max-iterations", "1.5"), 2, "",
          "--max-iterations");
    check(CALL(d, "solve", d->file, "--solver", "all", "--out", "x"), 2, "", "--benchmark");
    check(CALL(d, "solve", d->file, "--benchmark"), 2, "", "own problems");
    check(CALL(d, "solve", d->file, "--solvr", "all"), 2, "", "did you mean --solver?");
}

static void test_solve_exits_2_on_bad_file_with_place(void **state)
{
    desk *d = *state;
    char *path = path_in(d->directory, "bad.json");
    write_text(path, "{ \"schema\": \"plumb.contact_problem/1\",\n  \"bodies\": [ { \"mass\": 0, "
                     "\"inertia\": [1, 0, 0, 1, 0, 1], \"free_velocity\": [0, 0, 0, 0, 0, 0] } ],\n"
                     "  \"manifolds\": [] }\n");
    check(CALL(d, "solve", path, "--solver", "all"), 2, "",
          "bad.json:2:25: bodies[0].mass: expected a finite number above 0, found 0");
    check(CALL(d, "solve", "/nowhere.json", "--solver", "all"), 2, "", "/nowhere.json: expected");
    free(path);
}

static void test_solve_help_lists_the_solvers(void **state)
{
    desk *d = *state;
    plumb_output output = CALL(d, "help", "solve");
    assert_int_equal(output.code, 0);
    for (int i = 0; i < pe_solver_count(); ++i) {
        assert_contains(output.out, pe_solver(i).name);
    }
    free_output(&output);
}

/* ---- run --capture ---- */

static void test_run_captures_a_problem_that_solve_takes(void **state)
{
    desk *d = *state;
    char *path = path_in(d->directory, "captured.json");
    char *option = NULL;
    assert_true(asprintf(&option, "--capture=20:%s", path) >= 0);
    check(CALL(d, "run", "tower", "--set", "n=3", "--duration", "0.5", "--engine", "plumb", option),
          0, "30 of 30 steps", "");
    pe_contact_problem *problem = NULL;
    json_t *source = NULL;
    pl_error error;
    assert_int_equal(pl_problem_read_file(path, &problem, &source, &error), PL_OK);
    assert_int_equal(problem->body_count, 3);
    assert_int_equal(problem->manifold_count, 3);
    assert_string_equal(json_string_value(json_object_get(source, "scenario")), "tower");
    assert_string_equal(json_string_value(json_object_get(source, "engine")), "plumb");
    assert_true(json_number_value(json_object_get(source, "step")) == 20);
    assert_true(json_number_value(json_object_get(source, "islands")) == 1);
    assert_true(json_number_value(json_object_get(json_object_get(source, "params"), "n")) == 3);
    check(CALL(d, "solve", path, "--solver", "direct"), 0, "tower, step 20", "");
    json_decref(source);
    pe_contact_problem_destroy(problem);
    free(option);
    free(path);
}

static void test_run_captures_every_island_if_path_has_braces(void **state)
{
    desk *d = *state;
    char *option = NULL, *scene = path_in(d->directory, "two.json");
    write_text(
        scene,
        "{ \"plumb_scene\": 1, \"duration\": 0.1, \"bodies\": [\n"
        "  { \"name\": \"floor\", \"shape\": { \"type\": \"plane\", \"normal\": [0, 0, 1], "
        "\"offset\": 0 } },\n"
        "  { \"name\": \"a\", \"mass\": 1, \"position\": [0, 0, 0.5], \"shape\": { \"type\": "
        "\"sphere\", \"radius\": 0.5 } },\n"
        "  { \"name\": \"b\", \"mass\": 2, \"position\": [3, 0, 0.5], \"shape\": { \"type\": "
        "\"box\", \"half_extents\": [0.5, 0.5, 0.5] } } ] }\n");
    assert_true(asprintf(&option, "--capture=2:%s/island{}.json", d->directory) >= 0);
    check(CALL(d, "run", scene, "--engine", "plumb", option), 0, "6 of 6 steps", "");
    for (int k = 1; k <= 2; ++k) {
        char *path = NULL;
        pe_contact_problem *problem = NULL;
        json_t *source = NULL;
        pl_error error;
        assert_true(asprintf(&path, "%s/island%d.json", d->directory, k) >= 0);
        assert_int_equal(pl_problem_read_file(path, &problem, &source, &error), PL_OK);
        assert_int_equal(problem->body_count, 1);
        assert_true(problem->bodies[0].mass == k);
        json_decref(source);
        pe_contact_problem_destroy(problem);
        free(path);
    }
    free(option);
    free(scene);
}

static void test_capturing_does_not_change_the_result(void **state)
{
    desk *d = *state;
    char *option = NULL;
    assert_true(asprintf(&option, "--capture=5:%s/x.json", d->directory) >= 0);
    json_t *hashes[2];
    for (int k = 0; k < 2; ++k) {
        plumb_output output = k == 0 ? CALL(d, "run", "slope-slide", "--duration", "0.5",
                                            "--engine", "plumb", "--json", "-")
                                     : CALL(d, "run", "slope-slide", "--duration", "0.5",
                                            "--engine", "plumb", "--json", "-", option);
        assert_int_equal(output.code, 0);
        json_t *json = parse(output.out);
        const json_t *metrics = json_object_get(json, "metrics");
        hashes[k] = json_deep_copy(json_object_get(metrics, "state_hash"));
        assert_non_null(hashes[k]);
        json_decref(json);
        free_output(&output);
    }
    assert_true(json_equal(hashes[0], hashes[1]));
    json_decref(hashes[0]);
    json_decref(hashes[1]);
    free(option);
}

static void test_run_reports_impossible_captures(void **state)
{
    desk *d = *state;
    check(CALL(d, "run", "tower", "--engine", "plumb", "--capture", "x.json"), 2, "", "STEP:FILE");
    check(CALL(d, "run", "tower", "--engine", "plumb", "--capture", "0:x.json"), 2, "",
          "STEP:FILE");
    check(CALL(d, "run", "tower", "--engine", "plumb", "--capture", "5:"), 2, "", "STEP:FILE");
    check(CALL(d, "run", "tower", "--engine", "plumb", "--duration", "0.1", "--capture",
               "7:/tmp/x.json"),
          2, "", "expected a step of 1 to 6, found 7");
    check(CALL(d, "run", "tower", "--engine", FAULTY ":good", "--capture", "1:/tmp/x.json"), 3, "",
          "does not give its contact problems");
    check(CALL(d, "run", "pile", "--engine", "plumb", "--duration", "0.1", "--capture",
               "1:/nowhere/x.json"),
          3, "", "nothing to capture: step 1 has no contact");
    check(CALL(d, "run", "tower", "--engine", "plumb", "--duration", "0.1", "--capture",
               "2:/nowhere/x.json"),
          3, "", "/nowhere/x.json");
}

/* ---- The benchmark ---- */

static const pl_benchmark_problem small[] = {
    {"three cubes", "tower", {"n=3"}, .step = 2},
    {"nothing yet", "pile", {"n=2"}, .step = 1},
};

/* Replaces runs of spaces, with which tables are padded, by one. */
static void squeeze(char *text)
{
    char *to = text;
    for (const char *from = text; *from != '\0'; ++from) {
        if (*from != ' ' || to == text || to[-1] != ' ') {
            *to++ = *from;
        }
    }
    *to = '\0';
}

/* The problems of a benchmark that keeps a journal of so many values before it. */
static json_t *problems_with_journal(const desk *d, size_t before)
{
    pl_error error = {.message = ""};
    pl_journal *journal = NULL;
    char *report = path_in(d->directory, "report"), *path = pl_benchmark_path(report, "json");
    char *const argv[] = {"plumb", "solve", NULL};
    assert_int_equal(pl_journal_open(d->directory, "solve", "0", PL_STORE_RESUME, &journal, &error),
                     PL_OK);
    assert_int_equal(pl_journal_size(journal), before);
    assert_int_equal(pl_benchmark_run(small, 2, report, journal, 2, argv, &error), PL_OK);
    /* A value for each cell, and one for each problem. */
    assert_int_equal(pl_journal_size(journal), 2 * pe_solver_count() + 2);
    pl_journal_close(journal, false);
    char *text = read_text(path);
    json_t *json = parse(text);
    json_t *problems = json_incref(json_object_get(json, "problems"));
    json_decref(json);
    free(text);
    free(path);
    free(report);
    return problems;
}

static void test_a_resumed_benchmark_solves_nothing_again(void **state)
{
    json_t *first = problems_with_journal(*state, 0);
    json_t *again = problems_with_journal(*state, (size_t)(2 * pe_solver_count() + 2));
    assert_true(json_equal(first, again)); /* also in its times */
    json_decref(first);
    json_decref(again);
}

static void test_the_benchmark_writes_losses_first_and_every_cell(void **state)
{
    desk *d = *state;
    char *report = path_in(d->directory, "made/report");
    char *markdown_path = path_in(report, "solver-benchmark.md");
    char *csv_path = path_in(report, "solver-benchmark.csv");
    char *json_path = path_in(report, "solver-benchmark.json");
    char *const argv[] = {"plumb", "solve", NULL};
    pl_error error = {.message = ""};
    assert_int_equal(pl_benchmark_run(small, 2, report, NULL, 2, argv, &error), PL_OK);
    char *markdown = read_text(markdown_path), *csv = read_text(csv_path);
    char *json_text = read_text(json_path);
    assert_true(markdown != NULL && csv != NULL && json_text != NULL);
    squeeze(markdown);
    assert_before(markdown, "## Not reached", "## Slower than gauss_seidel");
    assert_before(markdown, "## Slower than gauss_seidel", "## Geometric means");
    assert_before(markdown, "## Geometric means", "### three cubes");
    assert_contains(markdown, "| nothing yet | | | | not captured: nothing yet: step 1 has no");
    json_t *json = parse(json_text);
    const json_t *problems = json_object_get(json, "problems");
    assert_int_equal(json_array_size(problems), 2);
    assert_int_equal(json_array_size(json_object_get(json_array_get(problems, 0), "cells")),
                     2 * pe_solver_count());
    assert_true(count_of(csv, "three cubes") > 2 * pe_solver_count());
    json_decref(json);
    free(markdown);
    free(csv);
    free(json_text);
    free(markdown_path);
    free(csv_path);
    free(json_path);
    free(report);
}

static json_t *level(double tolerance, int iterations, double seconds)
{
    return json_pack("{s:f, s:b, s:s, s:i, s:f}", "tolerance", tolerance, "reached", iterations > 0,
                     "stop", iterations > 0 ? "converged" : "stalled", "iterations", iterations,
                     "seconds", seconds);
}

/* A problem that the solver solved to 1e-3 m/s in these iterations and seconds (0: not solved). */
static json_t *made_problem(const char *name, int base, double base_seconds, int iterations,
                            double seconds)
{
    return json_pack("{s:s, s:s, s:[{s:s, s:s, s:[o]}, {s:s, s:s, s:[o]}]}", "name", name,
                     "scenario", "x", "cells", "solver", "gauss_seidel", "start", "warm", "levels",
                     level(1e-3, base, base_seconds), "solver", "momentum", "start", "warm",
                     "levels", level(1e-3, iterations, seconds));
}

static void test_benchmark_means_are_geometric_over_common_tolerances(void **state)
{
    (void)state;
    json_t *result =
        json_pack("{s:[o, o, o, o]}", "problems", made_problem("p", 100, 4e-3, 25, 1e-3),
                  made_problem("q", 10, 1e-3, 10, 4e-3), made_problem("r", 0, 1, 7, 1),
                  made_problem("s", 3, 1, 0, 1));
    char *markdown = pl_benchmark_text(result, 0);
    assert_non_null(markdown);
    squeeze(markdown);
    /* Iterations: root of 1/4 x 1; time: root of 1/4 x 4; one alone, one missed. */
    assert_contains(markdown, "| momentum | warm | 0.001 | 0.5 | 1 | 2 | 1 | 1 |");
    assert_contains(markdown, "| q | warm | momentum | 0.001 | 4.00 |");
    assert_absent(markdown, "| p | warm | momentum | 0.001 | 0.25 |");
    assert_contains(markdown, "| s | warm | momentum | 0.001 | stalled |");
    assert_contains(markdown, "| r | warm | gauss_seidel | 0.001 | stalled |");
    free(markdown);
    json_decref(result);
}

static void test_benchmark_table_names_existing_scenarios_and_parameters(void **state)
{
    (void)state;
    int count;
    const pl_benchmark_problem *rows = pl_benchmark_problems(&count);
    assert_true(count > 10);
    for (int i = 0; i < count; ++i) {
        double values[PL_MAX_PARAMS];
        pl_error error;
        const pl_scenario *scenario = pl_scenario_find(rows[i].scenario, &error);
        assert_non_null(scenario);
        int settings = 0;
        while (settings < PL_BENCHMARK_SETTINGS && rows[i].settings[settings] != NULL) {
            ++settings;
        }
        if (pl_scenario_values(scenario, rows[i].settings, settings, values, &error) != PL_OK) {
            fail_msg("%s: %s", rows[i].name, error.message);
        }
        assert_true(rows[i].held_out == (rows[i].seed > 100));
        for (int k = 0; k < i; ++k) {
            assert_string_not_equal(rows[k].name, rows[i].name);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solve_prints_the_outcome_and_the_history),
        cmocka_unit_test(test_solve_all_prints_a_row_for_every_solver),
        cmocka_unit_test(test_solve_exits_3_if_no_solver_converges),
        cmocka_unit_test(test_solve_json_has_the_solution_and_its_history),
        cmocka_unit_test(test_solve_cold_starts_from_zero_impulses),
        cmocka_unit_test(test_solve_exits_2_on_bad_usage_with_reason),
        cmocka_unit_test(test_solve_exits_2_on_bad_file_with_place),
        cmocka_unit_test(test_solve_help_lists_the_solvers),
        cmocka_unit_test(test_run_captures_a_problem_that_solve_takes),
        cmocka_unit_test(test_run_captures_every_island_if_path_has_braces),
        cmocka_unit_test(test_capturing_does_not_change_the_result),
        cmocka_unit_test(test_run_reports_impossible_captures),
        cmocka_unit_test(test_a_resumed_benchmark_solves_nothing_again),
        cmocka_unit_test(test_the_benchmark_writes_losses_first_and_every_cell),
        cmocka_unit_test(test_benchmark_means_are_geometric_over_common_tolerances),
        cmocka_unit_test(test_benchmark_table_names_existing_scenarios_and_parameters),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
