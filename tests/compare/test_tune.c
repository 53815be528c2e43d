/* What plumb tune takes and says: parameters, spaces, targets, changed scenarios, an engine's own
 * API. */
#include "check.h"
#include "studies/tunable.h"
#include "studies/tune/tuner.h"
#include "studies/variant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const pl_tune_parameter scales[] = {
    {.name = "a", .low = 1, .high = 300, .logarithmic = true, .integer = true},
    {.name = "b", .low = 1e-10, .high = 1e-3, .logarithmic = true},
    {.name = "c", .low = 0, .high = 0.002},
    {.name = "d", .low = -3, .high = 8, .integer = true},
    {.name = "e", .low = 1e3, .high = 1e7, .logarithmic = true, .integer = true},
};
enum { SCALE_COUNT = sizeof scales / sizeof scales[0] };

static void test_parameter_range_maps_to_unit_interval_and_back(void **state)
{
    (void)state;
    for (int i = 0; i < SCALE_COUNT; ++i) {
        const pl_tune_parameter *parameter = &scales[i];
        double before = -(double)INFINITY;
        assert_close(pl_tune_value(parameter, 0), parameter->low, 0, 1e-15);
        assert_close(pl_tune_value(parameter, 1), parameter->high, 0, 1e-15);
        assert_close(pl_tune_value(parameter, -5), parameter->low, 0, 1e-15);
        assert_close(pl_tune_value(parameter, 7), parameter->high, 0, 1e-15);
        for (double u = 0; u <= 1; u += 1.0 / 64) {
            const double value = pl_tune_value(parameter, u);
            assert_true(value >= before && value >= parameter->low && value <= parameter->high);
            /* What is rounded once stays. */
            assert_true(pl_tune_value(parameter, pl_tune_unit(parameter, value)) == value);
            before = value;
        }
    }
}

static void test_neighbours_are_one_step_away_within_range(void **state)
{
    (void)state;
    assert_true(pl_tune_neighbour(&scales[0], 100, 1) == 110);
    assert_true(pl_tune_neighbour(&scales[0], 5, -1) == 4);
    assert_true(pl_tune_neighbour(&scales[0], 1, -1) == 1);
    assert_true(pl_tune_neighbour(&scales[0], 300, 1) == 300);
    assert_close(pl_tune_neighbour(&scales[1], 1e-6, -1), 9e-7, 0, 1e-12);
    assert_close(pl_tune_neighbour(&scales[2], 0, 1), 2e-5, 0, 1e-12);
    assert_true(pl_tune_neighbour(&scales[3], 0, 1) == 1);
    assert_true(pl_tune_neighbour(&scales[3], -2, -1) == -3);
}

static void check_bad_target(const char *text, const char *part)
{
    pl_targets targets = {.count = 0};
    pl_error error = {.message = ""};
    assert_int_equal(pl_target_add(&targets, text, &error), PL_BAD_INPUT);
    assert_contains(error.message, part);
    assert_int_equal(targets.count, 0);
}

static void test_bad_targets_are_refused(void **state)
{
    (void)state;
    check_bad_target("reference_error", "METRIC<=VALUE");
    check_bad_target("reference_error>=1", "METRIC<=VALUE");
    check_bad_target("reference_error=1", "METRIC<=VALUE");
    check_bad_target("<=1", "METRIC<=VALUE");
    check_bad_target("reference_eror<=1", "did you mean reference_error");
    check_bad_target("reference_error<=", "positive number");
    check_bad_target("reference_error<=0", "positive number");
    check_bad_target("reference_error<=-1", "positive number");
    check_bad_target("reference_error<=1e-3m", "positive number");
    check_bad_target("state_hash<=1", "lower is not better");
}

static double excess_of(const pl_targets *targets, const char *outcome, double value)
{
    json_t *result = json_pack("{s:s, s:{s:{s:o}}}", "outcome", outcome, "metrics", "drift",
                               "value", isnan(value) ? json_null() : json_real(value));
    const double excess = pl_targets_excess(targets, result);
    json_decref(result);
    return excess;
}

