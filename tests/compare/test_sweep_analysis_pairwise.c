/* From points to ratios, their intervals, losses, means and profiles, by hand. */
#include "base/random.h"
#include "check.h"
#include "sweep_analysis_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void test_speed_ratio_is_cost_at_each_error(void **state)
{
    (void)state;
    json_t *results = crossing_sweep();
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_pairwise_comparison *comparison = comparison_with(&analysis, "ode");
    static const double speeds[] = {0.5, 0.5, 4, 4};
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        assert_int_equal(comparison->at_error[k],
                         k < 4 ? PL_ATTAINED_BY_BOTH : PL_ATTAINED_BY_NEITHER);
        if (k < 4)
            assert_close(comparison->ratios[PL_SPEED + k].value, speeds[k], 0, 0);
        else
            assert_true(isnan(comparison->ratios[PL_SPEED + k].value));
        assert_true(
            isnan(comparison->ratios[PL_SPEED + k].low)); /* one repeat says nothing of spread */
    }
    /* Ours is one point, so between points there is 1e-4 alone. */
    assert_true(isnan(comparison->ratios[PL_SPEED_BETWEEN + 2].value));
    assert_close(comparison->ratios[PL_SPEED_BETWEEN + 3].value, 4, 0, 0);
    finish_sweep(&analysis, results);
}

static void test_error_ratio_is_taken_at_each_cost(void **state)
{
    (void)state;
    json_t *results = crossing_sweep();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 32, 1e-6, .iterations = 5});
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_pairwise_comparison *comparison = comparison_with(&analysis, "ode");
    enum { AT_1 = 18, AT_2, AT_5, AT_10, AT_20 };
    assert_close(pl_sweep_times[AT_5], 5, 0, 0);
    assert_int_equal(comparison->at_cost[AT_1 - 1], PL_ATTAINED_BY_NEITHER);
    assert_int_equal(comparison->at_cost[AT_1], PL_ATTAINED_BY_SECOND_ONLY);
    assert_close(comparison->ratios[PL_EXACTNESS + AT_2].value, 100, 0, 1e-15);
    assert_close(comparison->ratios[PL_EXACTNESS + AT_5].value, 100, 0, 1e-15);
    assert_close(comparison->ratios[PL_EXACTNESS + AT_10].value, 1, 0, 0);
    /* At 5: ode (5 -> 8 of 1e-2 -> 1e-4), ours 2 -> 32 of 1e-4 -> 1e-6. */
    double theirs = pow(10, -2 - 2 * log(5) / log(8));
    double ours = pow(10, -4 - 2 * log(2.5) / log(16));
    assert_close(comparison->ratios[PL_EXACTNESS_BETWEEN + AT_5].value, theirs / ours, 0, 1e-12);
    assert_true(
        isnan(comparison->ratios[PL_EXACTNESS_BETWEEN + AT_20].value)); /* beyond ode's front */
    finish_sweep(&analysis, results);
}

static void test_losses_are_where_another_front_is_ahead(void **state)
{
    (void)state;
    json_t *results = crossing_sweep();
    /* b: at 1e-3 ours is never there, at 1e-1 it is 5 % behind. */
    add_sweep_run(results, (sweep_run){.scenario = "b", "plumb:p", 1.05, 5e-2});
    add_sweep_run(results, (sweep_run){.scenario = "b", "ode:q", 1, 5e-2, .iterations = 1});
    add_sweep_run(results, (sweep_run){.scenario = "b", "ode:q", 3, 5e-4, .iterations = 2});
    pl_sweep_analysis analysis = analysis_of(results);
    /* a: 1e-1, 1e-2. b: 1e-1, 1e-2, 1e-3. */
    char *text = document_of(&analysis);
    assert_contains(text, "in 5 of 7 comparisons");
    assert_contains(text, "in 1 at errors up to 1e-3, in 4 at larger");
    free(text);
    json_t *losses = losses_of(&analysis);
    assert_int_equal(json_array_size(losses), 5);
    static const struct {
        const char *scene;
        int level;
        const char *reached;
        bool within_noise;
    } expected[] = {{"b n=0", 2, "second only", false},
                    {"b n=0", 1, "second only", false},
                    {"a n=0", 0, "both", false},
                    {"a n=0", 1, "both", false},
                    {"b n=0", 0, "both", true}};
    for (int i = 0; i < 5; ++i) {
        const json_t *loss = json_array_get(losses, (size_t)i);
        assert_string_equal(analysis.scenes[pl_study_integer(loss, "scene")].of->name,
                            expected[i].scene);
        assert_true(pl_study_number(loss, "level") == pl_sweep_levels[expected[i].level]);
        assert_string_equal(pl_study_text(loss, "reached"), expected[i].reached);
        assert_int_equal(json_is_true(json_object_get(loss, "within_noise")),
                         expected[i].within_noise);
        assert_int_equal(json_is_null(json_object_get(loss, "first_point")),
                         strcmp(expected[i].reached, "second only") == 0);
        assert_true(json_is_integer(json_object_get(loss, "second_point")));
    }
    assert_int_equal(pl_study_integer(json_array_get(losses, 0), "second_point"), 5);
    json_decref(losses);
    finish_sweep(&analysis, results);
}

