/* plumb compare --iterations-to-tolerance on a tower of 5: the metric is what it says it is. */
#include "check.h"
#include "engines/registry.h"
#include "plumb_process.h"
#include "results/result.h"
#include "results/store.h"
#include "run_result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_built_in(const char *engine)
{
    pl_engine_choice choice;
    return pl_engine_choose(engine, &choice, NULL) == PL_OK;
}

static void skip_without_others(void)
{
    if (!is_built_in("bullet") || !is_built_in("ode")) {
        skip();
    }
}

static const char name[] = "iterations_to_tolerance";

static plumb_output compare(const workspace *f, const char *const *more)
{
    const char *arguments[32] = {"compare", "tower", "--set", "n=5", "--out", f->out};
    int count = 6;
    bool resumes = false;
    for (; *more != NULL; ++more) {
        resumes = resumes || strcmp(*more, "--resume") == 0;
        arguments[count++] = *more;
    }
    arguments[count] = resumes ? NULL : "--force";
    plumb_output output = run_plumb(f->directory, arguments);
    if (output.code != 0) {
        print_error("%s", output.err);
    }
    assert_int_equal(output.code, 0);
    return output;
}

static json_t *read_results(const workspace *f)
{
    json_t *results = NULL;
    assert_int_equal(pl_results_read(f->results, &results, NULL, NULL), PL_OK);
    json_t *own = pl_results_of_study(results, NULL);
    json_decref(results);
    return own;
}

static const json_t *metric_of(const json_t *results, const char *label)
{
    return json_object_get(json_object_get(result_of(results, label), "metrics"), name);
}

/* The largest budget that the search told of, as a line of progress a run. */
static long largest_budget(const char *progress, const char *label)
{
    char text[64];
    long largest = 0;
    snprintf(text, sizeof text, "%s,iterations=", label);
    for (const char *at = strstr(progress, text); at != NULL; at = strstr(at + 1, text)) {
        long budget = strtol(at + strlen(text), NULL, 10);
        largest = budget > largest ? budget : largest;
    }
    return largest;
}

/* INFINITY where the run is not ok. */
static double error_with(const char *label, long budget)
{
    char spec[64];
    snprintf(spec, sizeof spec, "%s,iterations=%ld", label, budget);
    json_t *result = run_to_json((const char *const[]){"run", "tower", "--set", "n=5", "--duration",
                                                       "2", "--engine", spec, "--json", "-", NULL});
    bool ok = strcmp(result_text(result, "outcome"), "ok") == 0;
    double error = ok ? metric(result, "reference_error") : (double)INFINITY;
    json_decref(result);
    return error;
}

static void check_budget(const json_t *results, const char *progress, const char *label)
{
    const json_t *found = metric_of(results, label);
    assert_non_null(found);
    assert_string_equal(result_text(found, "unit"), "1");
    assert_string_equal(result_text(found, "direction"), "lower");
    assert_true(json_is_true(json_object_get(found, "deterministic")));
    double value = json_number_value(json_object_get(found, "value"));
    long budget = (long)value, largest = largest_budget(progress, label), above = 1;
    assert_close((double)budget, value, 0, 0);
    assert_true(budget >= 1 && budget <= largest && largest <= 1024);
    while (above <= budget) {
        above *= 2;
    }
    double near = 1.1 * error_with(label, largest) + 1e-9;
    assert_at_most(error_with(label, budget), near);
    if (above <= largest) {
        assert_at_most(error_with(label, above), near);
    }
    if (budget > 1) {
        assert_true(error_with(label, budget - 1) > near);
    }
}