static void test_target_is_met_only_by_ok_runs(void **state)
{
    (void)state;
    pl_targets at_most = {.count = 0}, below = {.count = 0};
    char text[96];
    assert_int_equal(pl_target_add(&at_most, "drift<=1e-3", NULL), PL_OK);
    assert_int_equal(pl_target_add(&below, "drift<1/1000", NULL), PL_OK);
    pl_target_text(&below.items[0], text);
    assert_string_equal(text, "drift<0.001");
    const double above = nextafter(1e-3, 1), under = nextafter(1e-3, 0);
    assert_true(excess_of(&at_most, "ok", 1e-3) <= 0);
    assert_true(excess_of(&below, "ok", 1e-3) > 0);
    assert_true(excess_of(&below, "ok", under) <= 0);
    assert_true(excess_of(&at_most, "ok", above) > 0);
    assert_close(excess_of(&at_most, "ok", 1e-2), log(10), 1e-12, 0);
    assert_true(excess_of(&at_most, "ok", 0) <= 0);
    assert_true(excess_of(&at_most, "collapsed", 1e-9) > 0);
    assert_true(excess_of(&at_most, "collapsed", 1) > excess_of(&at_most, "ok", 1));
    assert_true(excess_of(&at_most, "ok", (double)NAN) == PL_SEARCH_WORST);
    /* Among several targets, the one that is missed by most. */
    assert_int_equal(pl_target_add(&at_most, "drift<=1e-4", NULL), PL_OK);
    assert_close(excess_of(&at_most, "ok", 1e-2), log(100), 1e-12, 0);
}

static void test_scattered_errors_need_two_standard_deviations(void **state)
{
    (void)state;
    const double same[] = {-0.5, -0.5, -0.5}, scattered[] = {-2, -1, 0};
    const double clear[] = {-28, -4, -11}, one[] = {-1};
    assert_close(pl_likely_excess(same, 3), -0.5, 1e-12, 0);
    assert_close(pl_likely_excess(scattered, 3), -1 + 2 * 1.0, 1e-12, 0);
    assert_close(pl_likely_excess(one, 1), -1, 1e-12, 0);
    /* Far below the target, how far does not matter. */
    assert_true(pl_likely_excess(clear, 3) <= -2.9);
}

static pl_engine_choice choose(const char *spec)
{
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose(spec, &choice, NULL), PL_OK);
    return choice;
}

static const pl_tune_parameter *parameter_of(const pl_tune_space *space, const char *name)
{
    for (int i = 0; i < space->parameter_count; ++i) {
        if (strcmp(space->parameters[i].name, name) == 0) {
            return &space->parameters[i];
        }
    }
    return NULL;
}

static void test_parameter_tables_lie_within_engine_ranges(void **state)
{
    (void)state;
    int count = 0, parameters = 0;
    const pl_built_in *known = pl_built_in_engines(&count);
    for (int i = 0; i < count; ++i) {
        const pl_engine_info *engine = NULL;
        if (known[i].entry != NULL) {
            assert_int_equal(pl_engine_of_build(&known[i], &engine, NULL), PL_OK);
        }
        for (int p = 0; engine != NULL && p < engine->profile_count; ++p) {
            char spec[2 * PL_NAME_SIZE];
            pl_tune_space space;
            snprintf(spec, sizeof spec, "%s:%s", engine->name, engine->profiles[p].name);
            const pl_engine_choice choice = choose(spec);
            assert_int_equal(
                pl_tune_space_make(&(pl_tune_request){.engine = &choice, .dt = (double)NAN}, &space,
                                   NULL),
                PL_OK);
            assert_non_null(parameter_of(&space, "dt"));
            parameters += space.parameter_count;
            for (int k = 0; k < space.parameter_count; ++k) {
                const pl_tune_parameter *parameter = &space.parameters[k];
                assert_true(parameter->low < parameter->high);
                assert_true(!parameter->logarithmic || parameter->low > 0);
                if (parameter->option != PL_TUNE_RATE) {
                    const pl_engine_option *option = &engine->options[parameter->option];
                    assert_true(parameter->low >= option->min && parameter->high <= option->max);
                    assert_int_equal(parameter->integer, option->integer);
                }
            }
        }
    }
    assert_true(parameters >= 9); /* three of each profile of plumb */
}

