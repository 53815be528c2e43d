/* Where the report says that plumb loses. */
#include "check.h"
#include "report_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void test_loss_is_the_ratio_to_the_best_other(void **state)
{
    (void)state;
    json_t *results = two_runs("drift", 6e-3, 2e-3);
    set_metric(add_run(results, "pair", "bullet:si", "ok"), "drift", metric_value(3e-3));
    set_metric(add_run(results, "pair", "bullet:nncg", "collapsed"), "drift", metric_value(1e-9));
    set_metric(add_run(results, "pair", "plumb:accurate", "ok"), "drift", metric_value(1e-3));
    json_t *row;
    size_t index;
    json_array_foreach(results, index, row)
        json_object_set_new(row, "primary_error", json_string(""));
    made_report made = make_report(results);
    assert_int_equal(made.report.losses.count, 1);
    assert_int_equal(made.report.losses.comparisons, 2);
    const pl_loss *loss = &made.report.losses.items[0];
    assert_int_equal(loss->kind, PL_LOSS_VALUE);
    assert_int_equal(loss->metric, PL_METRIC_DRIFT);
    assert_string_equal(loss->home->worst->label, "plumb:fast");
    assert_string_equal(loss->best->worst->label, "ode:quick");
    assert_close(loss->ratio, 3, 0, 1e-15);
    free_report(&made);
}

static void test_value_of_an_inaccurate_run_says_so(void **state)
{
    (void)state;
    for (int i = 0; i < 2; ++i) {
        json_t *results = two_runs("time_per_step", 2e-3, 1e-3);
        json_t *theirs = json_array_get(results, 1);
        json_object_set_new(theirs, "verdict", json_string(i == 0 ? "accurate" : "inaccurate"));
        made_report made = make_report(results);
        assert_int_equal(made.report.losses.count, 1);
        assert_contains(made.markdown,
                        i == 0 ? "| 1.00 ms | ×2.00 |" : "| 1.00 ms (inaccurate) | ×2.00 |");
        free_report(&made);
    }
}

