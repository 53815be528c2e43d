/* The runs that a sweep repeats, and those that it makes on changed scenes. */
#include "check.h"
#include "studies/sweep/grid.h"
#include "studies/sweep/pruning.h"
#include "studies/variant.h"

#include <string.h>

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

static void see(pl_pruning *repeats, const pl_plan *plan, long index, const char *outcome,
                double step, int steps)
{
    json_t *identity;
    const char *run = hash_of(plan, index, &identity);
    json_t *result = json_pack("{s:s, s:s, s:{s:{s:f}}, s:{s:i}}", "run", run, "outcome", outcome,
                               "metrics", "time_per_step", "value", step, "steps", "done", steps);
    assert_non_null(result);
    pl_pruning_see(repeats, result);
    json_decref(result);
    json_decref(identity);
}

static void test_only_short_runs_are_repeated(void **state)
{
    (void)state;
    pl_plan plan;
    pl_pruning repeats;
    make_plan(&plan);
    pl_pruning_begin(&repeats, &plan, 2);
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
        assert_int_equal(pl_pruning_spares(&repeats, hash), expected);
        spared += expected;
        json_decref(identity);
    }
    assert_int_equal(spared, 4);
    assert_false(pl_pruning_spares(&repeats, "no such run"));
    pl_pruning_free(&repeats);
    pl_plan_free(&plan);
}

static void test_results_of_other_sweeps_say_nothing(void **state)
{
    (void)state;
    pl_plan plan;
    pl_pruning repeats;
    make_plan(&plan);
    pl_pruning_begin(&repeats, &plan, 2);
    json_t *strange = json_pack("{s:s, s:s}", "run", "0123", "outcome", "timeout");
    pl_pruning_see(&repeats, strange);
    json_decref(strange);
    for (long i = 0; i < pl_plan_size(&plan); ++i) {
        json_t *identity;
        assert_false(pl_pruning_spares(&repeats, hash_of(&plan, i, &identity)));
        json_decref(identity);
    }
    pl_pruning_free(&repeats);
    pl_plan_free(&plan);
}

/* free-fall, unchanged and changed, on plumb with two repeats: three runs. */
static void make_plan_with_change(pl_plan *plan)
{
    const pl_scenario *scenario = pl_scenario_find("free-fall", NULL);
    *plan = (pl_plan){.repeats = 2};
    assert_int_equal(pl_plan_add_scenario(plan, scenario, NULL, 0, NULL), PL_OK);
    memcpy(plan->variation.changed, plan->cases[0].params, sizeof plan->cases[0].params);
    assert_true(
        pl_variant_apply(&pl_variants_swept.items[2], scenario, 0, plan->variation.changed));
    plan->variation.change = pl_variants_swept.items[2].name;
    assert_int_equal(pl_plan_add_scenario(plan, scenario, NULL, 0, NULL), PL_OK);
    assert_int_equal(pl_plan_add_engine(plan, "plumb:fast", NULL), PL_OK);
    pl_plan_add_pairing(plan, 0, 0);
    pl_plan_add_pairing(plan, 1, 0);
    plan->repeated_count = 1;
}

static void test_changed_scenes_are_not_repeated(void **state)
{
    (void)state;
    pl_plan plan;
    make_plan_with_change(&plan);
    const int cases[] = {0, 1, 0}, repeats[] = {0, 0, 1};
    assert_int_equal(pl_plan_size(&plan), 3);
    for (int i = 0; i < 3; ++i) {
        const pl_planned_run run = pl_plan_run(&plan, i);
        assert_ptr_equal(run.test_case, &plan.cases[cases[i]]);
        assert_int_equal(run.repeat, repeats[i]);
        json_t *identity;
        hash_of(&plan, i, &identity);
        assert_string_equal(pl_json_get_text(identity, "change"),
                            cases[i] == 0 ? "" : "parameters within 1 %, draw 1");
        json_decref(identity);
    }
    /* The results have the parameters of the scene itself, so that they are of one point. */
    assert_string_not_equal(plan.cases[0].scene_hash, plan.cases[1].scene_hash);
    assert_memory_equal(plan.cases[0].params, plan.cases[1].params, sizeof plan.cases[0].params);
    pl_plan_free(&plan);
}

static void test_changes_of_a_failed_point_are_spared(void **state)
{
    (void)state;
    static const char *const outcomes[] = {"ok", "collapsed", "timeout"};
    for (int i = 0; i < 3; ++i) {
        pl_plan plan;
        pl_pruning repeats;
        json_t *changed;
        make_plan_with_change(&plan);
        pl_pruning_begin(&repeats, &plan, 2);
        const char *hash = hash_of(&plan, 1, &changed);
        assert_false(pl_pruning_spares(&repeats, hash));
        see(&repeats, &plan, 0, outcomes[i], 0.01, 100);
        assert_int_equal(pl_pruning_spares(&repeats, hash), i > 0);
        json_decref(changed);
        pl_pruning_free(&repeats);
        pl_plan_free(&plan);
    }
}

static void test_a_failed_change_spares_no_repeat(void **state)
{
    (void)state;
    pl_plan plan;
    pl_pruning repeats;
    json_t *again;
    make_plan_with_change(&plan);
    pl_pruning_begin(&repeats, &plan, 2);
    see(&repeats, &plan, 0, "ok", 0.01, 100);
    see(&repeats, &plan, 1, "timeout", 1, 100);
    assert_false(pl_pruning_spares(&repeats, hash_of(&plan, 2, &again)));
    json_decref(again);
    pl_pruning_free(&repeats);
    pl_plan_free(&plan);
}

static void test_steps_of_the_usual_sweep_are_halved(void **state)
{
    (void)state;
    pl_vary steps;
    assert_int_equal(pl_vary_parse(PL_SWEEP_STEPS, PL_VARY_VALUES, &steps, NULL), PL_OK);
    assert_string_equal(steps.key, "dt");
    assert_int_equal(steps.count, 5);
    for (int i = 0; i < 5; ++i) {
        assert_true(steps.numbers[i] == 1.0 / (60 << i));
    }
    pl_vary_free(&steps);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_only_short_runs_are_repeated),
        cmocka_unit_test(test_results_of_other_sweeps_say_nothing),
        cmocka_unit_test(test_changed_scenes_are_not_repeated),
        cmocka_unit_test(test_changes_of_a_failed_point_are_spared),
        cmocka_unit_test(test_a_failed_change_spares_no_repeat),
        cmocka_unit_test(test_steps_of_the_usual_sweep_are_halved),
    };
    return cmocka_run_group_tests_name("sweep_repeats", tests, NULL, NULL);
}