static void test_equal_engines_have_no_losses(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 2, 1e-4});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 2, 1e-4});
    pl_sweep_analysis analysis = analysis_of(results);
    char *text = document_of(&analysis);
    assert_contains(text, "in none of 4 comparisons");
    free(text);
    assert_close(comparison_with(&analysis, "ode")->ratios[PL_SPEED + 0].value, 1, 0, 0);
    finish_sweep(&analysis, results);
}

static void test_constant_repeats_have_an_interval_without_width(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-2},
                (const double[]){3, 3, 3}, 3);
    add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-4, .dt = 0.125},
                (const double[]){9, 9, 9}, 3);
    add_repeats(results, (sweep_run){.scenario = "a", "ode:q", .error = 1e-1},
                (const double[]){0.7, 0.7}, 2);
    add_repeats(results, (sweep_run){.scenario = "a", "ode:q", .error = 1e-5, .dt = 0.125},
                (const double[]){11, 11}, 2);
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_pairwise_comparison *comparison = comparison_with(&analysis, "ode");
    const pl_sweep_pair *pair = &analysis.pairs[pair_named(&analysis, "plumb", "ode")];
    const pl_sweep_ratio *ratios[] = {
        &comparison->ratios[PL_SPEED + 2], &comparison->ratios[PL_SPEED_BETWEEN + 2],
        &comparison->ratios[PL_EXACTNESS + 20], &comparison->ratios[PL_EXACTNESS_BETWEEN + 20]};
    for (int i = 0; i < 4; ++i) {
        assert_true(isfinite(ratios[i]->value));
        assert_true(ratios[i]->low == ratios[i]->value && ratios[i]->high == ratios[i]->value);
    }
    assert_close(pair->mean[2].low, pair->mean[2].value, 0, 1e-15);
    assert_close(pair->mean[2].high, pair->mean[2].value, 0, 1e-15);
    finish_sweep(&analysis, results);
}

/* Five of eleven are 1 and five are 3: the median of eleven that are drawn is either in 38 % of all
 * cases. */
static void test_interval_is_that_of_resampled_medians(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-2},
                (const double[]){1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, 11);
    add_repeats(results, (sweep_run){.scenario = "a", "ode:q", .error = 1e-2},
                (const double[]){3, 1, 2, 3, 1, 3, 1, 3, 1, 3, 1}, 11);
    /* 1 of 11 is drawn 6 times or more of 11 in 4e-4 of all cases: the median stays at 2. */
    add_repeats(results, (sweep_run){.scenario = "a", "bullet:s", .error = 1e-2},
                (const double[]){2, 2, 2, 2, 2, 90, 2, 2, 2, 2, 2}, 11);
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_sweep_ratio *ode = &comparison_with(&analysis, "ode")->ratios[PL_SPEED + 1];
    const pl_sweep_ratio *bullet = &comparison_with(&analysis, "bullet")->ratios[PL_SPEED + 1];
    assert_close(ode->value, 2, 0, 0);
    assert_close(ode->low, 1, 0, 0);
    assert_close(ode->high, 3, 0, 0);
    assert_close(bullet->low, 2, 0, 0);
    assert_close(bullet->high, 2, 0, 0);
    finish_sweep(&analysis, results);
}

/* Repeats of a time of 1 with noise of 5 %. */
static void add_noisy(json_t *results, sweep_run run, int repeats, pl_random *random)
{
    double costs[3];
    for (int i = 0; i < repeats; ++i)
        costs[i] = exp(0.05 * pl_random_normal(random));
    add_repeats(results, run, costs, repeats);
}

