/* The gate's judgement of runs, numbers and texts: a failure, a notice or neither. */
#include "check.h"
#include "gate_trial.h"
#include "report_rows.h"

#include <string.h>

static void test_numbers_are_held_in_both_directions(void **state)
{
    const workspace *w = *state;
    expect(w, pair("drift", 0.5, 0.5), 0, 0, "", "");
    expect(w, pair("drift", 0.5, 0.505), 1, 0, "drift", "worse by 1 %");
    expect(w, pair("drift", 0.5, 0.495), 0, 1, "drift", "better by 1 %: --update-baseline");
    expect(w, pair("spread_x", 0.5, 0.505), 1, 0, "spread_x", "changed by 1 %");
    expect(w, pair("spread_x", 0.5, 0.495), 1, 0, "spread_x", "changed by 1 %");
    expect(w, pair("drift", 0, 0.01), 1, 0, "drift", "worse");
}

static void test_rounding_is_no_difference(void **state)
{
    const workspace *w = *state;
    expect(w, pair("drift", 1e-12, 5e-10), 0, 0, "", "");
    expect(w, pair("drift", 1e-12, 5e-9), 1, 0, "drift", "worse, 5e+03 times");
    expect(w, pair("drift", 1, 1 + 5e-7), 0, 0, "", "");
    expect(w, pair("drift", 1, 1 + 5e-6), 1, 0, "drift", "worse");
    /* A step of 0.01 s. */
    expect(w, pair("settle_time", 0.5, 0.51), 0, 0, "", "");
    expect(w, pair("settle_time", 0.5, 0.52), 1, 0, "settle_time", "worse by 4 %");
}

static void test_tolerances_are_the_requested_ones(void **state)
{
    const workspace *w = *state;
    static const struct {
        const char *limit;
        int failures;
    } rows[] = {{"drift=0.02", 0},     {"drift=0.005", 1}, {"drift=0,0.0051", 0},
                {"drift=0,0.0049", 1}, {"drift=off", 0},   {"lift=off", 1}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        trial t = pair("drift", 0.5, 0.505);
        set_tolerance(&t, rows[i].limit);
        expect(w, t, rows[i].failures, 0, "drift", "worse");
    }
    /* What differs from run to run is compared only where that was asked for. */
    expect(w, pair("memory_peak", 1e6, 9e6), 0, 0, "", "");
    trial t = pair("memory_peak", 1e6, 9e6);
    set_tolerance(&t, "memory_peak=0.5");
    expect(w, t, 1, 0, "memory_peak", "worse by 800 %");
}

static void test_texts_are_exact(void **state)
{
    const workspace *w = *state;
    static const char *const limits[] = {NULL, "state_hash=0", "state_hash=off"};
    for (int i = 0; i < 3; ++i) {
        trial t = begin_trial(single("state_hash", json_pack("{s:s}", "value", "a")),
                              single("state_hash", json_pack("{s:s}", "value", "b")));
        if (limits[i] != NULL) {
            set_tolerance(&t, limits[i]);
        }
        expect(w, t, i == 1, i == 0, "state_hash", i == 0 ? "other bits" : "changed");
    }
    expect(w,
           begin_trial(single("integrator", json_pack("{s:s}", "value", "mixed")),
                       single("integrator", json_pack("{s:s}", "value", "semi-implicit Euler"))),
           1, 0, "integrator", "changed");
}

static void test_lost_value_fails(void **state)
{
    const workspace *w = *state;
    json_t *lost = json_pack("{s:n, s:s}", "value", "reason", "still moves");
    expect(w, begin_trial(single("settle_time", metric_value(1)), single("settle_time", lost)), 1,
           0, "settle_time", "still moves");
    lost = json_pack("{s:n, s:s}", "value", "reason", "still moves");
    expect(w, begin_trial(single("settle_time", lost), single("settle_time", metric_value(1))), 0,
           1, "settle_time", "has a value now");
    json_t *without = json_array();
    add_run(without, "scene", "mine:p", "ok");
    expect(w, begin_trial(single("drift", metric_value(1)), without), 1, 0, "drift",
           "the metric is gone");
    without = json_array();
    add_run(without, "scene", "mine:p", "ok");
    expect(w, begin_trial(without, single("drift", metric_value(1))), 0, 1, "drift",
           "the baseline has no such metric");
}

static json_t *with_outcome(const char *outcome, double drift)
{
    json_t *results = json_array();
    json_t *row = add_run(results, "scene", "mine:p", outcome);
    set_metric(row, "drift", metric_value(drift));
    if (strcmp(outcome, "ok") != 0) {
        json_object_set_new(row, "reason", json_string("it fell"));
    }
    return results;
}

static void test_run_no_longer_ok_fails_once(void **state)
{
    const workspace *w = *state;
    expect(w, begin_trial(with_outcome("ok", 1), with_outcome("collapsed", 50)), 1, 0, "outcome",
           "it fell");
    expect(w, begin_trial(with_outcome("collapsed", 1), with_outcome("ok", 50)), 0, 1, "outcome",
           "better");
    expect(w, begin_trial(with_outcome("collapsed", 1), with_outcome("collapsed", 50)), 0, 0, "",
           "");
    expect(w, begin_trial(with_outcome("collapsed", 1), with_outcome("crashed", 1)), 1, 0,
           "outcome", "it fell");
}

