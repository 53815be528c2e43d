/* The table of results: numbers as text, repeats, cases, engines, and what newer results replace. */
#include "base/number_format.h"

#include "check.h"
#include "report_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    assert_int_equal(made.table->case_count, 1);
    assert_int_equal(made.table->configuration_count, 1);
    const pl_metric_summary time =
        pl_result_cell_metric(made.table->cells, PL_METRIC_TIME_PER_STEP);
    assert_int_equal(time.count, 5);
    assert_close(time.value, 3e-3, 0, 1e-15);
    assert_close(time.min, 1e-3, 0, 1e-15);
    assert_close(time.max, 90e-3, 0, 1e-15);
    assert_close(time.mad, 2e-3, 0, 1e-12); /* of 0, 1, 2, 2, 87 ms */
    assert_false(time.disagrees);
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
    assert_close(pl_result_cell_metric(made.table->cells, PL_METRIC_TIME_PER_STEP).value, 3e-3, 0,
                 1e-15);
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
    assert_true(made.table->disagrees);
    assert_int_equal(count_of(made.data, "\"disagrees\":true"), 2); /* the report, and the cell */
    assert_contains(made.markdown, "Not deterministic: ");
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
    assert_false(made.table->disagrees);
    assert_absent(made.data, "\"disagrees\":true");
    assert_absent(made.markdown, "ot deterministic");
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
    const pl_result_cell *cell = made.table->cells;
    assert_false(pl_result_cell_is_ok(cell));
    assert_int_equal(cell->ok_count, 2);
    assert_true(cell->disagrees);
    assert_contains(made.data, "\"repeats\":3,\"ok_repeats\":2");
    assert_contains(made.markdown, "crashed in 1 of 3");
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
    assert_string_equal(a.markdown, b.markdown);
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
    assert_int_equal(made.table->row_count, 1);
    free_report(&made);
}

static void test_parameters_seed_and_member_make_separate_cases(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_run(results, "s", "ode:quick", "ok");
    json_object_set_new(json_object_get(add_run(results, "s", "ode:quick", "ok"), "params"), "n",
                        json_integer(5));
    json_object_set_new(add_run(results, "s", "ode:quick", "ok"), "seed", json_integer(7));
    json_object_set_new(add_run(results, "s", "ode:quick", "ok"), "member", json_integer(0));
    made_report made = make_report(results);
    assert_int_equal(made.table->case_count, 4);
    for (int i = 0; i < 4; ++i) {
        assert_int_equal(made.table->cases[i].count, 1);
        assert_int_equal(made.table->cases[i].cells->count, 1);
    }
    assert_contains(made.data, "s seed=7");
    assert_contains(made.data, "s member=0");
    assert_contains(made.data, "s n=5");
    free_report(&made);
}

/* A scenario that the catalogue knows goes by what is off its defaults, in one form everywhere. */
static void test_name_has_what_is_off_its_default(void **state)
{
    (void)state;
    const pl_scenario *tower = pl_scenario_find("tower", NULL);
    json_t *results = json_array(), *params = json_object();
    for (int i = 0; i < tower->param_count; ++i) {
        json_object_set_new(params, tower->params[i].name, json_real(tower->params[i].value));
    }
    json_object_set_new(params, "n", json_integer(37));
    json_object_set_new(params, "dt", json_real(0.01));
    json_object_set_new(add_run(results, "tower", "ode:quick", "ok"), "params", params);
    pl_result_table *table = table_of(results);
    assert_string_equal(table->cases[0].name, "tower n=37 dt=0.01 s");
    assert_string_equal(table->scenes[0].name, "tower n=37");
    free_table(table);
    json_decref(results);
}

/* A parameter that a scenario got later is at its default in results from before. */
static void test_missing_parameter_is_at_its_default(void **state)
{
    (void)state;
    const pl_scenario *tower = pl_scenario_find("tower", NULL);
    json_t *results = json_array();
    add_run(results, "tower", "ode:quick", "ok");
    json_t *row = add_run(results, "tower", "bullet:si", "ok");
    json_object_set_new(json_object_get(row, "params"), "n",
                        json_real(tower->params[pl_scenario_param(tower, "n")].value));
    pl_result_table *table = table_of(results);
    assert_int_equal(table->case_count, 1);
    assert_int_equal(table->cases[0].count, 2);
    free_table(table);
    json_decref(results);
}