/* Three repeats of a point, or one, tell little of its scatter; all points together tell it. */
static void test_intervals_of_few_repeats_hold_the_true_ratio(void **state)
{
    (void)state;
    enum { SWEEPS = 200, POINTS = 4 };
    pl_random random = {.state = 5};
    int held[2] = {0, 0};
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        json_t *results = json_array();
        for (int i = 0; i < POINTS; ++i) {
            const double error = i == 0 ? 1e-2 : 1, dt = ldexp(1, -i);
            add_noisy(results, (sweep_run){.scenario = "a", "plumb:p", 0, error, dt}, 3, &random);
            add_noisy(results, (sweep_run){.scenario = "a", "ode:q", 0, error, dt}, 3, &random);
        }
        add_noisy(results, (sweep_run){.scenario = "a", "bullet:s", 0, 1e-2}, 1, &random);
        pl_sweep_analysis analysis = analysis_of(results);
        for (int i = 0; i < 2; ++i) {
            const pl_sweep_ratio *ratio =
                &comparison_with(&analysis, i == 0 ? "ode" : "bullet")->ratios[PL_SPEED + 1];
            held[i] += ratio->low <= 1 && 1 <= ratio->high;
        }
        finish_sweep(&analysis, results);
    }
    for (int i = 0; i < 2; ++i)
        assert_true(held[i] >= 0.93 * SWEEPS && held[i] < SWEEPS);
}

/* The noise of a scene is its own from ten degrees of freedom on; with fewer it is that of all. Half of
 * the costs in one scene are 1 and the others e; those of the other scene are all the same. */
static void test_few_repeats_take_the_noise_of_all(void **state)
{
    (void)state;
    enum { QUIET = 20 };
    for (int count = 10; count <= 11; ++count) {
        double costs[11], same[QUIET];
        for (int i = 0; i < QUIET; ++i) {
            same[i] = 1;
        }
        for (int i = 0; i < count; ++i) {
            costs[i] = i < count / 2 ? 1 : exp(1);
        }
        json_t *results = json_array();
        add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-2}, costs, count);
        add_repeats(results, (sweep_run){.scenario = "b", "plumb:p", .error = 1e-2}, same, QUIET);
        pl_sweep_analysis analysis = analysis_of(results);
        const double half = count / 2;
        const double squares = half * (count - half) / count;
        const double freedom = count - 1 + (count < 11 ? QUIET - 1 : 0);
        assert_string_equal(analysis.scenes[0].of->row->scenario, "a");
        assert_close(analysis.scenes[0].noise, sqrt(squares / freedom), 0, 1e-12);
        finish_sweep(&analysis, results);
    }
}

static void test_loss_within_its_interval_is_noise(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-2},
                (const double[]){2, 2, 2, 2, 2, 2, 2, 2, 2, 2}, 10);
    add_repeats(results, (sweep_run){.scenario = "a", "ode:q", .error = 1e-2},
                (const double[]){0.5, 1, 3, 0.5, 1, 3, 0.5, 1, 3, 1}, 10);
    add_repeats(results, (sweep_run){.scenario = "a", "bullet:s", .error = 1e-2},
                (const double[]){1, 1, 1.5, 1, 1, 1.5, 1, 1, 1.5, 1}, 10);
    pl_sweep_analysis analysis = analysis_of(results);
    json_t *losses = losses_of(&analysis);
    assert_int_equal(json_array_size(losses), 4);
    for (int i = 0; i < 4; ++i) {
        const json_t *loss = json_array_get(losses, (size_t)i);
        assert_string_equal(analysis.engines[pl_study_integer(loss, "second")].name,
                            i < 2 ? "bullet" : "ode");
        assert_int_equal(json_is_true(json_object_get(loss, "within_noise")), i >= 2);
    }
    json_decref(losses);
    finish_sweep(&analysis, results);
}

static void test_intervals_do_not_depend_on_a_third_engine(void **state)
{
    (void)state;
    json_t *results = json_array();
    enum { REPEATS = 31 };
    double ours[REPEATS], theirs[REPEATS];
    check_random random = {3};
    for (int i = 0; i < REPEATS; ++i) {
        ours[i] = check_uniform(&random, 1, 2);
        theirs[i] = check_uniform(&random, 2, 4);
    }
    add_repeats(results, (sweep_run){.scenario = "a", "plumb:p", .error = 1e-2}, ours, REPEATS);
    add_repeats(results, (sweep_run){.scenario = "a", "ode:q", .error = 1e-2}, theirs, REPEATS);
    pl_sweep_analysis without = analysis_of(results);
    pl_sweep_ratio before = comparison_with(&without, "ode")->ratios[PL_SPEED + 1];
    finish_sweep(&without, NULL);
    add_repeats(results, (sweep_run){.scenario = "a", "bullet:s", .error = 1e-2}, ours, REPEATS);
    add_repeats(results, (sweep_run){.scenario = "a", "ode:r", .error = 1e-2, .dt = 0.125},
                (const double[]){9, 9.5, 10}, 3);
    pl_sweep_analysis with = analysis_of(results);
    const pl_sweep_ratio *after = &comparison_with(&with, "ode")->ratios[PL_SPEED + 1];
    assert_true(before.low < before.value && before.value < before.high);
    assert_memory_equal(after, &before, sizeof before);
    finish_sweep(&with, results);
}

