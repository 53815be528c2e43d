/* From rows of results to points: what makes one, what has no numbers, what is broken. */
#include "check.h"
#include "result_tables.h"
#include "studies/sweep/analysis.h"
#include "sweep_analysis_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void test_point_is_the_median_of_its_repeats(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-3},
                (const double[]){7, 1, 2}, 3);
    add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-3, .dt = 1.0 / 128},
                (const double[]){4, 4, 4, 4}, 4);
    pl_sweep_analysis analysis = analysis_of(results);
    assert_int_equal(analysis.point_count, 2);
    assert_int_equal(analysis.results->row_count, 7);
    assert_int_equal(analysis.scene_count, 1); /* dt is none of the scene's */
    const pl_sweep_point *point = &analysis.points[0];
    assert_close(point->dt, 1.0 / 64, 0, 0); /* by falling dt */
    assert_close(point->cost, 2, 0, 0);
    assert_close(point->cost_mad, 1, 0, 0);
    assert_int_equal(point->sample_count, 3);
    assert_close(point->samples[2].cost, 7, 0, 0);
    assert_true(isnan(point->instructions));
    assert_close(analysis.points[1].cost, 4, 0, 0);
    assert_close(analysis.points[1].cost_mad, 0, 0, 0);
    finish_sweep(&analysis, results);
}

static void test_rows_are_grouped_by_case_and_configuration(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "tower", "ode:q", 1, 1e-3, .n = 10});
    add_sweep_run(results, (sweep_run){.scenario = "tower", "ode:q", 1, 1e-3, .n = 5});
    add_sweep_run(results, (sweep_run){.scenario = "tower", "ode:q", 1, 1e-3, .n = 5, .dt = 0.5});
    add_sweep_run(results,
                  (sweep_run){.scenario = "tower", "ode:q", 1, 1e-3, .n = 5, .iterations = 3});
    add_sweep_run(results, (sweep_run){.scenario = "tower", "ode:r", 1, 1e-3, .n = 5});
    add_sweep_run(results, (sweep_run){.scenario = "tower", "plumb:p", 1, 1e-3, .n = 5});
    pl_sweep_analysis analysis = analysis_of(results);
    assert_int_equal(analysis.point_count, 6);
    assert_int_equal(analysis.scene_count, 2);
    assert_string_equal(analysis.scenes[0].of->name, "tower n=5");
    assert_string_equal(analysis.scenes[0].unit, "1");
    assert_int_equal(analysis.scenes[0].count, 5);
    assert_int_equal(analysis.scenes[1].first, 5);
    static const char *const names[] = {"plumb", "ode", "plumb:p", "ode:q", "ode:r"};
    assert_int_equal(analysis.engine_count, 5);
    for (int i = 0; i < 5; ++i)
        assert_string_equal(analysis.engines[i].name, names[i]);
    assert_int_equal(analysis.pair_count, 3); /* plumb-ode, p-q, p-r */
    assert_int_equal(analysis.scenes[0].curves[1].ok, 4);
    assert_int_equal(analysis.scenes[0].curves[3].ok, 3);
    json_t *orders = pl_orders_find(&analysis);
    assert_int_equal(json_array_size(orders), 1); /* of one series there are two time steps */
    json_decref(orders);
    finish_sweep(&analysis, results);
}

static void test_failed_point_is_never_a_number(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 1, 1e-9, .outcome = "timeout"});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 1, 1e-3});
    add_sweep_run(results,
                  (sweep_run){.scenario = "a", "ode:q", 1, 1e-9, .dt = 0.125, .repeat = 0});
    add_sweep_run(
        results,
        (sweep_run){
            .scenario = "a", "ode:q", 1, 1e-9, .dt = 0.125, .repeat = 1, .outcome = "collapsed"});
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_sweep_scene *scene = &analysis.scenes[0];
    int ours = engine_named(&analysis, "plumb"), ode = engine_named(&analysis, "ode");
    assert_int_equal(scene->curves[ours].failed, 1);
    assert_int_equal(scene->curves[ours].front_count, 0);
    assert_int_equal(scene->curves[ode].failed, 1);
    assert_int_equal(scene->curves[ode].ok, 1);
    assert_int_equal(scene->curves[ode].cheapest[2], 2);
    assert_int_equal(scene->curves[ode].cheapest[3], -1);
    assert_string_equal(pl_outcome_name(analysis.points[1].row->outcome), "collapsed");
    assert_true(isnan(analysis.points[1].cost));
    assert_true(isnan(analysis.points[0].error));
    json_t *losses = losses_of(&analysis);
    assert_int_equal(json_array_size(losses), 3);
    assert_string_equal(pl_study_text(json_array_get(losses, 0), "reached"), "second only");
    json_decref(losses);
    finish_sweep(&analysis, results);
}

