/* What a sweep does not run because it ran into the time limit at a longer time step. */
#include "check.h"
#include "results/result.h"
#include "studies/sweep/pruning.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PROBLEMS = 4, ENGINES = 2, REPEATS = 2 };

/* A projectile at three steps, and one with another speed; on two profiles, twice. */
static void make_plan(pl_plan *plan)
{
    const char *const steps[] = {"dt=1/60", "dt=1/120", "dt=1/240"};
    const char *const other[] = {"dt=1/240", "speed=5"};
    const pl_scenario *scenario = pl_scenario_find("projectile", NULL);
    *plan = (pl_plan){.repeats = REPEATS};
    for (int i = 0; i < 3; ++i) {
        assert_int_equal(pl_plan_add_scenario(plan, scenario, &steps[i], 1, NULL), PL_OK);
    }
    assert_int_equal(pl_plan_add_scenario(plan, scenario, other, 2, NULL), PL_OK);
    assert_int_equal(pl_plan_add_engine(plan, "plumb:accurate", NULL), PL_OK);
    assert_int_equal(pl_plan_add_engine(plan, "plumb:fast", NULL), PL_OK);
}

typedef struct kept {
    json_t *results;
    int fail_at;
} kept;

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    kept *k = user;
    json_array_append(k->results, result);
    return (int)json_array_size(k->results) == k->fail_at ? pl_fail(error, PL_IO, "disk full")
                                                          : PL_OK;
}

/* The results that pruning adds after the first engine's run at `step` ended with `outcome`. */
static kept after(const pl_plan *plan, double step, const char *outcome, int fail_at,
                  pl_status expected)
{
    kept k = {.results = json_array(), .fail_at = fail_at};
    json_t *provenance = json_pack("{s:s}", "command", "test");
    pl_pruning pruning;
    pl_pruning_begin(&pruning, plan, 1);
    for (long i = 0; i < pl_plan_size(plan); ++i) {
        const pl_planned_run run = pl_plan_run(plan, i);
        if (run.test_case == &plan->cases[0] + (step < 1.0 / 90) + (step < 1.0 / 180) &&
            run.configuration == &plan->configurations[0] && run.repeat == 0) {
            json_t *result = pl_planned_run_identity(plan, &run);
            json_object_set_new(result, "outcome", json_string(outcome));
            json_object_set_new(result, "reason", json_string("no end within 15 s"));
            json_object_set_new(result, "steps", json_pack("{s:i, s:i}", "asked", 60, "done", 3));
            assert_int_equal(pl_prune_timeouts(&pruning, result, provenance, &k, keep, NULL),
                             expected);
            json_decref(result);
        }
    }
    json_decref(provenance);
    pl_pruning_free(&pruning);
    return k;
}

static void test_shorter_steps_after_a_timeout_are_pruned(void **state)
{
    pl_plan plan;
    (void)state;
    make_plan(&plan);
    kept k = after(&plan, 1.0 / 60, "timeout", 0, PL_OK);
    assert_int_equal(json_array_size(k.results), 2);
    for (int i = 0; i < 2; ++i) {
        const json_t *result = json_array_get(k.results, (size_t)i);
        const json_t *settings = json_object_get(result, "settings");
        const json_t *params = json_object_get(result, "params");
        const json_t *steps = json_object_get(result, "steps");
        const double dt = json_number_value(json_object_get(settings, "dt"));
        assert_string_equal(pl_json_get_text(result, "outcome"), "timeout");
        assert_string_equal(pl_json_get_text(result, "label"), "plumb:accurate");
        assert_string_equal(pl_json_get_text(result, "reason"),
                            "not run: at a time step of 1/60 s, no end within 15 s");
        assert_at_most(fabs(dt - (i == 0 ? 1.0 / 120 : 1.0 / 240)), 1e-15);
        assert_true(json_number_value(json_object_get(params, "speed")) != 5);
        assert_int_equal(json_integer_value(json_object_get(steps, "asked")), i == 0 ? 120 : 240);
        assert_int_equal(json_integer_value(json_object_get(steps, "done")), 0);
        assert_int_equal(json_integer_value(json_object_get(result, "repeat")), 0);
    }
    json_decref(k.results);
    pl_plan_free(&plan);
}

static void test_longer_steps_and_other_ends_say_nothing(void **state)
{
    pl_plan plan;
    (void)state;
    make_plan(&plan);
    const char *const outcomes[] = {"ok", "collapsed", "crashed", "unsupported"};
    for (int i = 0; i < 4; ++i) {
        kept k = after(&plan, 1.0 / 60, outcomes[i], 0, PL_OK);
        assert_int_equal(json_array_size(k.results), 0);
        json_decref(k.results);
    }
    kept k = after(&plan, 1.0 / 240, "timeout", 0, PL_OK);
    assert_int_equal(json_array_size(k.results), 0);
    json_decref(k.results);
    pl_plan_free(&plan);
}

static void test_a_result_that_cannot_be_kept_ends_it(void **state)
{
    pl_plan plan;
    (void)state;
    make_plan(&plan);
    kept k = after(&plan, 1.0 / 60, "timeout", 1, PL_IO);
    assert_int_equal(json_array_size(k.results), 1);
    json_decref(k.results);
    pl_plan_free(&plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shorter_steps_after_a_timeout_are_pruned),
        cmocka_unit_test(test_longer_steps_and_other_ends_say_nothing),
        cmocka_unit_test(test_a_result_that_cannot_be_kept_ends_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