/* The setting with all parameters at their lowest values. */
static pl_setting lowest_of(const pl_tune_space *space)
{
    double values[PL_TUNE_MAX_PARAMETERS];
    for (int i = 0; i < space->parameter_count; ++i) {
        values[i] = space->parameters[i].low;
    }
    json_t *point = pl_tune_values(space, values);
    const pl_setting setting = pl_tune_setting(space, point);
    json_decref(point);
    return setting;
}

static void test_varied_fixed_and_given_parameters_are_kept(void **state)
{
    (void)state;
    const pl_engine_choice choice = choose("plumb:fast,tolerance=1e-5");
    const char *const varied[] = {"dt=1/240..1/60", "updates=100..2e6", "iterations=10..20"};
    const char *const fixed[] = {"slop=1e-5"};
    pl_tune_space space;
    const pl_tune_request request = {&choice, (double)NAN, varied, 3, fixed, 1};
    assert_int_equal(pl_tune_space_make(&request, &space, NULL), PL_OK);
    assert_null(parameter_of(&space, "tolerance"));
    assert_null(parameter_of(&space, "slop"));
    const pl_tune_parameter *dt = parameter_of(&space, "dt"),
                            *iterations = parameter_of(&space, "iterations");
    assert_true(dt->low == 60 && dt->high == 240 && dt->integer);
    assert_true(iterations->low == 10 && iterations->high == 20 && !iterations->logarithmic);
    assert_true(parameter_of(&space, "updates")->logarithmic);
    const pl_setting at_low = lowest_of(&space);
    const pl_engine_choice lowest = at_low.choice;
    assert_true(at_low.dt == 1.0 / 60);
    assert_contains(lowest.spec, "plumb:fast");
    /* The SPEC gives the very same settings. */
    const pl_engine_choice again = choose(lowest.spec);
    assert_memory_equal(again.values, lowest.values,
                        (size_t)lowest.engine->option_count * sizeof(double));
    assert_contains(lowest.spec, "tolerance=1e-05");
    assert_contains(lowest.spec, "slop=1e-05");
}

/* An engine may be a long command. */
static void test_a_long_command_keeps_all_options_or_is_refused(void **state)
{
    (void)state;
    char spec[PL_SPEC_SIZE], wanted[64];
    pl_engine_choice choice = choose("plumb:fast");
    pl_engine_info engine = *choice.engine;
    pl_tune_space space;
    pl_error error = {.message = ""};
    const pl_tune_request request = {&choice, (double)NAN, NULL, 0, NULL, 0};
    engine.spec = spec;
    choice.engine = &engine;
    snprintf(spec, sizeof spec, "exec:%0400d", 0);
    assert_int_equal(pl_tune_space_make(&request, &space, &error), PL_OK);
    const pl_engine_choice lowest = lowest_of(&space).choice;
    for (int i = 0; i < space.parameter_count; ++i) {
        const pl_tune_parameter *parameter = &space.parameters[i];
        if (parameter->option != PL_TUNE_RATE && parameter->low != parameter->start) {
            snprintf(wanted, sizeof wanted, ",%.40s=%.15g", parameter->name, parameter->low);
            assert_contains(lowest.spec, wanted);
        }
    }
    snprintf(spec, sizeof spec, "exec:%01000d", 0);
    assert_int_equal(pl_tune_space_make(&request, &space, &error), PL_BAD_INPUT);
    assert_contains(error.message, "longer than 1023 characters");
}

static void check_bad_space(const char *vary, const char *fix, const char *part)
{
    const pl_engine_choice choice = choose("plumb");
    const char *const varied[] = {vary, vary}, *const fixed[] = {fix};
    pl_tune_space space;
    pl_error error = {.message = ""};
    const pl_tune_request request = {&choice,      (double)NAN, varied,
                                     vary != NULL, fixed,       fix != NULL};
    assert_int_equal(pl_tune_space_make(&request, &space, &error), PL_BAD_INPUT);
    assert_contains(error.message, part);
}