static void test_all_failed_is_no_comparison(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 1, 1, .outcome = "crashed"});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 1, 1, .outcome = "nonfinite"});
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_sweep_pair *pair = &analysis.pairs[pair_named(&analysis, "plumb", "ode")];
    char *text = document_of(&analysis);
    assert_contains(text, "Nothing was compared");
    free(text);
    assert_int_equal(pair->scenes, 1);
    assert_int_equal(pair->reached[PL_ATTAINED_BY_BOTH][0] +
                         pair->reached[PL_ATTAINED_BY_FIRST_ONLY][0] +
                         pair->reached[PL_ATTAINED_BY_SECOND_ONLY][0],
                     0);
    assert_true(isnan(pair->mean[0].value));
    finish_sweep(&analysis, results);
}

static void test_what_is_not_supported_has_not_failed(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 1, 1e-3});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 2, 1e-3});
    add_sweep_run(results,
                  (sweep_run){.scenario = "a", "ode:q", .iterations = 9, .outcome = "unsupported"});
    add_sweep_run(results, (sweep_run){.scenario = "a", "bullet:s", .outcome = "unsupported"});
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_sweep_curve *ode = &analysis.scenes[0].curves[engine_named(&analysis, "ode")];
    assert_int_equal(ode->ok, 1);
    assert_int_equal(ode->failed + ode->unmeasured, 0);
    assert_int_equal(analysis.pairs[pair_named(&analysis, "plumb", "ode")].scenes, 1);
    assert_int_equal(analysis.pairs[pair_named(&analysis, "plumb", "bullet")].scenes, 0);
    finish_sweep(&analysis, results);
}

static void test_missing_number_makes_a_point_unmeasured(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 1, (double)NAN});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", (double)NAN, 1e-3});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:r", 0, 1e-3});
    json_t *row = add_sweep_run(results, (sweep_run){.scenario = "b", "ode:q", 1, 1e-3});
    json_object_set_new(row, "primary_error", json_string(""));
    pl_sweep_analysis analysis = analysis_of(results);
    static const char *const reasons[] = {"the primary error has no value", "no time was measured",
                                          "no time was measured",
                                          "the scenario has no primary error"};
    for (int i = 0; i < 4; ++i) {
        assert_int_equal(analysis.points[i].state, PL_SWEEP_UNMEASURED);
        assert_string_equal(analysis.points[i].reason, reasons[i]);
    }
    assert_int_equal(analysis.unjudged, 1);
    char *text = document_of(&analysis);
    assert_contains(text, "Nothing was compared");
    free(text);
    finish_sweep(&analysis, results);
}

static void test_error_below_the_floor_counts_as_the_floor(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 1, 0});
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 2, 1e-16, .iterations = 1});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 5, -1e-12});
    pl_sweep_analysis analysis = analysis_of(results);
    assert_close(analysis.points[0].error, 1e-9, 0, 0);
    assert_close(analysis.points[0].raw_error, 0, 0, 0);
    assert_close(analysis.points[1].raw_error, 1e-16, 0, 0);
    assert_int_equal(analysis.scenes[0].curves[0].front_count, 1); /* the cheaper of the two */
    const pl_pairwise_comparison *comparison = comparison_with(&analysis, "ode");
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k)
        assert_close(comparison->ratios[PL_SPEED + k].value, 5, 0, 0);
    assert_close(comparison->ratios[PL_EXACTNESS + PL_SWEEP_TIMES - 1].value, 1, 0, 0);
    finish_sweep(&analysis, results);
}

static void test_order_is_found_over_dt_only(void **state)
{
    (void)state;
    json_t *results = json_array();
    for (int i = 0; i < 4; ++i) {
        double dt = ldexp(1, -4 - i);
        add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 1 / dt, dt * dt, .dt = dt});
        add_sweep_run(
            results,
            (sweep_run){.scenario = "a", "plumb:p", 1 / dt, 0.1 * dt, .dt = dt, .iterations = 7});
    }
    pl_sweep_analysis analysis = analysis_of(results);
    json_t *orders = pl_orders_find(&analysis);
    assert_int_equal(json_array_size(orders), 2);
    for (size_t i = 0; i < 2; ++i) {
        const json_t *order = json_array_get(orders, i);
        const json_int_t first = json_integer_value(json_object_get(order, "point"));
        const bool second = strstr(analysis.points[first].row->label, "iterations=0") != NULL;
        assert_close(json_number_value(json_object_get(order, "order")), second ? 2 : 1, 1e-12, 0);
        assert_int_equal(json_integer_value(json_object_get(order, "used")), 4);
        assert_close(json_number_value(json_object_get(order, "dt_low")), ldexp(1, -7), 0, 0);
        assert_close(json_number_value(json_object_get(order, "dt_high")), ldexp(1, -4), 0, 0);
    }
    json_decref(orders);
    finish_sweep(&analysis, results);
}

