/* The grid of a sweep: its points, their order, and what shards get of it. */
#include "check.h"
#include "plumb_process.h"
#include "studies/sweep/grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_VARIED = 6 };

/* A grid as a user asks for it. */
typedef struct asked {
    const char *scenarios[4], *settings[4], *engines[4], *varied[MOST_VARIED];
    int repeats;
    pl_shard shard; /* of zeros: the only one */
} asked;

static pl_status make_grid(const asked *a, pl_plan *plan, pl_error *error)
{
    pl_plan base = {.repeats = a->repeats == 0 ? 1 : a->repeats, .seed = 3};
    pl_vary varied[MOST_VARIED];
    int count = 0;
    for (int i = 0; i < 4 && a->scenarios[i] != NULL; ++i) {
        const pl_scenario *scenario = pl_scenario_find(a->scenarios[i], NULL);
        assert_non_null(scenario);
        assert_int_equal(
            pl_plan_add_scenario(&base, scenario, &a->settings[i], a->settings[i] != NULL, NULL),
            PL_OK);
    }
    for (int i = 0; i < 4 && a->engines[i] != NULL; ++i) {
        assert_int_equal(pl_plan_add_engine(&base, a->engines[i], NULL), PL_OK);
    }
    for (; count < MOST_VARIED && a->varied[count] != NULL; ++count) {
        assert_int_equal(pl_vary_parse(a->varied[count], PL_VARY_VALUES, &varied[count], NULL),
                         PL_OK);
    }
    const pl_grid_def def = {.base = &base,
                             .varied = varied,
                             .varied_count = count,
                             .shard = a->shard.count == 0 ? (pl_shard){0, 1} : a->shard};
    *plan = (pl_plan){.repeats = 1};
    pl_status status = pl_grid_plan(&def, plan, error);
    for (int i = 0; i < count; ++i) {
        pl_vary_free(&varied[i]);
    }
    pl_plan_free(&base);
    return status;
}

