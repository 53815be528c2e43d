/* How results are gathered: numbers as text, repeats, cases and engines. */
#include "base/number_format.h"
#include "report/report.h"

#include "check.h"
#include "report_rows.h"

#include <math.h>
#include <stdlib.h>

/* ---- Numbers ---- */

static void test_quantity_has_three_digits_and_an_engineers_unit(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *unit, *text;
    } cases[] = {
        {1.2e-7, "m", "1.20e-7 m"},
        {0.0123456, "m", "0.0123 m"},
        {0, "m", "0 m"},
        {9.996, "1", "10.0"},
        {1234, "1", "1234"},
        {123456, "1", "1.23e5"},
        {-2.5e-9, "m/s", "-2.50e-9 m/s"},
        {4.32e-5, "s", "43.2 µs"},
        {1.5e-3, "s", "1.50 ms"},
        {0.9999, "s", "1.00 s"},
        {2e-10, "s", "0.200 ns"},
        {0, "s", "0 s"},
        {12345678, "bytes", "12.3 MB"},
        {512, "bytes", "512 B"},
        {0, "bytes", "0 B"},
        {0.001, "m", "0.00100 m"},
        {5e-324, "m", "4.94e-324 m"},
        {1, "as it says", "1.00 as it says"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char text[PL_QUANTITY_SIZE];
        pl_format_number(cases[i].value, cases[i].unit, text);
        assert_string_equal(text, cases[i].text);
    }
}

static void test_no_number_is_a_dash_and_never_zero(void **state)
{
    (void)state;
    char text[PL_QUANTITY_SIZE];
    pl_format_number((double)NAN, "m", text);
    assert_string_equal(text, "–");
    pl_format_number((double)INFINITY, "s", text);
    assert_string_equal(text, "–");
}

/* ---- Cells ---- */