static void test_time_steps_are_cases_of_one_scene(void **state)
{
    (void)state;
    static const double steps[] = {0.01, 0.04, 0.02};
    json_t *results = json_array();
    for (int i = 0; i < 6; ++i) {
        json_t *row = add_run(results, "s", "ode:quick", "ok");
        char hash[16];
        snprintf(hash, sizeof hash, "h%d", i);
        json_object_set_new(row, "scene_hash", json_string(hash));
        json_object_set_new(json_object_get(row, "settings"), "dt", json_real(steps[i % 3]));
        if (i >= 3) {
            json_object_set_new(row, "change", json_string("n one larger"));
        }
    }
    pl_result_table *table = table_of(results);
    assert_int_equal(table->scene_count, 1);
    assert_int_equal(table->case_count, 6);
    assert_int_equal(table->configuration_count, 1);
    for (int i = 0; i < 6; ++i) {
        assert_close(table->cases[i].row->dt, 0.04 / (1 << i / 2), 0, 1e-15);
        assert_int_equal(table->cases[i].row->change[0] != '\0', i % 2);
    }
    free_table(table);
    json_decref(results);
}

/* ---- The worst repeat ---- */

static void test_failed_repeat_is_worse_than_one_not_judged(void **state)
{
    (void)state;
    /* From good to bad. */
    static const struct {
        const char *outcome, *verdict;
    } kinds[] = {{"ok", "accurate"},
                 {"ok", NULL},
                 {"ok", "inaccurate"},
                 {"ok", "failed"},
                 {"crashed", "failed"}};
    for (int a = 0; a < 5; ++a) {
        for (int b = 0; b < 5; ++b) {
            json_t *results = json_array();
            for (int i = 0; i < 2; ++i) {
                const int kind = i == 0 ? a : b;
                json_t *row = add_run(results, "s", "ode:quick", kinds[kind].outcome);
                set_verdict(row, kinds[kind].verdict, "");
                json_object_set_new(row, "repeat", json_integer(i));
            }
            pl_result_table *table = table_of(results);
            assert_int_equal(table->cells->worst->repeat, b > a ? 1 : 0);
            free_table(table);
            json_decref(results);
        }
    }
}

/* ---- What newer results replace ---- */

/* A run with these texts, that started on this day. */
static json_t *add_dated(json_t *results, const char *key, const char *value, int day)
{
    json_t *row = add_run(results, "s", "ode:quick", "ok");
    char started[32];
    snprintf(started, sizeof started, "2026-02-%02dT00:00:00Z", day);
    json_object_set_new(row, key, json_string(value));
    json_object_set_new(row, "started", json_string(started));
    json_object_set_new(row, "repeat", json_integer(day));
    return row;
}

/* Expects the rows of these days alone, in either order of the results. */
static void expect_days(json_t *results, const char *days, int old_scenes, int old_builds)
{
    for (int pass = 0; pass < 2; ++pass) {
        json_t *turned = json_array();
        for (size_t i = json_array_size(results); i-- > 0;) {
            json_array_append(turned, json_array_get(results, i));
        }
        pl_result_table *table = table_of(pass == 0 ? results : turned);
        char found[32] = "";
        for (int i = 0; i < table->row_count; ++i) {
            const size_t used = strlen(found);
            snprintf(found + used, sizeof found - used, "%d", (int)table->rows[i].repeat);
        }
        assert_string_equal(found, days);
        assert_int_equal(table->old_scenes, old_scenes);
        assert_int_equal(table->old_builds, old_builds);
        free_table(table);
        json_decref(turned);
    }
    json_decref(results);
}

static void test_newest_scene_of_equal_parameters_counts(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_dated(results, "scene_hash", "b", 1);
    add_dated(results, "scene_hash", "a", 2);
    add_dated(results, "scene_hash", "b", 3);
    add_dated(results, "scene_hash", "a", 4);
    expect_days(results, "24", 2, 0);
}

