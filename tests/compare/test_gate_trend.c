/* Trends of ratios in closed form, and the differences that tolerances and rules allow. */
#include "check.h"
#include "gate/gate.h"
#include "gate_trial.h"
#include "report_rows.h"

/* A ratio whose bounds are off by `part` of it. */
static pl_gate_ratio ratio_of(double value, double part, int repeats)
{
    return (pl_gate_ratio){
        .repeats = repeats, .value = value, .low = value * (1 - part), .high = value * (1 + part)};
}

/* Independent errors of 3 % and 4 % are 5 % of the quotient together. */
static void test_trend_is_judged_beyond_limit_and_noise(void **state)
{
    (void)state;
    static const struct {
        double now;
        pl_gate_trend trend;
    } rows[] = {{1.20, PL_GATE_SLOWER}, {1.15, PL_GATE_NOISY},  {1.11, PL_GATE_NOISY},
                {1.05, PL_GATE_STEADY}, {1.00, PL_GATE_STEADY}, {0.87, PL_GATE_STEADY},
                {0.84, PL_GATE_FASTER}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        for (double scale = 0.5; scale < 3; scale *= 4) {
            const pl_gate_ratio before = ratio_of(scale, 0.04, 5);
            const pl_gate_ratio now = ratio_of(scale * rows[i].now, 0.03, 5);
            double growth, noise;
            assert_int_equal(pl_gate_ratio_trend(&before, &now, 0.1, &growth, &noise),
                             rows[i].trend);
            assert_close(growth, rows[i].now - 1, 1e-12, 0);
            assert_close(noise, 0.05 * rows[i].now, 1e-12, 0);
        }
    }
}

static void test_trend_needs_repeats_on_both_sides(void **state)
{
    (void)state;
    for (int few = 0; few < 4; ++few) {
        const pl_gate_ratio before = ratio_of(1, 0.01, few & 1 ? 4 : 5);
        const pl_gate_ratio now = ratio_of(2, 0.01, few & 2 ? 4 : 5);
        double growth, noise;
        assert_int_equal(pl_gate_ratio_trend(&before, &now, 0.1, &growth, &noise),
                         few == 0 ? PL_GATE_SLOWER : PL_GATE_FEW);
    }
}