static void test_budget_is_the_least_near_the_converged_error(void **state)
{
    const workspace *f = *state;
    skip_without_others();
    plumb_output output =
        compare(f, (const char *const[]){"--engine", "bullet:si", "--engine", "ode:quick",
                                         "--engine", "ode:dantzig", "--engine", "plumb",
                                         "--duration", "2", "--iterations-to-tolerance", NULL});
    json_t *results = read_results(f);
    assert_int_equal(json_array_size(results), 4);
    check_budget(results, output.err, "bullet:si");
    check_budget(results, output.err, "ode:quick");
    check_budget(results, output.err, "plumb:default");
    /* It pivots. */
    assert_null(metric_of(results, "ode:dantzig"));
    /* All runs are counted, and the count ends at its total. */
    char last[32];
    int lines = count_of(output.err, "] tower  ");
    snprintf(last, sizeof last, "[%d/%d]", lines, lines);
    assert_contains(output.err, last);
    json_decref(results);
    free_output(&output);
}

static void test_it_is_in_every_form_of_the_report(void **state)
{
    const workspace *f = *state;
    skip_without_others();
    plumb_output output =
        compare(f, (const char *const[]){"--engine", "bullet:si", "--duration", "0.5", "--repeat",
                                         "2", "--json", "-", "--iterations-to-tolerance", NULL});
    json_t *rows = json_loads(output.out, 0, NULL);
    assert_int_equal(json_array_size(rows), 2);
    const json_t *first =
        json_object_get(json_object_get(json_array_get(rows, 0), "metrics"), name);
    assert_non_null(first);
    assert_true(json_equal(
        first, json_object_get(json_object_get(json_array_get(rows, 1), "metrics"), name)));
    json_decref(rows);
    static const char *const files[] = {"results.jsonl", "results.csv", "index.html"};
    for (int i = 0; i < 3; ++i) {
        char *path = path_in(f->out, files[i]);
        char *text = read_text(path);
        assert_contains(text, name);
        free(text);
        free(path);
    }
    free_output(&output);
}

static void test_what_is_there_is_not_searched_again(void **state)
{
    const workspace *f = *state;
    skip_without_others();
    static const char *const asked[] = {"--engine", "bullet:si", "--duration",
                                        "0.5",      "--resume",  "--iterations-to-tolerance",
                                        NULL};
    plumb_output output = compare(f, asked);
    free_output(&output);
    output = compare(f, asked);
    assert_absent(output.err, "iterations=");
    json_t *results = read_results(f);
    assert_non_null(json_array_get(results, 0));
    free_output(&output);
    json_decref(results);
}

static void test_without_the_option_there_is_no_such_metric(void **state)
{
    const workspace *f = *state;
    skip_without_others();
    plumb_output output =
        compare(f, (const char *const[]){"--engine", "bullet:si", "--duration", "0.5", NULL});
    json_t *results = read_results(f);
    assert_null(metric_of(results, "bullet:si"));
    assert_absent(output.err, "iterations=");
    json_decref(results);
    free_output(&output);
}

/* A search that cannot end leaves its reason in place of the value. */
static void test_runs_out_of_time_leave_a_reason(void **state)
{
    const workspace *f = *state;
    skip_without_others();
    plumb_output output =
        compare(f, (const char *const[]){"--engine", "ode:quick", "--timeout", "0.001",
                                         "--iterations-to-tolerance", NULL});
    json_t *results = read_results(f);
    const json_t *found = metric_of(results, "ode:quick");
    assert_true(json_is_null(json_object_get(found, "value")));
    assert_contains(result_text(found, "reason"), "timeout with 1 iterations");
    assert_string_equal(result_text(result_of(results, "ode:quick"), "outcome"), "timeout");
    json_decref(results);
    free_output(&output);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_budget_is_the_least_near_the_converged_error),
        cmocka_unit_test(test_it_is_in_every_form_of_the_report),
        cmocka_unit_test(test_what_is_there_is_not_searched_again),
        cmocka_unit_test(test_without_the_option_there_is_no_such_metric),
        cmocka_unit_test(test_runs_out_of_time_leave_a_reason),
    };
    return cmocka_run_group_tests_name("iterations", tests, setup_workspace, teardown_workspace);
}