static void test_repeats_give_the_median_and_its_absolute_deviation(void **state)
{
    (void)state;
    static const double times[] = {5e-3, 1e-3, 2e-3, 90e-3, 3e-3};
    json_t *results = json_array();
    for (int i = 0; i < 5; ++i) {
        json_t *row = add_run(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set_metric(row, "time_per_step", metric_value(times[i]));
    }
    made_report made = make_report(results);
    assert_int_equal(made.report.matrix.case_count, 1);
    assert_int_equal(made.report.matrix.column_count, 1);
    const pl_metric_summary *time =
        &made.report.matrix.cases[0].cells[0].metrics[PL_METRIC_TIME_PER_STEP];
    assert_int_equal(time->count, 5);
    assert_close(time->value, 3e-3, 0, 1e-15);
    assert_close(time->min, 1e-3, 0, 1e-15);
    assert_close(time->max, 90e-3, 0, 1e-15);
    assert_close(time->mad, 2e-3, 0, 1e-12); /* of 0, 1, 2, 2, 87 ms */
    assert_false(time->disagrees);
    assert_contains(made.data, "median of 5 repeats, 1.00 ms to 90.0 ms, MAD 2.00 ms");
    free_report(&made);
}

static void test_even_median_is_mean_of_the_central_two(void **state)
{
    (void)state;
    static const double times[] = {4e-3, 1e-3, 2e-3, 90e-3};
    json_t *results = json_array();
    for (int i = 0; i < 4; ++i) {
        json_t *row = add_run(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set_metric(row, "time_per_step", metric_value(times[i]));
    }
    made_report made = make_report(results);
    assert_close(made.report.matrix.cases[0].cells[0].metrics[PL_METRIC_TIME_PER_STEP].value, 3e-3,
                 0, 1e-15);
    free_report(&made);
}

static void test_differing_deterministic_repeats_are_marked(void **state)
{
    (void)state;
    json_t *results = json_array();
    for (int i = 0; i < 2; ++i) {
        json_t *row = add_run(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set_metric(row, "drift", metric_value(i == 0 ? 1.0 : nextafter(1.0, 2.0)));
    }
    made_report made = make_report(results);
    assert_true(made.report.matrix.disagrees);
    assert_int_equal(count_of(made.data, "\"disagrees\":true"), 2); /* the report, and the cell */
    assert_contains(made.markdown.data, "**Not deterministic:**");
    char *table = printed_table(made.results, false, 200);
    assert_contains(table, "(not deterministic)");
    free(table);
    free_report(&made);
}

static void test_repeats_that_agree_are_not_called_nondeterministic(void **state)
{
    (void)state;
    json_t *results = json_array();
    for (int i = 0; i < 3; ++i) {
        json_t *row = add_run(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set_metric(row, "drift", metric_value(0.1));
        set_metric(row, "state_hash", json_pack("{s:s}", "value", "00ff"));
        set_metric(row, "time_per_step", metric_value(1e-3 * (i + 1)));
    }
    made_report made = make_report(results);
    assert_false(made.report.matrix.disagrees);
    assert_absent(made.data, "\"disagrees\":true");
    assert_absent(made.markdown.data, "ot deterministic");
    free_report(&made);
}

static void test_one_failed_repeat_makes_the_run_failed(void **state)
{
    (void)state;
    json_t *results = json_array();
    for (int i = 0; i < 3; ++i) {
        json_t *row = add_run(results, "s", "ode:quick", i == 1 ? "crashed" : "ok");
        json_object_set_new(row, "repeat", json_integer(i));
    }
    made_report made = make_report(results);
    const pl_cell *cell = &made.report.matrix.cases[0].cells[0];
    assert_false(cell->ok);
    assert_int_equal(cell->ok_repeats, 2);
    assert_true(pl_cell_disagrees(cell));
    assert_contains(made.data, "\"repeats\":3,\"ok_repeats\":2");
    assert_contains(made.markdown.data, "crashed in 1 of 3");
    free_report(&made);
}

static void test_order_of_rows_does_not_change_the_pages(void **state)
{
    (void)state;
    json_t *forward = runs_of_every_kind(), *backward = json_array();
    for (size_t i = json_array_size(forward); i-- > 0;) {
        json_array_append(backward, json_array_get(forward, i));
    }
    made_report a = make_report(forward), b = make_report(backward);
    assert_string_equal(a.data, b.data);
    assert_string_equal(a.markdown.data, b.markdown.data);
    free_report(&a);
    free_report(&b);
}

static void test_row_that_was_merged_twice_counts_once(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add_run(results, "s", "ode:quick", "ok");
    json_array_append_new(results, json_deep_copy(row));
    made_report made = make_report(results);
    assert_int_equal(made.report.matrix.run_count, 1);
    free_report(&made);
}

static void test_parameters_seed_and_scene_make_separate_cases(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_run(results, "s", "ode:quick", "ok");
    json_object_set_new(json_object_get(add_run(results, "s", "ode:quick", "ok"), "params"), "n",
                        json_integer(5));
    json_object_set_new(add_run(results, "s", "ode:quick", "ok"), "seed", json_integer(7));
    json_object_set_new(add_run(results, "s", "ode:quick", "ok"), "scene_hash",
                        json_string("beef"));
    made_report made = make_report(results);
    assert_int_equal(made.report.matrix.case_count, 4);
    for (int i = 0; i < 4; ++i) {
        assert_int_equal(made.report.matrix.cases[i].cells[0].repeats, 1);
    }
    assert_contains(made.data, "s seed=7");
    free_report(&made);
}

static void test_two_versions_of_an_engine_are_two_columns(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_run(results, "s", "ode:quick", "ok");
    json_object_set_new(add_run(results, "s", "ode:quick", "ok"), "engine_version",
                        json_string("2.0"));
    made_report made = make_report(results);
    assert_int_equal(made.report.matrix.column_count, 2);
    assert_string_equal(made.report.matrix.columns[0].name, "ode:quick 1.0");
    assert_string_equal(made.report.matrix.columns[1].name, "ode:quick 2.0");
    free_report(&made);
}

static void test_bad_row_is_named_with_what_was_expected(void **state)
{
    (void)state;
    static const char *const texts[][2] = {
        {"{}", "expected an array"},
        {"[1]", "results[0]: expected an object"},
        {"[{}]", "results[0].schema: expected \"plumb.result/1\", found \"\""},
        {"[{\"schema\":\"plumb.result/2\"}]", "found \"plumb.result/2\""},
        {"[{\"schema\":\"plumb.result/1\",\"scenario\":1}]",
         "results[0].scenario: expected a string"},
        {"[{\"schema\":\"plumb.result/1\",\"scenario\":\"s\",\"engine\":\"e\",\"label\":\"l\","
         "\"outcome\":\"ok\",\"metrics\":[]}]",
         "results[0].metrics: expected an object"},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        json_t *results = json_loads(texts[i][0], 0, NULL);
        pl_error error = {PL_OK, ""};
        const pl_report_def def = {.directory = "/nonexistent", .results = results};
        assert_int_equal(pl_report_write(&def, &error), PL_BAD_INPUT);
        assert_contains(error.message, texts[i][1]);
        char *table = printed_table(results, false, 80);
        assert_contains(table, texts[i][1]);
        free(table);
        json_decref(results);
    }
}

static void test_result_with_required_keys_only_makes_a_page(void **state)
{
    (void)state;
    made_report made = make_report(json_loads(
        "[{\"schema\":\"plumb.result/1\",\"scenario\":\"s\",\"engine\":\"e\",\"label\":\"l\","
        "\"outcome\":\"ok\",\"metrics\":{\"drift\":3,\"creep\":{\"value\":[]}}}]",
        0, NULL));
    assert_contains(made.data, "\"kind\":\"report\"");
    free_report(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quantity_has_three_digits_and_an_engineers_unit),
        cmocka_unit_test(test_no_number_is_a_dash_and_never_zero),
        cmocka_unit_test(test_repeats_give_the_median_and_its_absolute_deviation),
        cmocka_unit_test(test_even_median_is_mean_of_the_central_two),
        cmocka_unit_test(test_differing_deterministic_repeats_are_marked),
        cmocka_unit_test(test_repeats_that_agree_are_not_called_nondeterministic),
        cmocka_unit_test(test_one_failed_repeat_makes_the_run_failed),
        cmocka_unit_test(test_order_of_rows_does_not_change_the_pages),
        cmocka_unit_test(test_row_that_was_merged_twice_counts_once),
        cmocka_unit_test(test_parameters_seed_and_scene_make_separate_cases),
        cmocka_unit_test(test_two_versions_of_an_engine_are_two_columns),
        cmocka_unit_test(test_bad_row_is_named_with_what_was_expected),
        cmocka_unit_test(test_result_with_required_keys_only_makes_a_page),
    };
    return cmocka_run_group_tests_name("report_cells", tests, NULL, NULL);
}