static pl_plan grid(const asked *a)
{
    pl_plan plan;
    pl_error error = {.message = ""};
    if (make_grid(a, &plan, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return plan;
}

/* "dt^-1 label repeat" of every run, a line each; malloc'd. */
static char *list_runs(const pl_plan *plan)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    for (long i = 0; i < pl_plan_size(plan); ++i) {
        pl_planned_run run = pl_plan_run(plan, i);
        fprintf(stream, "%.6g %s %d\n", 1 / run.test_case->scene.dt, run.configuration->label,
                run.repeat);
    }
    fclose(stream);
    return text;
}

static void check_runs(const asked *a, const char *expected)
{
    pl_plan plan = grid(a);
    char *runs = list_runs(&plan);
    assert_string_equal(runs, expected);
    free(runs);
    pl_plan_free(&plan);
}

static void test_repeats_are_outermost_and_engines_take_turns(void **state)
{
    (void)state;
    check_runs(&(asked){.scenarios = {"free-fall"},
                        .engines = {"plumb:fast", "plumb:accurate"},
                        .varied = {"dt=1/60,1/240", "iterations=1,2"},
                        .repeats = 2},
               "60 plumb:fast,iterations=1 0\n60 plumb:accurate,iterations=1 0\n"
               "60 plumb:fast,iterations=2 0\n60 plumb:accurate,iterations=2 0\n"
               "240 plumb:fast,iterations=1 0\n240 plumb:accurate,iterations=1 0\n"
               "240 plumb:fast,iterations=2 0\n240 plumb:accurate,iterations=2 0\n"
               "60 plumb:accurate,iterations=1 1\n60 plumb:fast,iterations=2 1\n"
               "60 plumb:accurate,iterations=2 1\n60 plumb:fast,iterations=1 1\n"
               "240 plumb:accurate,iterations=1 1\n240 plumb:fast,iterations=2 1\n"
               "240 plumb:accurate,iterations=2 1\n240 plumb:fast,iterations=1 1\n");
}

static void test_the_last_key_varies_fastest(void **state)
{
    (void)state;
    pl_plan plan = grid(&(asked){.scenarios = {"tower"},
                                 .engines = {"plumb"},
                                 .varied = {"n=3,2", "tolerance=1e-4", "friction=0.5,0.25,1"}});
    const double expected[][2] = {{3, 0.5}, {3, 0.25}, {3, 1}, {2, 0.5}, {2, 0.25}, {2, 1}};
    assert_int_equal(plan.case_count, 6);
    for (int i = 0; i < 6; ++i) {
        assert_true(plan.cases[i].params[0] == expected[i][0]);
        assert_true(plan.cases[i].params[1] == expected[i][1]);
    }
    assert_int_equal(plan.configuration_count, 1);
    assert_string_equal(plan.configurations[0].label, "plumb:default,tolerance=0.0001");
    pl_plan_free(&plan);
}

static void test_missing_key_is_not_varied(void **state)
{
    (void)state;
    check_runs(&(asked){.scenarios = {"free-fall"},
                        .engines = {"plumb", FAULTY ":good"},
                        .varied = {"iterations=1..3"}},
               "60 plumb:default,iterations=1 0\n60 faulty:good 0\n"
               "60 plumb:default,iterations=2 0\n60 plumb:default,iterations=3 0\n");
    pl_plan plan = grid(&(asked){
        .scenarios = {"tower", "slope-slide"}, .engines = {"plumb"}, .varied = {"n=1..3"}});
    assert_int_equal(plan.case_count, 4);
    pl_plan_free(&plan);
}

static void test_profiles_are_those_that_the_engine_has(void **state)
{
    (void)state;
    check_runs(&(asked){.scenarios = {"free-fall"},
                        .engines = {"plumb:accurate", FAULTY ":good"},
                        .varied = {"solver=fast,nan,default"}},
               "60 plumb:fast 0\n60 faulty:nan 0\n60 plumb:default 0\n");
}

static void test_requested_option_stays_when_the_profile_changes(void **state)
{
    (void)state;
    check_runs(&(asked){.scenarios = {"free-fall"},
                        .engines = {"plumb:accurate,tolerance=1e-4"},
                        .varied = {"profile=accurate,fast"}},
               "60 plumb:accurate,tolerance=0.0001 0\n60 plumb:fast,tolerance=0.0001 0\n");
}

static void test_a_key_of_one_owner_counts_there_instead(void **state)
{
    (void)state;
    check_runs(&(asked){.scenarios = {"free-fall", "projectile"},
                        .engines = {"plumb"},
                        .varied = {"dt=1/60", "free-fall.dt=1/30,1/120"}},
               "30 plumb:default 0\n120 plumb:default 0\n60 plumb:default 0\n");
    check_runs(&(asked){.scenarios = {"free-fall"},
                        .engines = {"plumb", "plumb:fast"},
                        .varied = {"iterations=1", "plumb.iterations=2"}},
               "60 plumb:default,iterations=2 0\n60 plumb:fast,iterations=2 0\n");
}

static void test_equal_points_are_one(void **state)
{
    (void)state;
    pl_plan plan = grid(&(asked){.scenarios = {"tower", "tower"},
                                 .settings = {"n=4", "n=7"},
                                 .engines = {"plumb", "plumb,iterations=5"},
                                 .varied = {"n=1,2", "iterations=5,6"}});
    assert_int_equal(plan.case_count, 2);
    assert_int_equal(plan.configuration_count, 2);
    pl_plan_free(&plan);
}

static void test_parameter_without_effect_is_still_a_point(void **state)
{
    (void)state;
    pl_plan plan = grid(&(asked){.scenarios = {"tower"},
                                 .settings = {"n=1"},
                                 .engines = {"plumb"},
                                 .varied = {"top_mass=1,2", "rising_mass=1,2"}});
    assert_int_equal(plan.case_count, 4);
    pl_plan_free(&plan);
}

static void run_hash(const pl_plan *plan, long index, char hash[17])
{
    pl_planned_run run = pl_plan_run(plan, index);
    json_t *identity = pl_planned_run_identity(plan, &run);
    snprintf(hash, 17, "%s", result_text(identity, "run"));
    json_decref(identity);
}

static void test_a_point_is_the_run_that_compare_makes(void **state)
{
    (void)state;
    const char *settings[] = {"n=4", "dt=1/120"};
    char hash[17], other[17];
    pl_plan plain = {.repeats = 1, .seed = 3};
    pl_plan plan = grid(&(asked){.scenarios = {"tower"},
                                 .engines = {"plumb:fast"},
                                 .varied = {"n=4", "dt=1/120", "iterations=7"}});
    assert_int_equal(
        pl_plan_add_scenario(&plain, pl_scenario_find("tower", NULL), settings, 2, NULL), PL_OK);
    assert_int_equal(pl_plan_add_engine(&plain, "plumb:fast,iterations=7", NULL), PL_OK);
    run_hash(&plan, 0, hash);
    run_hash(&plain, 0, other);
    assert_string_equal(hash, other);
    pl_plan_free(&plain);
    pl_plan_free(&plan);
}

static void test_deferred_scene_is_built_as_hashed(void **state)
{
    (void)state;
    pl_plan plan = grid(&(asked){.scenarios = {"pile", "tower"},
                                 .settings = {"n=5"},
                                 .engines = {"plumb"},
                                 .varied = {"dt=1/60,1/240"}});
    for (int i = 0; i < plan.case_count; ++i) {
        pl_scene scene;
        char hash[17];
        assert_true(plan.cases[i].deferred);
        assert_int_equal(plan.cases[i].scene.body_count, 0);
        assert_int_equal(pl_plan_build_scene(&plan, &plan.cases[i], &scene, NULL), PL_OK);
        assert_int_equal(pl_scene_hash(&scene, hash, NULL), PL_OK);
        assert_string_equal(hash, plan.cases[i].scene_hash);
        assert_true(scene.dt == plan.cases[i].scene.dt);
        assert_true(scene.duration == plan.cases[i].scene.duration);
        assert_string_equal(scene.primary_error, plan.cases[i].scene.primary_error);
        pl_scene_free(&scene);
    }
    pl_plan_free(&plan);
}

/* All shards of a grid have each of its runs once, and all repeats of a point in one of them. */
static void check_shards(asked a, int count)
{
    a.shard = (pl_shard){0, 1};
    pl_plan whole = grid(&a);
    json_t *owner = json_object();
    long total = 0;
    for (int i = 0; i < count; ++i) {
        a.shard = (pl_shard){i, count};
        pl_plan part = grid(&a);
        total += pl_plan_size(&part);
        for (long k = 0; k < pl_plan_size(&part); ++k) {
            pl_planned_run run = pl_plan_run(&part, k);
            char hash[17], point[PL_LABEL_SIZE + 32];
            run_hash(&part, k, hash);
            assert_null(json_object_get(owner, hash));
            json_object_set_new(owner, hash, json_integer(i));
            snprintf(point, sizeof point, "%s %s", run.test_case->scene_hash,
                     run.configuration->label);
            const json_t *shard = json_object_get(owner, point);
            assert_true(shard == NULL || json_integer_value(shard) == i);
            json_object_set_new(owner, point, json_integer(i));
        }
        pl_plan_free(&part);
    }
    assert_int_equal(total, pl_plan_size(&whole));
    for (long k = 0; k < total; ++k) {
        char hash[17];
        run_hash(&whole, k, hash);
        assert_non_null(json_object_get(owner, hash));
    }
    json_decref(owner);
    pl_plan_free(&whole);
}

static void test_shards_partition_the_runs(void **state)
{
    (void)state;
    const asked a = {.scenarios = {"tower", "free-fall"},
                     .engines = {"plumb", FAULTY ":good", "plumb:fast"},
                     .varied = {"n=1,2", "dt=1/60,1/120", "iterations=1,2,3"},
                     .repeats = 3};
    static const int counts[] = {1, 2, 3, 4, 5, 6, 7, 8, 13, 42, 43, 50};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i) {
        check_shards(a, counts[i]);
    }
}

