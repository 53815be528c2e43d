/* What a sweep counts: points that hold on changes of the scene, factors as shipped and at each
 * engine's best, and how many settings were tried. Answers are known by hand. */
#include "check.h"
#include "sweep_analysis_rows.h"

#include <math.h>
#include <stdlib.h>

enum { AT_1E_2 = 1, AT_1E_3 = 2, AT_1E_4 = 3 };

/* One point of ours at 1e-4 and a cost of 2, with a change of that error and outcome. */
static pl_sweep_analysis changed(json_t **results, double error, const char *outcome)
{
    *results = json_array();
    add_sweep_run(*results, (sweep_run){.scenario = "a", "plumb:p", 2, 1e-4});
    add_sweep_run(
        *results,
        (sweep_run){
            .scenario = "a", "plumb:p", 50, error, .outcome = outcome, .change = "n one larger"});
    return analysis_of(*results);
}

static void test_error_is_the_largest_over_changes(void **state)
{
    (void)state;
    json_t *results;
    pl_sweep_analysis analysis = changed(&results, 3e-2, NULL);
    const pl_sweep_point *point = &analysis.points[0];
    assert_int_equal(analysis.scene_count, 1);
    assert_int_equal(analysis.point_count, 1);
    assert_int_equal(point->state, PL_SWEEP_OK);
    assert_true(point->error == 3e-2 && point->raw_error == 3e-2);
    assert_string_equal(point->change, "n one larger");
    assert_int_equal(point->repeats, 1);
    assert_int_equal(point->changes, 1);
    assert_int_equal(analysis.scenes[0].curves[0].cheapest[AT_1E_2], -1);
    finish_sweep(&analysis, results);
}

static void test_a_change_that_holds_leaves_the_error(void **state)
{
    (void)state;
    json_t *results;
    pl_sweep_analysis analysis = changed(&results, 1e-5, NULL);
    assert_true(analysis.points[0].error == 1e-4);
    assert_string_equal(analysis.points[0].change, "");
    assert_int_equal(analysis.scenes[0].curves[0].cheapest[AT_1E_4], 0);
    finish_sweep(&analysis, results);
}

static void test_a_change_that_fails_fails_the_point(void **state)
{
    (void)state;
    static const char *const outcomes[] = {"collapsed", "timeout", "unsupported"};
    for (int i = 0; i < 3; ++i) {
        json_t *results;
        pl_sweep_analysis analysis = changed(&results, 1e-5, outcomes[i]);
        assert_int_equal(analysis.points[0].state, PL_SWEEP_FAILED);
        assert_string_equal(pl_outcome_name(analysis.points[0].row->outcome), outcomes[i]);
        assert_string_equal(analysis.points[0].change, "n one larger");
        assert_int_equal(analysis.scenes[0].curves[0].failed, 1);
        finish_sweep(&analysis, results);
    }
}

static void test_a_change_without_an_error_leaves_it_unmeasured(void **state)
{
    (void)state;
    json_t *results;
    pl_sweep_analysis analysis = changed(&results, (double)NAN, NULL);
    assert_int_equal(analysis.points[0].state, PL_SWEEP_UNMEASURED);
    finish_sweep(&analysis, results);
}

static void test_cost_and_noise_ignore_changes(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-4},
                (const double[]){1, 2, 4}, 3);
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 50, 1e-4, .change = "c"});
    pl_sweep_analysis analysis = analysis_of(results);
    assert_int_equal(analysis.points[0].sample_count, 3);
    assert_true(analysis.points[0].cost == 2);
    assert_close(analysis.scenes[0].noise, log(2), 0, 1e-12);
    finish_sweep(&analysis, results);
}

/* Ours: 4 s/s as shipped, 2 with an option. ode: 12 as shipped, 3 with an option, both to 1e-4. */
static json_t *tuned_sweep(void)
{
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 4, 1e-4, .shipped = true});
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 2, 1e-4, .iterations = 5});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 12, 1e-4, .shipped = true});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:d", 3, 1e-4, .iterations = 5});
    return results;
}