static void test_difference_below_noise_is_no_loss(void **state)
{
    (void)state;
    static const struct {
        const char *metric;
        double ours, theirs;
        int losses;
    } cases[] = {
        {"creep", 9e-10, 1e-16, 0},
        {"creep", 1.1e-9, 1e-16, 1},
        {"energy_gain", 4.6e-12, 0, 0},
        {"energy_gain", 2e-9, 0, 1},
        {"momentum_error", 9e-10, 1e-17, 0},
        {"rest_rotation_error", 9e-10, 0, 0},
        {"penetration_rest", 1.5e-10, 2.3e-11, 0},
        {"penetration_rest", 1.5e-8, 2.3e-11, 1},
        {"travel_error", 2e-3, 1e-3, 1},
        {"discrete_error", 2e-3, 1e-3, 1},
        {"rest_position_error", 2e-3, 1e-3, 1},
        {"settle_time", 0.01, 0, 0}, /* the step of these rows */
        {"settle_time", 0.02, 0, 1},
        {"time_per_step", 1.09e-3, 1e-3, 0},
        {"time_per_step", 1.11e-3, 1e-3, 1},
        {"memory_peak", 1.09e7, 1e7, 0},
        {"memory_peak", 1.2e7, 1e7, 1},
        {"memory_peak", 33e3, 29e3, 0},
        {"memory_peak", 262e3, 0, 0},
        {"memory_peak", 500e3, 238e3, 0},
        {"memory_peak", 500e3, 230e3, 1},
        {"creep", 1e-3, 1e-3, 0},
        {"creep", 1.001e-3, 1e-3, 1},
        {"creep", 1e-3, 0, 1},
        {"iterations_mean", 50, 10, 0},
        {"iterations_max", 50, 10, 0},
        {"residual_max", 50, 10, 0},
        {"residual_rms", 50, 10, 0},
        {"energy_step_gain", 5e-9, 0, 1},
        {"lift", 5e-10, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        made_report made = make_report(two_runs(cases[i].metric, cases[i].ours, cases[i].theirs));
        if (made.report.losses.count != cases[i].losses) {
            fail_msg("%s %g against %g: %d losses", cases[i].metric, cases[i].ours, cases[i].theirs,
                     made.report.losses.count);
        }
        free_report(&made);
    }
}

static void test_ratio_uses_the_floor_below_it(void **state)
{
    (void)state;
    static const struct {
        const char *metric;
        double ours, theirs, ratio;
    } cases[] = {
        {"energy_gain", 5e-9, 0, 5},          {"energy_gain", 5e-9, 1e-12, 5},
        {"energy_gain", 5e-9, 2e-9, 2.5},     {"settle_time", 0.05, 0, 5},
        {"memory_peak", 1024 * 1024, 100, 4}, {"time_per_step", 3e-3, 1e-3, 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        made_report made = make_report(two_runs(cases[i].metric, cases[i].ours, cases[i].theirs));
        assert_int_equal(made.report.losses.count, 1);
        assert_close(made.report.losses.items[0].ratio, cases[i].ratio, 0, 1e-12);
        assert_absent(made.data, "×∞");
        free_report(&made);
    }
}

static void test_floors_are_stated_next_to_the_losses(void **state)
{
    (void)state;
    made_report made = make_report(two_runs("creep", 2e-3, 1e-3));
    static const char *const facts[] = {"1e-9 for lengths", "256 KiB", "within 10 %",
                                        "one time step"};
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; ++i) {
        assert_contains(made.data, facts[i]);
        assert_before(made.markdown, facts[i], "## Results");
    }
    free_report(&made);
}

static void test_primary_error_is_not_counted_under_two_names(void **state)
{
    (void)state;
    json_t *results = two_runs("drift", 2e-3, 1e-3); /* the primary error of these rows */
    set_metric(json_array_get(results, 0), "reference_error", metric_value(2e-3));
    set_metric(json_array_get(results, 1), "reference_error", metric_value(1e-3));
    made_report made = make_report(results);
    assert_int_equal(made.report.losses.count, 1);
    assert_int_equal(made.report.losses.items[0].metric, PL_METRIC_REFERENCE_ERROR);
    assert_contains(made.data, "reference_error (drift)");
    free_report(&made);
}

static void set_both(json_t *results, const char *metric, double ours, double theirs)
{
    set_metric(json_array_get(results, 0), metric, metric_value(ours));
    set_metric(json_array_get(results, 1), metric, metric_value(theirs));
}

static void test_primary_error_and_time_come_before_other_metrics(void **state)
{
    (void)state;
    json_t *results = two_runs("cone_violation", 3e-8, 2e-16);
    set_both(results, "force_balance", 3e-3, 1e-13);
    set_both(results, "momentum_error", 9e-8, 1e-13);
    set_both(results, "time_per_step", 2.8e-3, 2e-4);
    set_both(results, "reference_error", 6e-3, 2e-3);
    set_both(results, "creep", 1.1e-7, 2e-8);
    made_report made = make_report(results);
    static const int order[] = {PL_METRIC_TIME_PER_STEP,  PL_METRIC_REFERENCE_ERROR,
                                PL_METRIC_FORCE_BALANCE,  PL_METRIC_CREEP,
                                PL_METRIC_MOMENTUM_ERROR, PL_METRIC_CONE_VIOLATION};
    assert_int_equal(made.report.losses.count, 6);
    for (int i = 0; i < 6; ++i) {
        assert_int_equal(made.report.losses.items[i].metric, order[i]);
        assert_int_equal(made.report.losses.items[i].near_rounding, i > 3);
    }
    assert_int_equal(count_of(made.data, "both near rounding"), 2);
    assert_int_equal(count_of(made.markdown, "both near rounding"), 2);
    free_report(&made);
}

static void test_losses_are_sorted_by_falling_ratio(void **state)
{
    (void)state;
    json_t *results = two_runs("creep", 2e-3, 1e-3);
    json_t *ours = json_array_get(results, 0), *theirs = json_array_get(results, 1);
    set_metric(ours, "settle_time", json_pack("{s:n, s:s}", "value", "reason", "it never rests"));
    set_metric(theirs, "settle_time", metric_value(1));
    set_metric(ours, "energy_gain", metric_value(5e-3));
    set_metric(theirs, "energy_gain", metric_value(1e-3));
    set_metric(ours, "penetration_max", metric_value(1e-3));
    set_metric(theirs, "penetration_max", metric_value(0));
    add_run(results, "other", "plumb:fast", "timeout");
    add_run(results, "other", "ode:quick", "ok");
    made_report made = make_report(results);
    assert_int_equal(made.report.losses.count, 5);
    assert_int_equal(made.report.losses.items[0].kind, PL_LOSS_OUTCOME);
    assert_string_equal(made.report.losses.items[0].home->worst->scenario, "other");
    assert_int_equal(made.report.losses.items[1].kind, PL_LOSS_NO_VALUE);
    assert_int_equal(made.report.losses.items[1].metric, PL_METRIC_SETTLE_TIME);
    assert_int_equal(made.report.losses.items[2].metric, PL_METRIC_PENETRATION_MAX);
    assert_close(made.report.losses.items[2].ratio, 1e6, 0, 1e-15); /* to the floor */
    assert_int_equal(made.report.losses.items[3].metric, PL_METRIC_ENERGY_GAIN);
    assert_close(made.report.losses.items[3].ratio, 5, 0, 1e-15);
    assert_int_equal(made.report.losses.items[4].metric, PL_METRIC_CREEP);
    assert_contains(made.data, "it never rests");
    free_report(&made);
}

static void test_times_of_different_machines_are_not_compared(void **state)
{
    (void)state;
    json_t *results = two_runs("time_per_step", 2e-3, 1e-3);
    json_object_set_new(json_object_get(json_array_get(results, 1), "host"), "cpu",
                        json_string("two"));
    made_report made = make_report(results);
    assert_int_equal(made.report.losses.count, 0);
    assert_contains(made.data, "\"several_hosts\":true");
    assert_contains(made.markdown, "come from several machines");
    free_report(&made);
}

static void test_no_losses_is_reported_with_the_comparisons(void **state)
{
    (void)state;
    made_report made = make_report(two_runs("creep", 1e-3, 2e-3));
    static const char words[] =
        "No losses: in none of 1 comparisons is plumb worse than the best other "
        "engine, over 1 case: plumb:fast against the best of ode:quick.";
    assert_contains(made.data, words);
    assert_contains(made.markdown, words);
    char *table = printed_table(made.results, false, 1000);
    assert_contains(table, words);
    free(table);
    free_report(&made);
}

static void test_nothing_compared_is_not_called_no_losses(void **state)
{
    (void)state;
    json_t *ours = json_array(), *apart = json_array();
    add_run(ours, "s", "plumb:fast", "ok");
    add_run(apart, "s", "plumb:fast", "ok");
    add_run(apart, "s", "ode:quick", "timeout");
    made_report reports[] = {make_report(ours), make_report(apart)};
    for (int i = 0; i < 2; ++i) {
        assert_contains(reports[i].data, "Nothing was compared");
        assert_absent(reports[i].data, "No losses");
        free_report(&reports[i]);
    }
}

static void test_losses_appear_only_with_a_home_engine(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_run(results, "s", "ode:quick", "ok");
    add_run(results, "s", "bullet:si", "ok");
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 100);
    assert_absent(made.data, "Where plumb loses");
    assert_absent(made.markdown, "Where plumb loses");
    assert_absent(table, "Where plumb loses");
    free(table);
    free_report(&made);
}