static void test_engines_take_turns_in_a_shard_too(void **state)
{
    (void)state;
    /* One problem for two shards: each gets two of its four engines. */
    check_runs(&(asked){.scenarios = {"free-fall"},
                        .engines = {"plumb", "plumb:fast"},
                        .varied = {"iterations=1,2"},
                        .repeats = 3,
                        .shard = {1, 2}},
               "60 plumb:default,iterations=2 0\n60 plumb:fast,iterations=2 0\n"
               "60 plumb:fast,iterations=2 1\n60 plumb:default,iterations=2 1\n"
               "60 plumb:default,iterations=2 2\n60 plumb:fast,iterations=2 2\n");
}

static void check_refused(const asked *a, const char *said)
{
    pl_plan plan;
    pl_error error = {.message = ""};
    assert_int_equal(make_grid(a, &plan, &error), PL_BAD_INPUT);
    assert_contains(error.message, said);
    pl_plan_free(&plan);
}

static void test_what_is_wrong_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *varied[2], *said;
    } wrong[] = {
        {{"itertions=1"}, "itertions; did you mean iterations?"},
        {{"frction=1"}, "frction; did you mean friction?"},
        {{"slver=1"}, "slver; did you mean solver?"},
        {{"zzz=1"}, "no chosen scenario has the parameter, and no chosen engine the option, zzz"},
        {{"plum.iterations=1"}, "no chosen engine or scenario plum; did you mean plumb?"},
        {{"towr.n=1"}, "no chosen engine or scenario towr; did you mean tower?"},
        {{"plumb.n=1"}, "plumb has no n"},
        {{"faulty.iterations=1"}, "faulty has no iterations"},
        {{"tower.iterations=1"}, "tower has no iterations"},
        {{"solver=fsat"}, "no chosen engine has the profile fsat; did you mean fast?"},
        {{"plumb.solver=nan"}, "no chosen engine has the profile nan"},
        {{"iterations=0"}, "--vary iterations: plumb takes 1 to "},
        {{"iterations=2.5"}, "--vary iterations: plumb takes an integer, found 2.5"},
        {{"n=2.5"}, "n: expected a whole number"},
        {{"n=0"}, "n: expected 1 to 2000"},
        {{"dt=-1"}, "dt: expected"},
        {{"n=1", "n=2"}, "--vary n is given twice"},
        {{"plumb.iterations=1", "plumb.iterations=2"}, "--vary plumb.iterations is given twice"},
        {{"solver=fast", "profile=fast"}, "--vary profile is given twice"},
        {{"dt=0.001..0.9:+0.00001"}, "89901 cases x 2 engines x 1 repeats are 179802 runs"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        asked a = {.scenarios = {"tower"}, .engines = {"plumb", FAULTY ":good"}};
        memcpy(a.varied, wrong[i].varied, sizeof wrong[i].varied);
        check_refused(&a, wrong[i].said);
    }
}