/* Of parameters that were not run on the new edition too. */
static void test_newest_edition_of_a_file_counts(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add_dated(results, "scene_edition", "old", 1);
    json_object_set_new(json_object_get(row, "params"), "n", json_integer(5));
    add_dated(results, "scene_edition", "old", 2);
    json_object_set_new(add_dated(results, "scene_edition", "new", 3), "scene_hash",
                        json_string("beef"));
    /* Of another file. */
    json_object_set_new(add_dated(results, "scene_edition", "old", 4), "scenario",
                        json_string("t"));
    expect_days(results, "34", 2, 0);
}

/* Results from before editions were recorded count with those of the same scene. */
static void test_result_without_edition_has_that_of_its_scene(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_object_set_new(add_dated(results, "scene_edition", "new", 3), "scene_hash",
                        json_string("beef"));
    json_object_set_new(add_dated(results, "scene_hash", "beef", 1), "label",
                        json_string("bullet:si"));
    json_object_set_new(add_dated(results, "scene_hash", "cafe", 2), "label",
                        json_string("bullet:si"));
    expect_days(results, "13", 1, 0);
}

/* With any options; other labels are other engines. */
static void test_newest_build_of_an_engine_counts(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_object_set_new(add_dated(results, "engine_binary", "b", 1), "label",
                        json_string("ode:quick,iterations=9"));
    add_dated(results, "engine_binary", "b", 2);
    add_dated(results, "engine_binary", "a", 3);
    json_object_set_new(add_dated(results, "engine_binary", "b", 4), "label",
                        json_string("ode:quick2"));
    expect_days(results, "34", 0, 2);
}

static void test_snapshots_are_compared_with_each_other(void **state)
{
    (void)state;
    for (int one = 0; one < 2; ++one) {
        json_t *files[2] = {json_array(), json_array()};
        json_object_set_new(add_dated(files[0], "engine_binary", "aaaa", 1), "scene_hash",
                            json_string("beef"));
        add_dated(files[1], "engine_binary", "bbbb", 2);
        pl_result_table *table = table_of_two(files[0], files[1], one == 1, NULL);
        assert_int_equal(table->configuration_count, one == 1 ? 1 : 2);
        assert_int_equal(table->case_count, one == 1 ? 1 : 2);
        if (one == 0) {
            assert_string_equal(table->configurations[0].name, "ode:quick build aaaa");
            assert_string_equal(table->configurations[1].name, "ode:quick build bbbb");
            assert_string_equal(table->cases[0].name, "s #beef");
            assert_string_equal(table->cases[1].name, "s #cafe");
        }
        free_table(table);
        json_decref(files[0]);
        json_decref(files[1]);
    }
}

static void test_what_was_left_out_is_said(void **state)
{
    (void)state;
    static const char *const texts[] = {"",
                                        "1 result is left out: the scene was edited since\n"
                                        "2 results are left out: the engine was rebuilt since\n"};
    for (int i = 0; i < 2; ++i) {
        const pl_result_table table = {.old_scenes = i, .old_builds = 2 * i};
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        pl_result_table_print_left_out(&table, out);
        fclose(out);
        assert_string_equal(text, texts[i]);
        free(text);
    }
}

/* ---- Configurations ---- */

static void test_home_is_a_label_a_profile_or_an_engine(void **state)
{
    (void)state;
    static const struct {
        const char *home, *names;
    } rows[] = {{NULL, "bullet:si mine ode:p ode:q"},
                {"ode", "ode:p ode:q bullet:si mine"},
                {"ode:q", "ode:q bullet:si mine ode:p"},
                {"mine", "mine bullet:si ode:p ode:q"},
                {"small", "mine bullet:si ode:p ode:q"}};
    json_t *results = json_array(), *none = json_array();
    static const char *const labels[] = {"ode:q", "bullet:si", "ode:p", "small:p"};
    for (int i = 0; i < 4; ++i) {
        json_t *row = add_run(results, "s", labels[i], "ok");
        json_object_set_new(row, "profile", json_string(strchr(labels[i], ':') + 1));
        if (i == 3) {
            json_object_set_new(row, "label", json_string("mine"));
        }
    }
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        pl_result_table *table = table_of_two(results, none, true, rows[i].home);
        char names[128] = "";
        int home = 0;
        for (int k = 0; k < table->configuration_count; ++k) {
            const size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s%.40s", k == 0 ? "" : " ",
                     table->configurations[k].name);
            home += table->configurations[k].is_home;
        }
        assert_string_equal(names, rows[i].names);
        assert_int_equal(home, i == 0 ? 0 : i == 1 ? 2 : 1);
        free_table(table);
    }
    json_decref(results);
    json_decref(none);
}

