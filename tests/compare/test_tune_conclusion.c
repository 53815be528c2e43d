/* The conclusion of a tuning, on results that are made up. */
#include "check.h"
#include "studies/tune/tune.h"

#include <math.h>

/* Runs of a subject as asked for: its drift, against a target of 1e-3, and its CPU time. */
typedef struct made_up {
    const char *phase;
    int trial;    /* -1: none */
    double value; /* of `iterations`; 0: the default settings */
    double drift, time;
    int repeats;
} made_up;

/* The default settings take 2 µs a step. Trial 1 is the cheapest that meets the target, and trial 2 misses it by 10. */
static const made_up runs[] = {
    {"search", -1, 0, 5e-3, 2e-6, 1},       {"search", 0, 20, 1e-4, 6e-6, 4},
    {"search", 0, 0, 5e-3, 2e-6, 4},        {"search", 1, 10, 5e-4, 4e-6, 4},
    {"search", 1, 0, 5e-3, 2e-6, 4},        {"search", 2, 5, 1e-2, 1e-6, 1},
    {"search", 2, 0, 5e-3, 2e-6, 1},        {"final", -1, 0, 5e-3, 2e-6, 5},
    {"final", 0, 20, 1e-4, 6e-6, 5},        {"final", 1, 10, 5e-4, 5e-6, 5},
    {"sensitivity", 1, 9, 2e-3, 3.6e-6, 4}, {"sensitivity", 1, 11, 4e-4, 4.4e-6, 4},
    {"sensitivity", 1, 10, 5e-4, 4e-6, 4}};

/* The machine becomes slower from repeat to repeat, for all settings. */
static json_t *result_of(const made_up *run, int repeat, const char *target)
{
    const double time = run->time * (1 + repeat);
    json_t *study = json_pack(
        "{s:s, s:s, s:n, s:[s], s:[s], s:i, s:[s], s:[{s:s, s:f, s:f}], s:i, s:s, s:o, s:o, s:i, "
        "s:s, s:s, s:[s]}",
        "name", "tune", "engine", "some:fast", "dt", "scenarios", "tower", "scenes", "0123", "seed",
        7, "targets", target, "parameters", "key", "iterations", "low", 1.0, "high", 100.0,
        "budget", 3, "phase", run->phase, "trial",
        run->trial < 0 ? json_null() : json_integer(run->trial), "values",
        run->value > 0 ? json_pack("[f]", run->value) : json_null(), "case", 0, "variant",
        "as asked for", "spec", "some:fast,iterations=10", "api", "set(10);");
    return json_pack("{s:s, s:s, s:s, s:i, s:o, s:{s:f, s:f, s:f}, s:{s:{s:f}, s:{s:f}}}",
                     "outcome", "ok", "engine", "some", "profile", "fast", "repeat", repeat,
                     "study", study, "settings", "dt", 0.01, "duration", 1.0, "iterations",
                     run->value, "metrics", "drift", "value", run->drift, "time_per_step", "value",
                     time);
}

static json_t *all_results(bool backwards)
{
    json_t *results = json_array();
    for (size_t i = 0; i < sizeof runs / sizeof runs[0]; ++i) {
        for (int k = 0; k < runs[i].repeats; ++k) {
            json_array_insert_new(results, backwards ? 0 : json_array_size(results),
                                  result_of(&runs[i], k, "drift<=0.001"));
        }
    }
    return results;
}

