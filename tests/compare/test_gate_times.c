/* The gate's judgement of times and instructions, and what it takes for noise. */
#include "check.h"
#include "gate/gate.h"
#include "gate_trial.h"
#include "report_rows.h"

enum { REPEATS = 7 };

/* Times of both engines in the same repeats. `factor`: our time, relative to half of the
 * reference's. `noise`: relative, of each time by itself. */
static json_t *timed_metric(check_random *random, const char *metric, double factor, double noise)
{
    json_t *results = json_array();
    for (int i = 0; i < REPEATS; ++i) {
        double machine = check_uniform(random, 1, 3);
        for (int engine = 0; engine < 2; ++engine) {
            json_t *row = add_run(results, "scene", engine == 0 ? "mine:p" : "bullet:si", "ok");
            double disturbed = machine * (1 + check_uniform(random, -noise, noise));
            json_object_set_new(row, "repeat", json_integer(i));
            set_metric(row, metric,
                       json_pack("{s:f, s:b}", "value",
                                 1e-5 * disturbed * (engine == 0 ? 0.5 * factor : 1),
                                 "deterministic", 0));
        }
    }
    return results;
}

static json_t *timed(check_random *random, double factor, double noise)
{
    return timed_metric(random, "time_per_step", factor, noise);
}

/* A trial whose step takes `factor` times as long as before. The new results are drawn first. */
static trial timed_trial(check_random *random, double factor, double noise)
{
    json_t *after = timed(random, factor, noise), *before = timed(random, 1, noise);
    return begin_trial(before, after);
}

static void test_an_unchanged_time_passes(void **state)
{
    const workspace *w = *state;
    check_random random = {20};
    for (int i = 0; i < 20; ++i) {
        trial t = timed_trial(&random, 1, 0.02);
        expect(w, t, 0, 0, "", "");
    }
    for (int i = 0; i < 20; ++i) {
        trial t = timed_trial(&random, 1, 0.2);
        judge(w, &t);
        assert_int_equal(t.verdict.failures, 0);
        end_trial(&t);
    }
}

static void test_a_slower_step_fails_where_noise_allows(void **state)
{
    const workspace *w = *state;
    check_random random = {21};
    for (int i = 0; i < 20; ++i) {
        expect(w, timed_trial(&random, 1.2, 0.01), 1, 0, "time_per_step", "costlier: +");
        expect(w, timed_trial(&random, 0.8, 0.01), 0, 1, "time_per_step", "cheaper: -");
        expect(w, timed_trial(&random, 1.2, 0.4), 0, 1, "time_per_step", "inconclusive: ");
        /* The difference is so large that noise cannot hide it. */
        expect(w, timed_trial(&random, 3, 0.1), 1, 0, "time_per_step", "costlier: +");
    }
    trial t = timed_trial(&random, 1.2, 0.01);
    t.tolerances.time = 0.3;
    expect(w, t, 0, 0, "", "");
    t = timed_trial(&random, 1.2, 0.01);
    add_rule(&t, "scene/mine: time_per_step>+30%");
    expect(w, t, 0, 0, "", "");
    t = timed_trial(&random, 1.07, 0.01);
    add_rule(&t, "scene/mine: time_per_step>+2%");
    expect(w, t, 1, 0, "time_per_step", "costlier");
}

static void test_few_repeats_say_nothing_of_times(void **state)
{
    const workspace *w = *state;
    check_random random = {22};
    json_t *few = timed(&random, 3, 0.01);
    while (json_array_size(few) > 8) {
        json_array_remove(few, json_array_size(few) - 1);
    }
    expect(w, begin_trial(timed(&random, 1, 0.01), few), 0, 1, "time_per_step",
           "5 repeats or more");
}

static void test_instructions_have_a_tighter_limit(void **state)
{
    const workspace *w = *state;
    for (int slow = 0; slow < 2; ++slow) {
        json_t *sides[2];
        for (int side = 0; side < 2; ++side) {
            sides[side] = json_array();
            for (int i = 0; i < 2 * REPEATS; ++i) {
                bool ours = i % 2 == 0;
                json_t *row = add_run(sides[side], "scene", ours ? "mine:p" : "ode:quick", "ok");
                json_object_set_new(row, "repeat", json_integer(i / 2));
                double count = ours && side == 1 ? (slow == 1 ? 1030 : 1010) : 1000;
                set_metric(row, "instructions_per_step",
                           json_pack("{s:f, s:b}", "value", count, "deterministic", 0));
            }
        }
        expect(w, begin_trial(sides[0], sides[1]), slow, 0, "instructions_per_step",
               "costlier: +3 %");
    }
}

/* Times of create and read, and wall times: as ratios, and only where a rule asks. */
static void test_other_times_are_compared_by_rules_alone(void **state)
{
    const workspace *w = *state;
    static const char *const names[] = {"wall_time_per_step", "time_create", "wall_time_create",
                                        "time_read", "wall_time_read"};
    check_random random = {24};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        for (int asked = 0; asked < 2; ++asked) {
            json_t *after = timed_metric(&random, names[i], 1.5, 0.01);
            trial t = begin_trial(timed_metric(&random, names[i], 1, 0.01), after);
            char rule[80];
            snprintf(rule, sizeof rule, "scene/mine: %s>+25%%", names[i]);
            if (asked == 1) {
                add_rule(&t, rule);
            }
            expect(w, t, asked, 0, asked == 1 ? names[i] : "", asked == 1 ? "costlier: +" : "");
        }
    }
}

/* Bounds of the median by the sign test: 5 to 8 repeats reach from the least to the largest, 9
 * leave out one at each end, 20 five: 2 P(B < 2) = 20/512, 2 P(B < 6) = 0.0414 below 1/16. */
static void test_bounds_of_the_median(void **state)
{
    (void)state;
    static const int counts[] = {1, 5, 8, 9, 20}, ranks[] = {1, 1, 1, 2, 6};
    for (int i = 0; i < 5; ++i) {
        json_t *results = json_array();
        for (int k = 0; k < 2 * counts[i]; ++k) {
            json_t *row = add_run(results, "scene", k % 2 == 0 ? "mine:p" : "ode:quick", "ok");
            json_object_set_new(row, "repeat", json_integer(k / 2));
            set_metric(row, "m", metric_value(k % 2 == 0 ? k / 2 + 1 : 1));
        }
        pl_result_table *table = table_of(results);
        const pl_gate_ratio ratio = pl_gate_ratio_measure(&table->cells[0], &table->cells[1], "m");
        assert_int_equal(ratio.repeats, counts[i]);
        assert_close(ratio.value, 0.5 * (counts[i] + 1), 0, 0);
        assert_close(ratio.low, ranks[i], 0, 0);
        assert_close(ratio.high, counts[i] + 1 - ranks[i], 0, 0);
        free_table(table);
        json_decref(results);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_unchanged_time_passes),
        cmocka_unit_test(test_a_slower_step_fails_where_noise_allows),
        cmocka_unit_test(test_few_repeats_say_nothing_of_times),
        cmocka_unit_test(test_instructions_have_a_tighter_limit),
        cmocka_unit_test(test_other_times_are_compared_by_rules_alone),
        cmocka_unit_test(test_bounds_of_the_median),
    };
    return cmocka_run_group_tests_name("gate times", tests, setup_workspace, teardown_workspace);
}