/* Two files, the machine of the second one ten times as slow. */
static void test_repeats_are_paired_within_their_file(void **state)
{
    (void)state;
    json_t *files[2] = {json_array(), json_array()};
    for (int i = 0; i < 12; ++i) {
        const double machine = i < 6 ? 1 : 10;
        json_t *row = add_run(files[i / 6], "scene", i % 2 == 0 ? "mine:p" : "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i / 2 % 3));
        json_object_set_new(row, "run", json_integer(i));
        set_metric(row, "m", metric_value(machine * (i % 2 == 0 ? 3 : 1)));
    }
    pl_result_table *table = table_of_two(files[0], files[1], true, NULL);
    assert_int_equal(table->cell_count, 2);
    const pl_gate_ratio ratio = pl_gate_ratio_measure(&table->cells[0], &table->cells[1], "m");
    assert_int_equal(ratio.repeats, 6);
    assert_close(ratio.low, 3, 1e-15, 0);
    assert_close(ratio.high, 3, 1e-15, 0);
    free_table(table);
    json_decref(files[0]);
    json_decref(files[1]);
}

static void test_larger_of_both_tolerances_is_allowed(void **state)
{
    (void)state;
    const pl_gate_tolerance t = {.relative = 0.1, .absolute = 0.3};
    assert_close(pl_gate_tolerance_at(&t, PL_METRIC_DRIFT, 2, 0.01), 0.3, 1e-15, 0);
    assert_close(pl_gate_tolerance_at(&t, PL_METRIC_DRIFT, -5, 0.01), 0.5, 1e-15, 0);
}

/* mass_height and energy_lost may be negative; growth is upwards all the same. */
static void test_growth_of_a_negative_number_is_upwards(void **state)
{
    (void)state;
    pl_gate_rule grown, fallen;
    assert_int_equal(pl_gate_rule_parse("mass_height>+10%", &grown, NULL), PL_OK);
    assert_int_equal(pl_gate_rule_parse("mass_height<-10%", &fallen, NULL), PL_OK);
    assert_false(pl_gate_rule_holds_relative(&grown, -2, -1.9, 0));
    assert_true(pl_gate_rule_holds_relative(&grown, -2, -1.7, 0));
    assert_false(pl_gate_rule_holds_relative(&fallen, -2, -2.1, 0));
    assert_true(pl_gate_rule_holds_relative(&fallen, -2, -2.3, 0));
}

static void test_relative_rule_leaves_rounding_alone(void **state)
{
    const workspace *w = *state;
    for (int large = 0; large < 2; ++large) {
        const double size = large ? 1e-6 : 1e-11;
        trial t = pair("drift", size, 2 * size);
        set_tolerance(&t, large ? "drift=2" : "drift=1e-6");
        add_rule(&t, "drift>+5%");
        expect(w, t, large, 0, "drift", "the rule fails it");
    }
}

static json_t *repeats(double first, double second, double third)
{
    const double values[] = {first, second, third};
    json_t *results = json_array();
    for (int i = 0; i < 3; ++i) {
        json_t *row = add_run(results, "scene", "mine:p", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set_metric(row, "spread_x", metric_value(values[i]));
    }
    return results;
}

/* Where neither direction is better. */
static void test_repeat_farthest_from_the_baseline_counts(void **state)
{
    const workspace *w = *state;
    json_t *low = repeats(0.5, 1, 1.25), *high = repeats(0.75, 1, 1.5);
    expect(w, begin_trial(single("spread_x", metric_value(1)), low), 1, 1, "spread_x",
           "changed by 50 %");
    expect(w, begin_trial(single("spread_x", metric_value(1)), high), 1, 1, "spread_x",
           "changed by 50 %");
}

static void test_outcome_of_the_first_failure_is_kept(void **state)
{
    const workspace *w = *state;
    json_t *failing = json_array();
    static const char *const outcomes[] = {"ok", "collapsed", "timeout"};
    for (int i = 0; i < 3; ++i) {
        json_t *row = add_run(failing, "scene", "mine:p", outcomes[i]);
        json_object_set_new(row, "repeat", json_integer(i));
        json_object_set_new(row, "reason", json_string(outcomes[i]));
    }
    json_t *fine = json_array();
    add_run(fine, "scene", "mine:p", "ok");
    expect(w, begin_trial(fine, failing), 1, 0, "outcome", "collapsed");
}

/* Of two builds under one label the one that ran last counts, in any order of the lines. */
static void test_results_of_the_later_build_count(void **state)
{
    (void)state;
    for (int order = 0; order < 2; ++order) {
        json_t *results = json_array();
        for (int i = 0; i < 2; ++i) {
            const bool later = i != order;
            json_t *row = add_run(results, "scene", "mine:p", "ok");
            set_metric(row, "drift", metric_value(later ? 2 : 1));
            json_object_set_new(row, "engine_binary", json_string(later ? "new" : "old"));
            json_object_set_new(row, "started", json_string(later ? "2026-02-02" : "2026-02-01"));
        }
        const pl_gate_tolerances tolerances = pl_gate_tolerances_default();
        pl_result_table *table = table_of(results);
        pl_gate_rows rows;
        pl_gate_gather(table, &tolerances, &rows);
        assert_int_equal(rows.count, 1);
        assert_int_equal(rows.items[0].cell->count, 1);
        assert_close(json_number_value(json_object_get(rows.items[0].metrics, "drift")), 2, 0, 0);
        pl_gate_rows_free(&rows);
        free_table(table);
        json_decref(results);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_trend_is_judged_beyond_limit_and_noise),
        cmocka_unit_test(test_trend_needs_repeats_on_both_sides),
        cmocka_unit_test(test_repeats_are_paired_within_their_file),
        cmocka_unit_test(test_larger_of_both_tolerances_is_allowed),
        cmocka_unit_test(test_growth_of_a_negative_number_is_upwards),
        cmocka_unit_test(test_relative_rule_leaves_rounding_alone),
        cmocka_unit_test(test_repeat_farthest_from_the_baseline_counts),
        cmocka_unit_test(test_outcome_of_the_first_failure_is_kept),
        cmocka_unit_test(test_results_of_the_later_build_count),
    };
    return cmocka_run_group_tests_name("gate trend", tests, setup_workspace, teardown_workspace);
}