static json_t *conclude(bool backwards)
{
    json_t *results = all_results(backwards), *conclusion = NULL;
    pl_error error = {.message = ""};
    if (pl_tune_study.conclude(results, ".", &conclusion, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    json_decref(results);
    return conclusion;
}

static double number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

static void check_trial(const json_t *conclusion, size_t index, double cost, double excess)
{
    const json_t *trial = json_array_get(json_object_get(conclusion, "trials"), index);
    assert_close(number(trial, "cost"), cost, 1e-12, 0);
    assert_close(number(trial, "excess"), excess, 1e-12, 0);
}

static void test_the_cheapest_that_meets_the_target_is_chosen(void **state)
{
    (void)state;
    json_t *found = conclude(false);
    const json_t *setting = json_object_get(found, "setting");
    assert_true(json_is_true(json_object_get(found, "met")));
    assert_true(json_is_false(json_object_get(found, "validated"))); /* nothing was held out */
    assert_close(number(found, "cost"), 2.5, 1e-12, 0);
    assert_close(number(found, "excess"), log(0.5), 1e-12, 0);
    assert_true(number(json_object_get(setting, "options"), "iterations") == 10);
    assert_true(number(setting, "dt") == 0.01);
    assert_int_equal(json_array_size(json_object_get(found, "trials")), 3);
    check_trial(found, 0, 3, log(0.1));
    check_trial(found, 1, 2, log(0.5));
    check_trial(found, 2, 0.5, log(10));
    json_decref(found);
}

static void test_sensitivities_are_of_the_settings_near_the_answer(void **state)
{
    (void)state;
    json_t *found = conclude(false);
    const json_t *moved = json_object_get(found, "sensitivity");
    assert_int_equal(json_array_size(moved), 2);
    const json_t *down = json_array_get(moved, 0), *up = json_array_get(moved, 1);
    assert_true(number(down, "from") == 10 && number(down, "to") == 9 && number(up, "to") == 11);
    assert_close(number(down, "cost_ratio"), 0.9, 1e-12, 0);
    assert_close(number(down, "excess"), log(2), 1e-12, 0);
    assert_close(number(up, "cost_ratio"), 1.1, 1e-12, 0);
    json_decref(found);
}

static void test_the_order_of_results_does_not_matter(void **state)
{
    (void)state;
    json_t *found = conclude(false), *other = conclude(true);
    assert_true(json_equal(found, other));
    json_decref(found);
    json_decref(other);
}

/* Whether the conclusion from the first `count` results is finished. */
static bool is_finished(size_t count)
{
    json_t *results = all_results(false), *conclusion = NULL;
    while (json_array_size(results) > count) {
        json_array_remove(results, json_array_size(results) - 1);
    }
    assert_int_equal(pl_tune_study.conclude(results, ".", &conclusion, NULL), PL_OK);
    const bool finished = json_is_true(json_object_get(conclusion, "finished"));
    json_decref(results);
    json_decref(conclusion);
    return finished;
}

static void test_a_tuning_that_lacks_runs_is_unfinished(void **state)
{
    (void)state;
    json_t *results = all_results(false);
    const size_t all = json_array_size(results);
    json_decref(results);
    assert_true(is_finished(all));
    for (size_t count = 1 + 4; count < all; ++count) {
        assert_false(is_finished(count));
    }
}

static void check_refused(json_t *results, const char *part)
{
    json_t *conclusion = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_tune_study.conclude(results, ".", &conclusion, &error), PL_BAD_INPUT);
    assert_contains(error.message, part);
    json_decref(results);
}

static void test_results_that_do_not_belong_together_are_refused(void **state)
{
    (void)state;
    json_t *mixed = all_results(false);
    json_array_append_new(mixed, result_of(&runs[0], 0, "drift<=0.002"));
    check_refused(mixed, "of another tuning than");
    json_t *odd = all_results(false);
    json_object_set_new(json_object_get(json_array_get(odd, 1), "study"), "trial",
                        json_integer(1000000000));
    check_refused(odd, "results[1].study: expected a run of a tuning");
    check_refused(json_pack("[{s:{s:s}}]", "study", "name", "tune"), "expected scenarios");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_cheapest_that_meets_the_target_is_chosen),
        cmocka_unit_test(test_sensitivities_are_of_the_settings_near_the_answer),
        cmocka_unit_test(test_the_order_of_results_does_not_matter),
        cmocka_unit_test(test_a_tuning_that_lacks_runs_is_unfinished),
        cmocka_unit_test(test_results_that_do_not_belong_together_are_refused),
    };
    return cmocka_run_group_tests_name("tune conclusion", tests, NULL, NULL);
}
