/* Published numbers next to results made by hand. */
#include "check.h"
#include "plumb_process.h"
#include "report_rows.h"

#include <stdlib.h>
#include <string.h>

/* A tower with the parameters of its defaults but for n and one more. */
static json_t *add_tower(json_t *results, int n, const char *other, double value, const char *label,
                         const char *outcome)
{
    const pl_scenario *tower = pl_scenario_find("tower", NULL);
    json_t *row = add_run(results, "tower", label, outcome), *params = json_object();
    for (int i = 0; i < tower->param_count; ++i) {
        const pl_param *param = &tower->params[i];
        bool is_other = other != NULL && strcmp(param->name, other) == 0;
        json_object_set_new(params, param->name, json_real(is_other ? value : param->value));
    }
    json_object_set_new(params, "n", json_integer(n));
    json_object_set_new(row, "params", params);
    set_verdict(row, strcmp(outcome, "ok") == 0 ? "accurate" : "failed", "");
    return row;
}

static json_t *iterations_reported(double value)
{
    return json_pack("{s:f, s:s}", "value", value, "unit", "1");
}

static json_t *no_iterations(void)
{
    return json_pack("{s:n, s:s, s:s}", "value", "unit", "1", "reason", "the engine reports none");
}

/* The three towers on three engines: one that reports nothing, one that fell. */
static json_t *three_towers(void)
{
    static const int sizes[] = {5, 10, 25};
    json_t *results = json_array();
    for (int i = 0; i < 3; ++i) {
        json_t *row = add_tower(results, sizes[i], "duration", 3, "plumb:fast", "ok");
        set_metric(row, "iterations_mean", iterations_reported(2.5 + i));
        row = add_tower(results, sizes[i], "duration", 3, "ode:dantzig", "ok");
        set_metric(row, "iterations_mean", no_iterations());
        row = add_tower(results, sizes[i], "duration", 3, "ode:quick", i == 2 ? "collapsed" : "ok");
        set_metric(row, "iterations_mean", iterations_reported(20));
    }
    return results;
}

static void test_summary_shows_published_numbers_next_to_engines(void **state)
{
    (void)state;
    made_report made = make_report(three_towers());
    const char *text = made.markdown;
    assert_contains(text, "| case | published | plumb:fast | ode:dantzig | ode:quick |\n");
    assert_contains(text, "| 1.65 | 2.50, accurate | –, accurate | 20.0, accurate |\n");
    assert_contains(text, "| 36 | 3.50, accurate | –, accurate | 20.0, accurate |\n");
    assert_contains(text, "| 47 | 4.50, accurate | –, accurate | 20.0, failed: collapsed |\n");
    assert_contains(text, "Table 2");
    assert_before(text, "| 1.65 |", "| 36 |");
    assert_before(text, "| 36 |", "| 47 |");
    free_report(&made);
}

static void test_published_numbers_need_all_their_cases(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_tower(results, 5, NULL, 0, "plumb:fast", "ok");
    add_tower(results, 10, NULL, 0, "plumb:fast", "ok");
    made_report made = make_report(results);
    assert_absent(made.markdown, "published");
    free_report(&made);
}

/* A tower of displaced or heavier cubes is another case; one of another step is the same. */
static void test_other_parameters_are_another_case(void **state)
{
    (void)state;
    static const char *const others[] = {"offset", "top_mass", "friction", "dt", "duration"};
    static const bool same[] = {false, false, false, true, true};
    for (int i = 0; i < 5; ++i) {
        json_t *results = json_array();
        add_tower(results, 5, others[i], 0.125, "plumb:fast", "ok");
        add_tower(results, 10, NULL, 0, "plumb:fast", "ok");
        add_tower(results, 25, NULL, 0, "plumb:fast", "ok");
        made_report made = make_report(results);
        assert_int_equal(made.table->case_count, 3);
        assert_int_equal(count_of(made.markdown, "## Next to published numbers"), same[i]);
        free_report(&made);
    }
}

/* Runs the command for a few steps: an engine that reports no iterations has no number of them, not
 * 0. */
static void test_compare_writes_the_published_table(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *out = path_in(directory, "report");
    const char *const arguments[] = {"compare", "--suite",  "paper",       "--engine",
                                     "plumb",   "--engine", "ode:dantzig", "--duration",
                                     "0.05",    "--out",    out,           NULL};
    plumb_output output = run_plumb(directory, arguments);
    assert_int_equal(output.code, 0);
    char *path = path_in(out, "summary.md");
    char *summary = read_text(path);
    assert_non_null(summary);
    assert_contains(summary, "| tower n=5 duration=0.05 s | 1.65 | ");
    assert_contains(summary, "| tower duration=0.05 s | 36 | ");
    assert_contains(summary, "| tower n=25 duration=0.05 s | 47 | ");
    assert_int_equal(count_of(summary, " | –, "), 3);
    free(summary);
    free(path);
    free(out);
    free_output(&output);
    remove_directory(directory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_summary_shows_published_numbers_next_to_engines),
        cmocka_unit_test(test_published_numbers_need_all_their_cases),
        cmocka_unit_test(test_other_parameters_are_another_case),
        cmocka_unit_test(test_compare_writes_the_published_table),
    };
    return cmocka_run_group_tests_name("published", tests, NULL, NULL);
}