static void test_too_many_runs_are_counted_over_all_shards(void **state)
{
    (void)state;
    check_refused(&(asked){.scenarios = {"tower"},
                           .engines = {"plumb"},
                           .varied = {"friction=0..1:+0.001", "dt=1/60,1/120"},
                           .repeats = 50,
                           .shard = {0, 1000}},
                  "2002 cases x 1 engines x 50 repeats are 100100 runs; a sweep has at most "
                  "100000");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_repeats_are_outermost_and_engines_take_turns),
        cmocka_unit_test(test_the_last_key_varies_fastest),
        cmocka_unit_test(test_missing_key_is_not_varied),
        cmocka_unit_test(test_profiles_are_those_that_the_engine_has),
        cmocka_unit_test(test_requested_option_stays_when_the_profile_changes),
        cmocka_unit_test(test_a_key_of_one_owner_counts_there_instead),
        cmocka_unit_test(test_equal_points_are_one),
        cmocka_unit_test(test_parameter_without_effect_is_still_a_point),
        cmocka_unit_test(test_a_point_is_the_run_that_compare_makes),
        cmocka_unit_test(test_deferred_scene_is_built_as_hashed),
        cmocka_unit_test(test_shards_partition_the_runs),
        cmocka_unit_test(test_engines_take_turns_in_a_shard_too),
        cmocka_unit_test(test_what_is_wrong_is_said),
        cmocka_unit_test(test_too_many_runs_are_counted_over_all_shards),
    };
    return cmocka_run_group_tests_name("sweep grid", tests, NULL, NULL);
}
