/* The settings that the usual sweep draws of each engine. */
#include "check.h"
#include "studies/sweep/grid.h"
#include "studies/tunable.h"
#include "studies/variant.h"

#include <math.h>
#include <string.h>

enum { SETTINGS = 32 };

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

typedef struct drawn_settings {
    pl_setting *items; /* (count), owned */
    int count;
} drawn_settings;

/* The settings of `count` configurations with all their engines' profiles, or those given alone. */
static drawn_settings drawn_of(pl_configuration *configurations, int count, bool all_profiles)
{
    const pl_plan plan = {.configurations = configurations, .configuration_count = count};
    const pl_draw_def def = {.plan = &plan,
                             .steps = steps,
                             .step_count = 3,
                             .settings = SETTINGS,
                             .all_profiles = all_profiles};
    drawn_settings drawn = {.items = NULL};
    drawn.items = pl_draw_settings(&def, &drawn.count);
    return drawn;
}

/* How many values lie in each third of the range of an option, by ratio or straight. */
static void count_thirds(const drawn_settings *drawn, int option, int thirds[3])
{
    const pl_engine_option *o = &options[option];
    memset(thirds, 0, 3 * sizeof *thirds);
    for (int i = 0; i < drawn->count; ++i) {
        const double value = drawn->items[i].choice.values[option];
        const double place = o->tune_logarithmic
                                 ? log(value / o->tune_min) / log(o->tune_max / o->tune_min)
                                 : (value - o->tune_min) / (o->tune_max - o->tune_min);
        assert_true(value >= o->tune_min && value <= o->tune_max);
        assert_true(!o->integer || value == floor(value));
        thirds[place < 1.0 / 3 ? 0 : place < 2.0 / 3 ? 1 : 2] += 1;
    }
}

/* Of every 2^k points in a row that begin at a multiple of 2^k, one lies in each 2^k-th of the range. */
static void test_points_have_a_stratum_each(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; ++seed) {
        for (int count = 1; count <= 64; count *= 2) {
            for (int first = 0; first < 256; first += count) {
                bool taken[64] = {false};
                for (int i = first; i < first + count; ++i) {
                    const double place = pl_design_place(seed, i);
                    assert_true(place > 0 && place < 1);
                    assert_false(taken[(int)(place * count)]);
                    taken[(int)(place * count)] = true;
                }
            }
        }
    }
}

/* In all quarters of the square of two dimensions there are points. */
static void test_dimensions_have_orders_of_their_own(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 100; ++seed) {
        int quarters[4] = {0};
        for (int i = 0; i < 64; ++i) {
            const bool right = pl_design_place(seed, i) > 0.5;
            quarters[2 * right + (pl_design_place(seed + 100, i) > 0.5)] += 1;
        }
        for (int k = 0; k < 4; ++k) {
            assert_in_range(quarters[k], 4, 28);
        }
    }
}

static void test_options_take_values_all_over_their_ranges(void **state)
{
    (void)state;
    pl_configuration one = configuration(0, 0);
    drawn_settings drawn = drawn_of(&one, 1, false);
    int thirds[3];
    assert_int_equal(drawn.count, SETTINGS);
    for (int option = A; option <= B; ++option) { /* a stratum each */
        count_thirds(&drawn, option, thirds);
        for (int i = 0; i < 3; ++i) {
            assert_in_range(thirds[i], SETTINGS / 3, SETTINGS / 3 + 1);
        }
    }
    count_thirds(&drawn, C, thirds);
    assert_true(thirds[0] >= 6 && thirds[1] >= 6 && thirds[2] >= 6);
    count_thirds(&drawn, D, thirds);
    assert_int_equal(thirds[0], SETTINGS / 2);
    assert_int_equal(thirds[2], SETTINGS / 2);
    free(drawn.items);
}

static void test_steps_and_profiles_have_equal_shares(void **state)
{
    (void)state;
    pl_configuration one = configuration(0, 0);
    drawn_settings drawn = drawn_of(&one, 1, true);
    int of_step[3] = {0}, of_profile[2] = {0};
    for (int i = 0; i < drawn.count; ++i) {
        const pl_setting *setting = &drawn.items[i];
        for (int k = 0; k < 3; ++k) {
            of_step[k] += setting->dt == steps[k];
        }
        of_profile[setting->choice.profile] += 1;
    }
    for (int k = 0; k < 3; ++k) {
        assert_in_range(of_step[k], SETTINGS / 3, SETTINGS / 3 + 1);
    }
    assert_int_equal(of_profile[0], SETTINGS / 2);
    assert_int_equal(of_profile[1], SETTINGS / 2);
    free(drawn.items);
}

static void test_what_is_not_tuned_keeps_its_value(void **state)
{
    (void)state;
    pl_configuration both[] = {configuration(0, 0), configuration(0, 1)};
    both[0].choice.values[B] = 0.7; /* as the user set it */
    drawn_settings drawn = drawn_of(both, 2, false);
    for (int i = 0; i < drawn.count; ++i) {
        const pl_engine_choice *choice = &drawn.items[i].choice;
        assert_true(choice->values[E] == (choice->profile == 0 ? 7 : 8));
        assert_true(choice->profile == 1 || choice->values[B] == 0.7);
        assert_true(choice->profile == 0 || choice->values[C] == 10);
    }
    free(drawn.items);
}

static bool is_same_setting(const pl_setting *a, const pl_setting *b)
{
    return a->dt == b->dt && a->choice.profile == b->choice.profile &&
           memcmp(a->choice.values, b->choice.values, OPTIONS * sizeof *a->choice.values) == 0;
}

static void test_settings_do_not_depend_on_other_engines(void **state)
{
    (void)state;
    pl_configuration alone = configuration(0, 0);
    pl_configuration both[] = {configuration(1, 0), configuration(0, 0)};
    drawn_settings one = drawn_of(&alone, 1, true), two = drawn_of(both, 2, true);
    int different = 0;
    assert_int_equal(two.count, 2 * one.count);
    for (int i = 0; i < one.count; ++i) {
        assert_ptr_equal(two.items[2 * i + 1].choice.engine, &engines[0]);
        assert_true(is_same_setting(&one.items[i], &two.items[2 * i + 1]));
        different += !is_same_setting(&one.items[i], &two.items[2 * i]);
    }
    assert_true(different > SETTINGS / 2); /* engines have orders of their own */
    free(one.items);
    free(two.items);
}

/* Numbers that every machine must draw. */
static void test_settings_are_the_same_everywhere(void **state)
{
    (void)state;
    pl_configuration one = configuration(0, 0);
    drawn_settings drawn = drawn_of(&one, 1, false);
    const double *first = drawn.items[0].choice.values;
    assert_true(first[A] == 4.94e-05 && first[B] == 0.171 && first[C] == 193);
    free(drawn.items);
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
        cmocka_unit_test(test_points_have_a_stratum_each),
        cmocka_unit_test(test_dimensions_have_orders_of_their_own),
        cmocka_unit_test(test_options_take_values_all_over_their_ranges),
        cmocka_unit_test(test_steps_and_profiles_have_equal_shares),
        cmocka_unit_test(test_what_is_not_tuned_keeps_its_value),
        cmocka_unit_test(test_settings_do_not_depend_on_other_engines),
        cmocka_unit_test(test_settings_are_the_same_everywhere),
    };
    return cmocka_run_group_tests_name("sweep settings", tests, NULL, NULL);
}