static json_t *with_verdict(const char *verdict)
{
    json_t *results = single("drift", metric_value(1));
    if (verdict[0] != '\0') {
        set_verdict(json_array_get(results, 0), verdict, "drift is too large");
    }
    return results;
}

/* "" is a result or a baseline that was made without verdicts. */
static void test_worse_verdict_than_the_baseline_fails(void **state)
{
    const workspace *w = *state;
    static const struct {
        const char *before, *now, *what;
        int failures, notices;
    } rows[] = {{"accurate", "accurate", "", 0, 0},
                {"accurate", "inaccurate", "drift is too large", 1, 0},
                {"accurate", "failed", "drift is too large", 1, 0},
                {"inaccurate", "failed", "drift is too large", 1, 0},
                {"failed", "inaccurate", "better", 0, 1},
                {"inaccurate", "accurate", "better", 0, 1},
                {"", "inaccurate", "the baseline has none", 0, 1},
                {"accurate", "", "no longer judged", 0, 1},
                {"", "", "", 0, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        expect(w, begin_trial(with_verdict(rows[i].before), with_verdict(rows[i].now)),
               rows[i].failures, rows[i].notices, "verdict", rows[i].what);
    }
}

static void test_worst_verdict_of_the_repeats_counts(void **state)
{
    const workspace *w = *state;
    json_t *results = with_verdict("accurate");
    for (int i = 1; i < 3; ++i) {
        json_t *row = add_run(results, "scene", "mine:p", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set_metric(row, "drift", metric_value(1));
        set_verdict(row, i == 1 ? "inaccurate" : "accurate", "drift is too large");
    }
    expect(w, begin_trial(with_verdict("accurate"), results), 1, 0, "verdict",
           "drift is too large");
}

static void test_missing_run_fails_and_new_run_is_noticed(void **state)
{
    const workspace *w = *state;
    for (int missing = 0; missing < 2; ++missing) {
        json_t *one = single("drift", metric_value(1)), *two = single("drift", metric_value(1));
        set_metric(add_run(two, "other", "mine:p", "ok"), "drift", metric_value(1));
        expect(w, missing == 1 ? begin_trial(two, one) : begin_trial(one, two), missing,
               1 - missing, "outcome", missing == 1 ? "no such run" : "not in the baseline");
    }
}

static void test_another_step_or_seed_is_another_run(void **state)
{
    const workspace *w = *state;
    static const char *const keys[] = {"seed", "dt", "duration", "params"};
    for (int i = 0; i < 4; ++i) {
        json_t *changed = single("drift", metric_value(9));
        json_t *row = json_array_get(changed, 0);
        json_t *in = i == 1 || i == 2 ? json_object_get(row, "settings") : row;
        json_object_set_new(in, keys[i], i == 3 ? json_pack("{s:i}", "n", 3) : json_real(0.25));
        if (i == 0) {
            json_object_set_new(in, keys[i], json_integer(7));
        }
        expect(w, begin_trial(single("drift", metric_value(1)), changed), 1, 1, "outcome",
               "no such run");
    }
}

/* A parameter that the catalogue got after the baseline was made. */
static void test_parameter_at_its_default_is_the_same_run(void **state)
{
    const workspace *w = *state;
    for (int n = 10; n < 12; ++n) {
        json_t *before = json_array(), *now = json_array();
        add_run(before, "tower", "mine:p", "ok");
        json_object_set_new(add_run(now, "tower", "mine:p", "ok"), "params",
                            json_pack("{s:i}", "n", n));
        expect(w, begin_trial(before, now), n != 10, n != 10, "outcome", "no such run");
    }
}

static void test_the_worst_of_repeats_that_differ_counts(void **state)
{
    const workspace *w = *state;
    json_t *results = json_array();
    for (int i = 0; i < 3; ++i) {
        json_t *row = add_run(results, "scene", "mine:p", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set_metric(row, "drift", metric_value(i == 1 ? 2 : 1));
    }
    expect(w, begin_trial(single("drift", metric_value(1)), results), 1, 1, "drift",
           "worse by 100 %");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_are_held_in_both_directions),
        cmocka_unit_test(test_rounding_is_no_difference),
        cmocka_unit_test(test_tolerances_are_the_requested_ones),
        cmocka_unit_test(test_texts_are_exact),
        cmocka_unit_test(test_lost_value_fails),
        cmocka_unit_test(test_run_no_longer_ok_fails_once),
        cmocka_unit_test(test_worse_verdict_than_the_baseline_fails),
        cmocka_unit_test(test_worst_verdict_of_the_repeats_counts),
        cmocka_unit_test(test_missing_run_fails_and_new_run_is_noticed),
        cmocka_unit_test(test_another_step_or_seed_is_another_run),
        cmocka_unit_test(test_parameter_at_its_default_is_the_same_run),
        cmocka_unit_test(test_the_worst_of_repeats_that_differ_counts),
    };
    return cmocka_run_group_tests_name("gate", tests, setup_workspace, teardown_workspace);
}
