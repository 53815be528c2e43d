/* The runs that a sweep repeats, and the parameters that it varies by default. */
#include "check.h"
#include "studies/sweep/pruning.h"
#include "studies/sweep/vary.h"

#include <stdlib.h>

/* free-fall and projectile on two profiles: three repeats. */
static void make_plan(pl_plan *plan)
{
    *plan = (pl_plan){.repeats = 3};
    const char *const names[] = {"free-fall", "projectile"};
    for (int i = 0; i < 2; ++i) {
        const pl_scenario *scenario = pl_scenario_find(names[i], NULL);
        assert_int_equal(pl_plan_add_scenario(plan, scenario, NULL, 0, NULL), PL_OK);
    }
    assert_int_equal(pl_plan_add_engine(plan, "plumb:accurate", NULL), PL_OK);
    assert_int_equal(pl_plan_add_engine(plan, "plumb:fast", NULL), PL_OK);
}

/* The run's hash; the caller decrefs the identity. */
static const char *hash_of(const pl_plan *plan, long index, json_t **identity)
{
    const pl_planned_run run = pl_plan_run(plan, index);
    *identity = pl_planned_run_identity(plan, &run);
    return pl_json_get_text(*identity, "run");
}

static void see(pl_repeats *repeats, const pl_plan *plan, long index, const char *outcome,
                double step, int steps)
{
    json_t *identity;
    const char *run = hash_of(plan, index, &identity);
    json_t *result = json_pack("{s:s, s:s, s:{s:{s:f}}, s:{s:i}}", "run", run, "outcome", outcome,
                               "metrics", "time_per_step", "value", step, "steps", "done", steps);
    assert_non_null(result);
    pl_repeats_see(repeats, result);
    json_decref(result);
    json_decref(identity);
}

static void test_only_short_runs_are_repeated(void **state)
{
    (void)state;
    pl_plan plan;
    pl_repeats repeats;
    make_plan(&plan);
    assert_int_equal(pl_repeats_begin(&repeats, &plan, 2, NULL), PL_OK);
    /* The first run of each point: 1 s, 3 s, a timeout, and one that crashed at once. */
    see(&repeats, &plan, 0, "ok", 0.01, 100);
    see(&repeats, &plan, 1, "ok", 0.03, 100);
    see(&repeats, &plan, 2, "timeout", 0, 0);
    see(&repeats, &plan, 3, "crashed", 0, 0);
    const pl_planned_run first[] = {pl_plan_run(&plan, 0), pl_plan_run(&plan, 1),
                                    pl_plan_run(&plan, 2), pl_plan_run(&plan, 3)};
    const bool is_long[] = {false, true, true, false};
    int spared = 0;
    for (long i = 0; i < pl_plan_size(&plan); ++i) {
        const pl_planned_run run = pl_plan_run(&plan, i);
        json_t *identity;
        const char *hash = hash_of(&plan, i, &identity);
        bool expected = false;
        for (int k = 0; k < 4; ++k) {
            expected |= is_long[k] && run.repeat > 0 && run.test_case == first[k].test_case &&
                        run.configuration == first[k].configuration;
        }
        assert_int_equal(pl_repeats_spare(&repeats, hash), expected);
        spared += expected;
        json_decref(identity);
    }
    assert_int_equal(spared, 4);
    assert_false(pl_repeats_spare(&repeats, "no such run"));
    pl_repeats_free(&repeats);
    pl_plan_free(&plan);
}

static void test_results_of_other_sweeps_say_nothing(void **state)
{
    (void)state;
    pl_plan plan;
    pl_repeats repeats;
    make_plan(&plan);
    assert_int_equal(pl_repeats_begin(&repeats, &plan, 2, NULL), PL_OK);
    json_t *strange = json_pack("{s:s, s:s}", "run", "0123", "outcome", "timeout");
    pl_repeats_see(&repeats, strange);
    json_decref(strange);
    for (long i = 0; i < pl_plan_size(&plan); ++i) {
        json_t *identity;
        assert_false(pl_repeats_spare(&repeats, hash_of(&plan, i, &identity)));
        json_decref(identity);
    }
    pl_repeats_free(&repeats);
    pl_plan_free(&plan);
}

static void test_steps_are_halved_and_default_budgets_varied(void **state)
{
    (void)state;
    pl_plan plan;
    pl_vary *varied;
    int count;
    make_plan(&plan);
    assert_int_equal(pl_default_vary(&plan, &varied, &count, NULL), PL_OK);
    assert_int_equal(count, 1); /* plumb's budget bounds nothing */
    assert_string_equal(varied[0].key, "dt");
    assert_int_equal(varied[0].count, 5);
    for (int i = 0; i < 5; ++i) {
        bool there = false;
        for (int k = 0; k < 5; ++k) {
            there |= varied[0].numbers[k] == 1.0 / (60 << i);
        }
        assert_true(there);
    }
    pl_vary_free(&varied[0]);
    free(varied);
    pl_error error;
    if (pl_plan_add_engine(&plan, "ode:quick", &error) == PL_OK &&
        pl_plan_add_engine(&plan, "ode:dantzig", &error) == PL_OK) {
        assert_int_equal(pl_default_vary(&plan, &varied, &count, NULL), PL_OK);
        assert_int_equal(count, 2);
        assert_string_equal(varied[1].owner, "ode");
        assert_string_equal(varied[1].key, "iterations");
        assert_int_equal(varied[1].count, 2);
        assert_close(varied[1].numbers[0], 20, 0, 0);
        assert_close(varied[1].numbers[1], 100, 0, 0);
        for (int i = 0; i < count; ++i) {
            pl_vary_free(&varied[i]);
        }
        free(varied);
    }
    pl_plan_free(&plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_only_short_runs_are_repeated),
        cmocka_unit_test(test_results_of_other_sweeps_say_nothing),
        cmocka_unit_test(test_steps_are_halved_and_default_budgets_varied),
    };
    return cmocka_run_group_tests_name("sweep_repeats", tests, NULL, NULL);
}
