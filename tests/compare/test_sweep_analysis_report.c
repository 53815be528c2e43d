/* What the report of a sweep says, and that it says it safely. */
#include "base/number_format.h"
#include "check.h"
#include "plumb_process.h"
#include "report/sweep_report.h"
#include "report/sweep_tables.h"
#include "report_rows.h"
#include "results/store.h"
#include "sweep_analysis_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two scenes: on a plumb loses at 1e-1 and 1e-2; on b ode's two points fail. */
static json_t *mixed(void)
{
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 2, 1e-4});
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 4, 1e-6, .iterations = 8});
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 9, 1e-5, .iterations = 9});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 1, 1e-2, .iterations = 1});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 8, 1e-4, .iterations = 9});
    add_sweep_run(results, (sweep_run){.scenario = "b", "plumb:p", 2, 1e-4});
    add_sweep_run(results, (sweep_run){.scenario = "b", "ode:q", 1, 1, .outcome = "crashed"});
    add_sweep_run(results,
                  (sweep_run){.scenario = "b", "ode:q", 1, 1, .dt = 0.5, .outcome = "timeout"});
    return results;
}

/* The data of the page as text. */
static char *data_of(const json_t *results)
{
    pl_sweep_analysis analysis = analysis_of(results);
    json_t *json = pl_sweep_report_json(&analysis);
    char *text = json_dumps(json, JSON_COMPACT);
    assert_non_null(text);
    json_decref(json);
    pl_sweep_analysis_free(&analysis);
    return text;
}

static char *print_of(const json_t *results)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    pl_sweep_analysis analysis = analysis_of(results);
    pl_sweep_report_print(out, &analysis);
    fclose(out);
    pl_sweep_analysis_free(&analysis);
    return text;
}

static void test_losses_come_before_everything_else(void **state)
{
    (void)state;
    json_t *results = mixed();
    char *data = data_of(results);
    char *text = print_of(results);
    static const char *const said =
        "ahead of that of plumb in 2 of 10 comparisons (scene, engine, error): in 0 at errors up "
        "to 1e-3, in 2 at larger ones; 0 of all are within noise.";
    assert_contains(data, said);
    assert_before(text, "in 2 of 10 comparisons", "Where plumb loses");
    assert_before(text, "Where plumb loses", "over all scenes");
    assert_contains(text, "1 of 2 scenes: not with 2 settings");
    free(data);
    free(text);
    json_decref(results);
}

static void test_losses_appear_only_with_a_home_engine(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "bullet:p", 1, 1e-4});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 2, 1e-4});
    char *data = data_of(results);
    char *text = print_of(results);
    assert_contains(data, "\"losses\":[]");
    assert_absent(text, "Where plumb loses");
    assert_contains(text, "1 pair of engines compared.");
    free(text);
    free(data);
    json_decref(results);
}