static void test_geometric_mean_counts_unreached_targets(void **state)
{
    (void)state;
    json_t *results = json_array();
    static const double theirs[] = {4, 9, 1};
    static const char *const names[] = {"a", "b", "c"};
    for (int i = 0; i < 3; ++i) {
        add_sweep_run(results, (sweep_run){.scenario = names[i], "plumb:p", 1, 1e-3});
        add_sweep_run(results,
                      (sweep_run){.scenario = names[i], "ode:q", theirs[i], i < 2 ? 1e-3 : 1e-2});
    }
    add_sweep_run(results, (sweep_run){.scenario = "d", "plumb:p", 1, 1e-3}); /* not run on ode */
    pl_sweep_analysis analysis = analysis_of(results);
    const pl_sweep_pair *pair = &analysis.pairs[pair_named(&analysis, "plumb", "ode")];
    assert_int_equal(pair->scenes, 3);
    assert_close(pair->mean[PL_SWEEP_MATCHED_LEVEL].value, 6, 0, 1e-14);
    assert_int_equal(pair->reached[PL_ATTAINED_BY_BOTH][PL_SWEEP_MATCHED_LEVEL], 2);
    assert_int_equal(pair->reached[PL_ATTAINED_BY_FIRST_ONLY][PL_SWEEP_MATCHED_LEVEL], 1);
    assert_int_equal(pair->reached[PL_ATTAINED_BY_SECOND_ONLY][PL_SWEEP_MATCHED_LEVEL], 0);
    assert_close(pair->mean[1].value, cbrt(36), 0, 1e-14);
    assert_true(isnan(pair->mean[3].value));
    finish_sweep(&analysis, results);
}

static void test_profile_by_hand(void **state)
{
    (void)state;
    static const struct {
        const char *scene;
        double ours, theirs; /* costs to 1e-3; 0: not reached */
    } cases[] = {{"a", 1, 2}, {"b", 3, 1}, {"c", 5, 0}, {"d", 0, 0}};
    json_t *results = json_array();
    for (int i = 0; i < 4; ++i) {
        add_sweep_run(results, (sweep_run){.scenario = cases[i].scene,
                                           "plumb:p",
                                           fmax(cases[i].ours, 1),
                                           cases[i].ours > 0 ? 1e-3 : 1});
        add_sweep_run(results, (sweep_run){.scenario = cases[i].scene,
                                           "ode:q",
                                           fmax(cases[i].theirs, 1),
                                           cases[i].theirs > 0 ? 1e-3 : 1});
    }
    add_sweep_run(results, (sweep_run){.scenario = "e", "plumb:p", 1, 1e-3}); /* not run on ode */
    pl_sweep_analysis analysis = analysis_of(results);
    json_t *json = pl_sweep_to_json(&analysis);
    const json_t *profile =
        json_array_get(json_object_get(json, "profiles"), PL_SWEEP_MATCHED_LEVEL);
    static const char *const names[] = {"plumb", "ode"};
    static const double ratios[2][3] = {{1, 1, 3}, {1, 2}}; /* c: ours alone, d: neither */
    assert_true(json_is_true(json_object_get(profile, "all_profiles")));
    assert_int_equal(json_integer_value(json_object_get(profile, "scenes")), 4);
    for (size_t i = 0; i < 2; ++i) {
        const json_t *engine = json_array_get(json_object_get(profile, "engines"), i);
        const json_t *found = json_object_get(engine, "ratios");
        assert_int_equal(json_integer_value(json_object_get(engine, "engine")),
                         engine_named(&analysis, names[i]));
        assert_int_equal(json_array_size(found), 3 - i);
        for (size_t k = 0; k < 3 - i; ++k) {
            assert_close(json_number_value(json_array_get(found, k)), ratios[i][k], 0, 0);
        }
    }
    json_decref(json);
    finish_sweep(&analysis, results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_speed_ratio_is_cost_at_each_error),
        cmocka_unit_test(test_error_ratio_is_taken_at_each_cost),
        cmocka_unit_test(test_losses_are_where_another_front_is_ahead),
        cmocka_unit_test(test_equal_engines_have_no_losses),
        cmocka_unit_test(test_constant_repeats_have_an_interval_without_width),
        cmocka_unit_test(test_interval_is_that_of_resampled_medians),
        cmocka_unit_test(test_intervals_of_few_repeats_hold_the_true_ratio),
        cmocka_unit_test(test_few_repeats_take_the_noise_of_all),
        cmocka_unit_test(test_loss_within_its_interval_is_noise),
        cmocka_unit_test(test_intervals_do_not_depend_on_a_third_engine),
        cmocka_unit_test(test_geometric_mean_counts_unreached_targets),
        cmocka_unit_test(test_profile_by_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
