/* The settings that the usual sweep draws of each engine. */
#include "check.h"
#include "studies/sweep/design.h"
#include "studies/variant/tunable.h"
#include "studies/variant/variant.h"

#include <math.h>
#include <string.h>

enum { SETTINGS = 24 };

static const double steps[] = {1.0 / 60, 1.0 / 120, 1.0 / 240};

/* The options of a made-up engine: by ratio, straight, whole by ratio, a switch, and one that no
 * profile is tuned by. */
static const pl_engine_option options[] = {
    {.name = "a",
     .value = 1,
     .max = 1e3,
     .tune_profiles = 3,
     .tune_min = 1e-6,
     .tune_max = 1e2,
     .tune_logarithmic = true},
    {.name = "b", .value = 0.2, .max = 1, .tune_profiles = 3, .tune_min = 0.05, .tune_max = 1},
    {.name = "c",
     .value = 10,
     .max = 1e6,
     .integer = true,
     .tune_profiles = 1,
     .tune_min = 1,
     .tune_max = 300,
     .tune_logarithmic = true},
    {.name = "d", .value = 0, .max = 1, .integer = true, .tune_profiles = 3, .tune_max = 1},
    {.name = "e", .value = 7, .max = 9}};
enum { A, B, C, D, E, OPTIONS };
static const pl_engine_profile profiles[] = {{.name = "first"}, {.name = "second"}};
static const double defaults[] = {1, 0.2, 10, 0, 7, 1, 0.2, 10, 0, 8};
static const pl_engine_info engines[] = {{.name = "some",
                                          .profiles = profiles,
                                          .profile_count = 2,
                                          .options = options,
                                          .option_count = OPTIONS,
                                          .defaults = defaults},
                                         {.name = "other",
                                          .profiles = profiles,
                                          .profile_count = 2,
                                          .options = options,
                                          .option_count = OPTIONS,
                                          .defaults = defaults}};

static pl_configuration configuration(int engine, int profile)
{
    pl_configuration made = {.choice = {.engine = &engines[engine], .profile = profile}};
    memcpy(made.choice.values, defaults + profile * OPTIONS, OPTIONS * sizeof *defaults);
    return made;
}

/* The design of `count` configurations with all their engines' profiles, or those given alone. */
static pl_design design_of(pl_configuration *configurations, int count, bool all_profiles)
{
    const pl_plan plan = {.configurations = configurations, .configuration_count = count};
    const pl_design_def def = {.plan = &plan,
                               .steps = steps,
                               .step_count = 3,
                               .settings = SETTINGS,
                               .all_profiles = all_profiles};
    pl_design design;
    assert_int_equal(pl_design_make(&def, &design, NULL), PL_OK);
    return design;
}

/* How many values lie in each third of the range of an option, by ratio or straight. */
static void count_thirds(const pl_design *design, int option, int thirds[3])
{
    const pl_engine_option *o = &options[option];
    memset(thirds, 0, 3 * sizeof *thirds);
    for (int i = 0; i < design->count; ++i) {
        const double value = design->items[i].choice.values[option];
        const double place = o->tune_logarithmic
                                 ? log(value / o->tune_min) / log(o->tune_max / o->tune_min)
                                 : (value - o->tune_min) / (o->tune_max - o->tune_min);
        assert_true(value >= o->tune_min && value <= o->tune_max);
        assert_true(!o->integer || value == floor(value));
        thirds[place < 1.0 / 3 ? 0 : place < 2.0 / 3 ? 1 : 2] += 1;
    }
}

static void test_options_take_values_all_over_their_ranges(void **state)
{
    (void)state;
    pl_configuration one = configuration(0, 0);
    pl_design design = design_of(&one, 1, false);
    int thirds[3];
    assert_int_equal(design.count, SETTINGS);
    for (int option = A; option <= B; ++option) { /* a stratum each */
        count_thirds(&design, option, thirds);
        for (int i = 0; i < 3; ++i) {
            assert_int_equal(thirds[i], SETTINGS / 3);
        }
    }
    count_thirds(&design, C, thirds);
    assert_true(thirds[0] >= 6 && thirds[1] >= 6 && thirds[2] >= 6);
    count_thirds(&design, D, thirds);
    assert_int_equal(thirds[0], SETTINGS / 2);
    assert_int_equal(thirds[2], SETTINGS / 2);
    pl_design_free(&design);
}