static void test_statement_when_nothing_is_lost_or_compared(void **state)
{
    (void)state;
    static const struct {
        const char *first, *second, *outcome, *said;
    } cases[] = {
        {"plumb:p", "ode:q", NULL, "No losses: in none of 4 comparisons"},
        {"plumb:p", "plumb:q", NULL, "these results hold no other engine"},
        {"bullet:p", "ode:q", NULL, "1 pair of engines compared."},
        {"plumb:p", "ode:q", "crashed", "reach any of the errors"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        json_t *results = json_array();
        add_sweep_run(
            results,
            (sweep_run){.scenario = "a", cases[i].first, 1, 1e-4, .outcome = cases[i].outcome});
        add_sweep_run(
            results,
            (sweep_run){.scenario = "a", cases[i].second, 2, 1e-4, .outcome = cases[i].outcome});
        pl_sweep_analysis analysis = analysis_of(results);
        pl_text_buffer buffer = {0};
        pl_sweep_statement(&analysis, &buffer);
        assert_contains(buffer.data, cases[i].said);
        pl_text_free(&buffer);
        pl_sweep_analysis_free(&analysis);
        json_decref(results);
    }
}

static json_t *hostile(void)
{
    json_t *results = mixed();
    json_t *row;
    size_t index;
    json_array_foreach(results, index, row)
    {
        json_object_set_new(row, "label", json_string(hostile_text));
        json_object_set_new(row, "reason", json_string(hostile_text));
        json_object_set_new(row, "scenario", json_string(hostile_text));
        json_object_set_new(row, "profile", json_string(hostile_text));
        if (index % 2 == 0) {
            json_object_set_new(row, "engine", json_string(hostile_text));
        }
    }
    return results;
}

static void test_hostile_texts_do_not_reach_the_terminal(void **state)
{
    (void)state;
    json_t *results = hostile();
    char *text = print_of(results), *data = data_of(results);
    assert_contains(data, "<script>alert(\\\"x\\\")"); /* pl_page_add makes it harmless */
    assert_absent(text, "\r");
    assert_absent(text, "\033");
    free(text);
    free(data);
    json_decref(results);
}

static void test_numbers_are_written_as_people_read_them(void **state)
{
    (void)state;
    char text[PL_SWEEP_TEXT_SIZE];
    pl_sweep_ratio_text(&(pl_sweep_ratio){2.5, 2.25, 2.75}, text);
    assert_string_equal(text, "×2.50 (2.25 to 2.75)");
    pl_sweep_ratio_text(&(pl_sweep_ratio){2.5, (double)NAN, (double)NAN}, text);
    assert_string_equal(text, "×2.50");
    pl_sweep_ratio_text(&(pl_sweep_ratio){(double)NAN, (double)NAN, (double)NAN}, text);
    assert_string_equal(text, "–");
    pl_sweep_error_text(1e-9, "m", text);
    assert_string_equal(text, "≤ 1e-9 m");
    pl_sweep_error_text(0.0125, "1", text);
    assert_string_equal(text, "0.0125");
    pl_format_step(1.0 / 240, text);
    assert_string_equal(text, "1/240 s");
    pl_format_step(0.03, text);
    assert_string_equal(text, "0.03 s");
    pl_format_number(0.0125, "s", text);
    assert_string_equal(text, "12.5 ms");
}

static void test_files_are_written(void **state)
{
    (void)state;
    char *directory = make_directory();
    char path[512];
    json_t *results = mixed();
    pl_sweep_analysis analysis = analysis_of(results);
    pl_error error = {PL_OK, ""};
    assert_int_equal(pl_sweep_report_write(directory, &analysis, &error), PL_OK);
    snprintf(path, sizeof path, "%s/sweep.json", directory);
    json_t *json = json_load_file(path, 0, NULL);
    assert_non_null(json);
    assert_string_equal(json_string_value(json_object_get(json, "schema")), "plumb.sweep/2");
    assert_int_equal(json_array_size(json_object_get(json, "points")), 8);
    assert_int_equal(json_array_size(json_object_get(json, "losses")), 2);
    assert_int_equal(json_array_size(json_object_get(json, "profiles")), 16);
    const json_t *loss = json_array_get(json_object_get(json, "losses"), 0);
    assert_close(json_number_value(json_object_get(json_object_get(loss, "speed"), "value")), 0.5,
                 0, 0);
    assert_true(json_is_null(json_object_get(json_object_get(loss, "speed"), "low")));
    json_decref(json);
    snprintf(path, sizeof path, "%s/sweep.html", directory);
    FILE *page = fopen(path, "r");
    assert_non_null(page);
    fclose(page);
    snprintf(path, sizeof path, "%s/missing", directory);
    assert_int_equal(pl_sweep_report_write(path, &analysis, &error), PL_IO);
    pl_sweep_analysis_free(&analysis);
    json_decref(results);
    remove_directory(directory);
}

static void test_no_results_make_an_empty_analysis(void **state)
{
    (void)state;
    json_t *results = json_array();
    char *data = data_of(results);
    assert_contains(data, "\"points\":[]");
    char *text = print_of(results);
    assert_absent(text, "Where plumb loses");
    free(data);
    free(text);
    json_decref(results);
}

/* A profile with a run whose conformance is not known to have passed is named; the others are not. */
static void test_unverified_engines_are_named(void **state)
{
    (void)state;
    json_t *results = mixed();
    for (size_t i = 0; i < json_array_size(results); ++i) {
        json_t *row = json_array_get(results, i);
        json_object_set_new(row, "conformance", json_pack("{s:s}", "outcome", "passed"));
    }
    char *data = data_of(results);
    assert_absent(data, "Not verified");
    free(data);
    json_object_set_new(json_array_get(results, 3), "conformance", json_null());
    data = data_of(results);
    assert_contains(data, "run plumb check-engine ode:q.");
    free(data);
    json_decref(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_losses_come_before_everything_else),
        cmocka_unit_test(test_losses_appear_only_with_a_home_engine),
        cmocka_unit_test(test_statement_when_nothing_is_lost_or_compared),
        cmocka_unit_test(test_hostile_texts_do_not_reach_the_terminal),
        cmocka_unit_test(test_numbers_are_written_as_people_read_them),
        cmocka_unit_test(test_files_are_written),
        cmocka_unit_test(test_unverified_engines_are_named),
        cmocka_unit_test(test_no_results_make_an_empty_analysis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