static void test_verdicts_and_losses_come_before_results(void **state)
{
    (void)state;
    made_report made = make_report(runs_of_every_kind());
    assert_before(made.markdown, "## Verdicts", "\n|");
    assert_before(made.markdown, "## Where plumb loses", "## Results");
    char *table = printed_table(made.results, false, 100);
    assert_before(table, "Where plumb loses\n", "  engine ");
    free(table);
    free_report(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_value_of_an_inaccurate_run_says_so),
        cmocka_unit_test(test_loss_is_the_ratio_to_the_best_other),
        cmocka_unit_test(test_difference_below_noise_is_no_loss),
        cmocka_unit_test(test_ratio_uses_the_floor_below_it),
        cmocka_unit_test(test_floors_are_stated_next_to_the_losses),
        cmocka_unit_test(test_primary_error_is_not_counted_under_two_names),
        cmocka_unit_test(test_primary_error_and_time_come_before_other_metrics),
        cmocka_unit_test(test_losses_are_sorted_by_falling_ratio),
        cmocka_unit_test(test_times_of_different_machines_are_not_compared),
        cmocka_unit_test(test_no_losses_is_reported_with_the_comparisons),
        cmocka_unit_test(test_nothing_compared_is_not_called_no_losses),
        cmocka_unit_test(test_losses_appear_only_with_a_home_engine),
        cmocka_unit_test(test_verdicts_and_losses_come_before_results),
    };
    return cmocka_run_group_tests_name("report_losses", tests, NULL, NULL);
}