static void test_home_that_was_not_run_is_refused(void **state)
{
    (void)state;
    json_t *results = two_runs("creep", 1, 2);
    const pl_result_file file = {.path = "made.jsonl", .results = results};
    const pl_result_table_def def = {.files = &file, .file_count = 1, .home = "ode:quik"};
    pl_result_table table;
    pl_error error = {PL_OK, ""};
    assert_int_equal(pl_result_table_build(&def, &table, &error), PL_BAD_INPUT);
    assert_contains(error.message,
                    "--home ode:quik: the results have no run of that engine; did you "
                    "mean ode:quick");
    pl_result_table_free(&table);
    json_decref(results);
}

/* ---- Bad input ---- */

static void test_bad_row_is_named_with_its_line(void **state)
{
    (void)state;
    static const char *const keys[] = {"schema",  "scenario", "engine", "label",
                                       "outcome", "settings", "metrics"};
    for (size_t i = 0; i < 2 * sizeof keys / sizeof keys[0]; ++i) {
        const char *key = keys[i / 2];
        json_t *results = two_runs("creep", 1, 2);
        const int lines[] = {4, 9};
        const pl_result_file file = {.path = "some.jsonl", .results = results, .lines = lines};
        const pl_result_table_def def = {.files = &file, .file_count = 1};
        pl_result_table table;
        pl_error error = {PL_OK, ""};
        char message[64];
        if (i % 2 == 0) {
            json_object_del(json_array_get(results, 1), key);
        } else {
            json_object_set_new(json_array_get(results, 1), key, json_integer(3));
        }
        snprintf(message, sizeof message, "some.jsonl:9:1: %s%s: expected ", key,
                 strcmp(key, "settings") == 0 ? ".dt" : "");
        assert_int_equal(pl_result_table_build(&def, &table, &error), PL_BAD_INPUT);
        assert_contains(error.message, message);
        pl_result_table_free(&table);
        json_decref(results);
    }
}

static void test_result_with_required_keys_only_makes_a_page(void **state)
{
    (void)state;
    made_report made = make_report(json_loads(
        "[{\"schema\":\"plumb.result/1\",\"scenario\":\"s\",\"engine\":\"e\",\"label\":\"l\","
        "\"outcome\":\"ok\",\"settings\":{\"dt\":0.01},"
        "\"metrics\":{\"drift\":3,\"creep\":{\"value\":[]}}}]",
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
        cmocka_unit_test(test_parameters_seed_and_member_make_separate_cases),
        cmocka_unit_test(test_name_has_what_is_off_its_default),
        cmocka_unit_test(test_missing_parameter_is_at_its_default),
        cmocka_unit_test(test_time_steps_are_cases_of_one_scene),
        cmocka_unit_test(test_failed_repeat_is_worse_than_one_not_judged),
        cmocka_unit_test(test_newest_scene_of_equal_parameters_counts),
        cmocka_unit_test(test_newest_edition_of_a_file_counts),
        cmocka_unit_test(test_result_without_edition_has_that_of_its_scene),
        cmocka_unit_test(test_newest_build_of_an_engine_counts),
        cmocka_unit_test(test_snapshots_are_compared_with_each_other),
        cmocka_unit_test(test_what_was_left_out_is_said),
        cmocka_unit_test(test_home_is_a_label_a_profile_or_an_engine),
        cmocka_unit_test(test_home_that_was_not_run_is_refused),
        cmocka_unit_test(test_bad_row_is_named_with_its_line),
        cmocka_unit_test(test_result_with_required_keys_only_makes_a_page),
    };
    return cmocka_run_group_tests_name("result table", tests, NULL, NULL);
}
