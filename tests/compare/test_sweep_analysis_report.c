/* What the conclusion of a sweep and its document say, and that they say it safely. */
#include "check.h"
#include "report_rows.h"
#include "sweep_analysis_rows.h"

#include <stdlib.h>

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

static json_t *conclusion_of(const json_t *results)
{
    const pl_result_table *table = table_of(results);
    json_t *conclusion = pl_sweep_conclude(table);
    free_table(table);
    return conclusion;
}

/* plumb.sweep/2 as text. */
static char *data_of(const json_t *results)
{
    json_t *json = conclusion_of(results);
    char *text = json_dumps(json, JSON_COMPACT);
    assert_non_null(text);
    json_decref(json);
    return text;
}

static char *print_of(const json_t *results)
{
    pl_sweep_analysis analysis = analysis_of(results);
    char *text = document_of(&analysis);
    free_table(analysis.results);
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
    assert_contains(text, "×0.500");
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
        char *data = data_of(results);
        assert_contains(data, cases[i].said);
        free(data);
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

static void test_conclusion_has_all_parts(void **state)
{
    (void)state;
    json_t *results = mixed(), *json = conclusion_of(results);
    assert_string_equal(json_string_value(json_object_get(json, "schema")), "plumb.sweep/2");
    assert_int_equal(json_array_size(json_object_get(json, "points")), 8);
    assert_int_equal(json_array_size(json_object_get(json, "losses")), 2);
    assert_int_equal(json_array_size(json_object_get(json, "profiles")), 16);
    const json_t *loss = json_array_get(json_object_get(json, "losses"), 0);
    assert_close(json_number_value(json_object_get(json_object_get(loss, "speed"), "value")), 0.5,
                 0, 0);
    assert_true(json_is_null(json_object_get(json_object_get(loss, "speed"), "low")));
    assert_true(json_is_true(json_object_get(json, "varied")));
    json_decref(json);
    json_decref(results);
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
        cmocka_unit_test(test_conclusion_has_all_parts),
        cmocka_unit_test(test_unverified_engines_are_named),
        cmocka_unit_test(test_no_results_make_an_empty_analysis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