static void test_bad_axes_are_refused(void **state)
{
    (void)state;
    check_bad_space("slop", NULL, "KEY=LOW..HIGH");
    check_bad_space("slop=1e-5", NULL, "KEY=LOW..HIGH");
    check_bad_space("slop=1e-5..", NULL, "no number");
    check_bad_space("slop=1e-3..1e-5", NULL, "empty");
    check_bad_space("slop=1e-3..2", NULL, "expected 1e-12 to 1");
    check_bad_space("slip=1e-3..1e-2", NULL, "did you mean slop");
    check_bad_space("iterations=1.5..7", NULL, "whole");
    check_bad_space("dt=0..1/60", NULL, "expected 1e-06 to 1");
    check_bad_space("dt=0.0166..0.0167", NULL, "no two whole rates");
    check_bad_space("slop=1e-5..1e-3", "slop=1e-4", "given twice");
    check_bad_space(NULL, "slop", "KEY=VALUE");
    check_bad_space(NULL, "slop=x", "no number");
}

static void test_engine_api_code_lists_changed_values_only(void **state)
{
    (void)state;
    const pl_engine_choice choice = choose("plumb:fast,slop=0.002");
    json_t *lines = pl_tune_api(&choice, 1.0 / 240);
    json_t *expected = json_pack("[s, s]", "def.penetration_slop = 0.002;",
                                 "pe_world_step(world, 1.0 / 240, &stats, &error);");
    assert_true(json_equal(lines, expected));
    json_decref(lines);
    json_decref(expected);
}

/* What is held out is never what was tuned on, for any scenario of the catalogue. */
static void test_held_out_scenarios_are_not_tuned_on(void **state)
{
    (void)state;
    int scenario_count;
    const pl_scenario *const *scenarios = pl_scenarios(&scenario_count);
    const pl_variants tuned = pl_variants_tuned_on, chosen = pl_variants_chosen_by;
    const pl_variants held = pl_variants_held_out;
    for (int s = 0; s < scenario_count; ++s) {
        for (int i = 0; i < held.count; ++i) {
            double mine[PL_MAX_PARAMS] = {0};
            pl_scenario_values(scenarios[s], NULL, 0, mine, NULL);
            if (!pl_variant_apply(&held.items[i], scenarios[s], 3, mine)) {
                continue;
            }
            for (int p = 0; p < scenarios[s]->param_count; ++p) {
                const pl_param *param = &scenarios[s]->params[p];
                assert_true(mine[p] >= param->min && mine[p] <= param->max);
            }
            for (int k = -1; k < tuned.count + chosen.count; ++k) {
                const pl_variant *other = k < 0             ? &pl_variant_none
                                          : k < tuned.count ? &tuned.items[k]
                                                            : &chosen.items[k - tuned.count];
                double theirs[PL_MAX_PARAMS] = {0};
                pl_scenario_values(scenarios[s], NULL, 0, theirs, NULL);
                assert_true(!pl_variant_apply(other, scenarios[s], 3, theirs) ||
                            memcmp(mine, theirs, sizeof mine) != 0 ||
                            held.items[i].seed != other->seed);
            }
        }
    }
}