static void test_factor_as_shipped_and_at_the_best(void **state)
{
    (void)state;
    json_t *results = tuned_sweep();
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_sweep_pair *pair = &analysis.pairs[pair_named(&analysis, "plumb", "ode")];
    assert_int_equal(analysis.engines[pair->first].kind, PL_SWEEP_WHOLE);
    assert_true(pair->shipped >= 0);
    const pl_pairwise_comparison *best = comparison_with(&analysis, "ode");
    const pl_pairwise_comparison *shipped = &analysis.scenes[0].comparisons[pair->shipped];
    assert_close(best->ratios[PL_SPEED + AT_1E_3].value, 1.5, 0, 1e-12);
    assert_close(shipped->ratios[PL_SPEED + AT_1E_3].value, 3, 0, 1e-12);
    assert_close(pair->mean[AT_1E_3].value, 1.5, 0, 1e-12);
    assert_close(analysis.pairs[pair->shipped].mean[AT_1E_3].value, 3, 0, 1e-12);
    json_t *json = pl_sweep_to_json(&analysis);
    const json_t *duel = json_array_get(
        json_object_get(json_array_get(json_object_get(json, "scenes"), 0), "pairs"), 0);
    const json_t *level = json_array_get(json_object_get(duel, "levels"), AT_1E_3);
    const json_t *as_shipped = json_object_get(level, "as_shipped");
    assert_close(json_number_value(json_object_get(json_object_get(level, "speed"), "value")), 1.5,
                 0, 1e-12);
    assert_close(json_number_value(json_object_get(json_object_get(as_shipped, "speed"), "value")),
                 3, 0, 1e-12);
    assert_string_equal(
        analysis.points[json_integer_value(json_object_get(level, "second_point"))].row->label,
        "ode:d,iterations=5");
    json_decref(json);
    finish_sweep(&analysis, results);
}

static void test_the_table_names_the_best_settings(void **state)
{
    (void)state;
    json_t *results = tuned_sweep();
    pl_sweep_analysis analysis = analysis_of(results);
    char *text = document_of(&analysis);
    assert_contains(text, "plumb:p,iterations=5  1/64 s  ode:d,iterations=5  1/64 s");
    free(text);
    finish_sweep(&analysis, results);
}

static void test_without_shipped_runs_there_is_no_such_factor(void **state)
{
    (void)state;
    json_t *results = crossing_sweep();
    pl_sweep_analysis analysis = analysis_of(results);
    assert_int_equal(analysis.pairs[pair_named(&analysis, "plumb", "ode")].shipped, -1);
    finish_sweep(&analysis, results);
}

static void test_settings_are_counted_by_scene(void **state)
{
    (void)state;
    json_t *results = tuned_sweep();
    /* Repeats and changes are no further settings; what is unsupported was not tried. */
    add_sweep_run(results,
                  (sweep_run){.scenario = "a", "ode:d", 3, 1e-4, .iterations = 5, .repeat = 1});
    add_sweep_run(results,
                  (sweep_run){.scenario = "a", "ode:d", 3, 1e-4, .iterations = 5, .change = "c"});
    add_sweep_run(
        results,
        (sweep_run){.scenario = "a", "ode:d", 3, 1e-4, .iterations = 6, .outcome = "unsupported"});
    add_sweep_run(
        results,
        (sweep_run){
            .scenario = "a", "ode:d", 3, 1e-4, .iterations = 5, .dt = 0.5, .outcome = "collapsed"});
    add_sweep_run(results, (sweep_run){.scenario = "b", "ode:d", 3, 1});
    add_sweep_run(results, (sweep_run){.scenario = "b", "plumb:p", 3, 1e-4});
    pl_sweep_analysis analysis = analysis_of(results);
    const int ode = engine_named(&analysis, "ode");
    assert_int_equal(analysis.scenes[0].curves[ode].tried, 3);
    assert_int_equal(analysis.scenes[1].curves[ode].tried, 1);
    char *text = document_of(&analysis);
    assert_contains(text, "not with 1 setting");
    free(text);
    finish_sweep(&analysis, results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_error_is_the_largest_over_changes),
        cmocka_unit_test(test_a_change_that_holds_leaves_the_error),
        cmocka_unit_test(test_a_change_that_fails_fails_the_point),
        cmocka_unit_test(test_a_change_without_an_error_leaves_it_unmeasured),
        cmocka_unit_test(test_cost_and_noise_ignore_changes),
        cmocka_unit_test(test_factor_as_shipped_and_at_the_best),
        cmocka_unit_test(test_the_table_names_the_best_settings),
        cmocka_unit_test(test_without_shipped_runs_there_is_no_such_factor),
        cmocka_unit_test(test_settings_are_counted_by_scene),
    };
    return cmocka_run_group_tests_name("sweep_analysis_fair", tests, NULL, NULL);
}