static void test_steps_and_profiles_have_equal_shares(void **state)
{
    (void)state;
    pl_configuration one = configuration(0, 0);
    pl_design design = design_of(&one, 1, true);
    int of_step[3] = {0}, of_profile[2] = {0};
    for (int i = 0; i < design.count; ++i) {
        const pl_design_setting *setting = &design.items[i];
        for (int k = 0; k < 3; ++k) {
            of_step[k] += setting->dt == steps[k];
        }
        of_profile[setting->choice.profile] += 1;
    }
    for (int k = 0; k < 3; ++k) {
        assert_int_equal(of_step[k], SETTINGS / 3);
    }
    assert_int_equal(of_profile[0], SETTINGS / 2);
    assert_int_equal(of_profile[1], SETTINGS / 2);
    pl_design_free(&design);
}

static void test_what_is_not_tuned_keeps_its_value(void **state)
{
    (void)state;
    pl_configuration both[] = {configuration(0, 0), configuration(0, 1)};
    both[0].choice.values[B] = 0.7; /* as the user set it */
    pl_design design = design_of(both, 2, false);
    for (int i = 0; i < design.count; ++i) {
        const pl_engine_choice *choice = &design.items[i].choice;
        assert_true(choice->values[E] == (choice->profile == 0 ? 7 : 8));
        assert_true(choice->profile == 1 || choice->values[B] == 0.7);
        assert_true(choice->profile == 0 || choice->values[C] == 10);
    }
    pl_design_free(&design);
}

static bool is_same_setting(const pl_design_setting *a, const pl_design_setting *b)
{
    return a->dt == b->dt && a->choice.profile == b->choice.profile &&
           memcmp(a->choice.values, b->choice.values, OPTIONS * sizeof *a->choice.values) == 0;
}

static void test_a_design_does_not_depend_on_other_engines(void **state)
{
    (void)state;
    pl_configuration alone = configuration(0, 0);
    pl_configuration both[] = {configuration(1, 0), configuration(0, 0)};
    pl_design one = design_of(&alone, 1, true), two = design_of(both, 2, true);
    int different = 0;
    assert_int_equal(two.count, 2 * one.count);
    for (int i = 0; i < one.count; ++i) {
        assert_ptr_equal(two.items[2 * i + 1].choice.engine, &engines[0]);
        assert_true(is_same_setting(&one.items[i], &two.items[2 * i + 1]));
        different += !is_same_setting(&one.items[i], &two.items[2 * i]);
    }
    assert_true(different > SETTINGS / 2); /* engines have orders of their own */
    pl_design_free(&one);
    pl_design_free(&two);
}

/* Numbers that every machine must draw. */
static void test_the_design_is_the_same_everywhere(void **state)
{
    (void)state;
    pl_configuration one = configuration(0, 0);
    pl_design design = design_of(&one, 1, false);
    const double *first = design.items[0].choice.values;
    assert_true(first[A] == 0.000681 && first[B] == 0.228 && first[C] == 9);
    pl_design_free(&design);
}

/* Beyond its critical value a scene has another right answer: slope-tip within 1 % may have to tip. */
static void test_a_change_never_crosses_a_critical_value(void **state)
{
    (void)state;
    int count = 0;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    const pl_variant drawn = {"drawn", PL_VARIANT_DRAWN, 1};
    for (int i = 0; i < count; ++i) {
        double values[PL_MAX_PARAMS];
        assert_int_equal(pl_scenario_values(scenarios[i], NULL, 0, values, NULL), PL_OK);
        if (scenarios[i]->threshold != NULL) {
            assert_false(pl_variant_apply(&drawn, scenarios[i], 0, values));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_change_never_crosses_a_critical_value),
        cmocka_unit_test(test_options_take_values_all_over_their_ranges),
        cmocka_unit_test(test_steps_and_profiles_have_equal_shares),
        cmocka_unit_test(test_what_is_not_tuned_keeps_its_value),
        cmocka_unit_test(test_a_design_does_not_depend_on_other_engines),
        cmocka_unit_test(test_the_design_is_the_same_everywhere),
    };
    return cmocka_run_group_tests_name("sweep_design", tests, NULL, NULL);
}