static void write_profile(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void check_bad_profile(const char *path, const char *text, const char *part)
{
    pl_engine_choice choice;
    pl_error error = {.message = ""};
    write_profile(path, text);
    assert_true(pl_engine_choose("plumb:tuned", &choice, &error) != PL_OK);
    assert_contains(error.message, part);
}

static void test_file_profile_is_its_base_with_changes(void **state)
{
    (void)state;
    char path[] = "/tmp/plumb_profile_XXXXXX";
    pl_engine_choice choice;
    const int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    setenv("PLUMB_PROFILES", path, 1);
    write_profile(path, "{\"schema\": \"plumb.profile/1\", \"name\": \"tuned\", \"engine\": "
                        "\"plumb\", \"profile\": \"fast\", \"options\": {\"slop\": 0.002}}");
    choice = choose("plumb:tuned");
    const pl_engine_choice same = choose("plumb:fast,slop=0.002");
    assert_int_equal(choice.profile, same.profile);
    assert_memory_equal(choice.values, same.values,
                        (size_t)choice.engine->option_count * sizeof(double));
    char label[PL_LABEL_SIZE];
    pl_engine_choice_label(&choice, label);
    assert_string_equal(label, "plumb:fast,slop=0.002");
    const pl_engine_choice further = choose("plumb:tuned,slop=0.001");
    assert_memory_equal(further.values, choose("plumb:fast,slop=0.001").values,
                        (size_t)choice.engine->option_count * sizeof(double));
    /* Own profiles need no file, and other names find none. */
    assert_int_equal(pl_engine_choose("plumb:tuend", &choice, NULL), PL_BAD_INPUT);
    check_bad_profile(path, "{", "1:");
    check_bad_profile(path, "{}", "no plumb.profile/1");
    check_bad_profile(path,
                      "{\"schema\": \"plumb.profile/1\", \"name\": \"tuned\", \"engine\": "
                      "\"plumb\", \"profile\": \"fast\", \"options\": {\"slip\": 0.002}}",
                      "has no option slip");
    check_bad_profile(path,
                      "{\"schema\": \"plumb.profile/1\", \"name\": \"tuned\", \"engine\": "
                      "\"plumb\", \"profile\": \"fast\", \"options\": {\"slop\": 7}}",
                      "expected a number of 1e-12 to 1");
    choose("plumb:fast");
    remove(path);
    pl_error error = {.message = ""};
    assert_int_equal(pl_engine_choose("plumb:tuned", &choice, &error), PL_IO);
    unsetenv("PLUMB_PROFILES");
    assert_int_equal(pl_engine_choose("plumb:tuend", &choice, &error), PL_BAD_INPUT);
}

/* Whether a profile of the engine has settings that are tuned. */
static bool has_tunable(const pl_engine_info *engine)
{
    bool any = false;
    for (int k = 0; k < engine->profile_count * engine->option_count; ++k) {
        pl_tunable tunable;
        any = any ||
              pl_tunable_find(engine, k / engine->option_count, k % engine->option_count, &tunable);
    }
    return any;
}

/* Whether the description of the engine says why it is not tuned. */
static bool says_why_not(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/compare/adapters/%s/engine.json", PLUMB_SOURCE_DIR, name);
    json_t *description = json_load_file(path, 0, NULL);
    assert_non_null(description);
    const bool says = json_string_length(json_object_get(description, "not_tuned")) > 0;
    json_decref(description);
    return says;
}

/* Each that has settings to tune and that can do the boxes on which all are tuned; the profile is whole. */
static void test_linked_engines_have_tuned_profiles(void **state)
{
    (void)state;
    int count = 0, with_profile = 0;
    const pl_built_in *engines = pl_built_in_engines(&count);
    unsetenv("PLUMB_PROFILES");
    for (int i = 0; i < count; ++i) {
        const pl_engine_info *engine = NULL;
        pl_tuned_profile tuned;
        bool found = false;
        if (engines[i].entry == NULL || pl_engine_of_build(&engines[i], &engine, NULL) != PL_OK) {
            continue;
        }
        assert_int_equal(pl_tuned_profile_find(engine, "tuned", &tuned, &found, NULL), PL_OK);
        if (!found && has_tunable(engine) && (engine->capabilities & PL_NEEDS_BOX) != 0 &&
            !says_why_not(engine->name)) {
            fail_msg("%s: engines/tuned_profiles.json has no profile of it, and its engine.json no "
                     "\"not_tuned\" that says why",
                     engine->name);
        }
        with_profile += found;
        assert_true(!found || pl_engine_profile_index(engine, tuned.base) >= 0);
        for (int k = 0; found && k < engine->option_count; ++k) {
            assert_true(tuned.given[k]);
        }
    }
    assert_true(with_profile > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parameter_range_maps_to_unit_interval_and_back),
        cmocka_unit_test(test_neighbours_are_one_step_away_within_range),
        cmocka_unit_test(test_bad_targets_are_refused),
        cmocka_unit_test(test_target_is_met_only_by_ok_runs),
        cmocka_unit_test(test_scattered_errors_need_two_standard_deviations),
        cmocka_unit_test(test_parameter_tables_lie_within_engine_ranges),
        cmocka_unit_test(test_varied_fixed_and_given_parameters_are_kept),
        cmocka_unit_test(test_a_long_command_keeps_all_options_or_is_refused),
        cmocka_unit_test(test_bad_axes_are_refused),
        cmocka_unit_test(test_engine_api_code_lists_changed_values_only),
        cmocka_unit_test(test_held_out_scenarios_are_not_tuned_on),
        cmocka_unit_test(test_file_profile_is_its_base_with_changes),
        cmocka_unit_test(test_linked_engines_have_tuned_profiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