static void test_instructions_are_for_a_simulated_second(void **state)
{
    (void)state;
    json_t *results = crossing_sweep();
    for (size_t i = 0; i < 3; ++i)
        json_object_set_new(json_object_get(json_array_get(results, i), "metrics"),
                            "instructions_per_step",
                            json_pack("{s:f}", "value", 1e6 * (double)(i + 1)));
    pl_sweep_analysis analysis = analysis_of(results);
    assert_close(analysis.points[0].instructions, 64e6, 0, 0);
    assert_close(comparison_with(&analysis, "ode")->instructions[0], 2, 0, 0);
    assert_close(comparison_with(&analysis, "ode")->instructions[3], 3, 0, 0);
    finish_sweep(&analysis, results);
}

static char *json_text_of(const json_t *results)
{
    pl_sweep_analysis analysis = analysis_of(results);
    json_t *json = pl_sweep_to_json(&analysis);
    assert_non_null(json);
    char *text = json_dumps(json, JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
    json_decref(json);
    finish_sweep(&analysis, NULL);
    return text;
}

static void test_order_and_doubles_of_rows_do_not_matter(void **state)
{
    (void)state;
    check_random random = {5};
    json_t *results = json_array(), *reversed = json_array();
    static const char *const engines[] = {"plumb:p", "plumb:q", "ode:q", "bullet:s"};
    for (int i = 0; i < 96; ++i) {
        double cost = check_uniform(&random, 0.5, 2);
        double error = pow(10, check_uniform(&random, -6, -1));
        add_sweep_run(results, (sweep_run){.scenario = i % 2 == 0 ? "a" : "tower",
                                           .engine = engines[i / 2 % 4],
                                           .cost = cost,
                                           .error = error,
                                           .dt = ldexp(1, -4 - i / 8 % 3),
                                           .repeat = i / 24,
                                           .outcome = i % 12 != 7       ? NULL
                                                      : i / 24 % 2 == 0 ? "timeout"
                                                                        : "crashed"});
    }
    for (size_t i = 0; i < 96; ++i) {
        json_array_append(reversed, json_array_get(results, (i * 41 + 17) % 96));
        if (i % 5 == 0)
            json_array_append(reversed, json_array_get(results, i));
    }
    char *first = json_text_of(results), *again = json_text_of(results);
    char *other = json_text_of(reversed);
    assert_string_equal(first, again);
    assert_string_equal(first, other);
    assert_contains(first, "\"runs\": 96");
    free(first);
    free(again);
    free(other);
    json_decref(results);
    json_decref(reversed);
}

static void test_nothing_is_an_empty_analysis(void **state)
{
    (void)state;
    json_t *results = json_array();
    pl_sweep_analysis analysis = analysis_of(results);
    assert_int_equal(analysis.point_count + analysis.scene_count, 0);
    finish_sweep(&analysis, results);
}

static void test_several_processors_and_builds_are_noted(void **state)
{
    (void)state;
    json_t *results = crossing_sweep(), *later = json_deep_copy(results);
    pl_sweep_analysis analysis = analysis_of(results);
    assert_false(analysis.results->several_hosts || analysis.several_builds);
    finish_sweep(&analysis, NULL);
    json_object_set_new(json_object_get(json_array_get(results, 1), "host"), "cpu",
                        json_string("two"));
    json_object_set_new(json_array_get(later, 2), "engine_version", json_string("2.0"));
    pl_sweep_analyse(table_of_two(results, later, false, "plumb"), &analysis);
    assert_true(analysis.results->several_hosts && analysis.several_builds);
    finish_sweep(&analysis, results);
    json_decref(later);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_point_is_the_median_of_its_repeats),
        cmocka_unit_test(test_rows_are_grouped_by_case_and_configuration),
        cmocka_unit_test(test_failed_point_is_never_a_number),
        cmocka_unit_test(test_all_failed_is_no_comparison),
        cmocka_unit_test(test_what_is_not_supported_has_not_failed),
        cmocka_unit_test(test_missing_number_makes_a_point_unmeasured),
        cmocka_unit_test(test_error_below_the_floor_counts_as_the_floor),
        cmocka_unit_test(test_order_is_found_over_dt_only),
        cmocka_unit_test(test_instructions_are_for_a_simulated_second),
        cmocka_unit_test(test_order_and_doubles_of_rows_do_not_matter),
        cmocka_unit_test(test_nothing_is_an_empty_analysis),
        cmocka_unit_test(test_several_processors_and_builds_are_noted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
