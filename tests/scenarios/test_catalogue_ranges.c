/* Every scenario at the ends of its parameters' ranges: what builds has a finite reference, and
 * what does not says why. Nothing is run. */
#include "check.h"
#include "plumb/scenario.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void assert_finite(double value, const char *what, const char *setting)
{
    if (!isfinite(value)) {
        fail_msg("%s: %s is %g", setting, what, value);
    }
}

/* A discrete answer may be missing, as NAN. */
static void check_reference(const pl_scene *scene, const char *setting)
{
    for (int i = 0; i < scene->rest_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            assert_finite(scene->rests[i].position[k], "a place of rest", setting);
        }
    }
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        assert_finite(travel->distance, "a distance", setting);
        assert_true(!isinf(travel->discrete));
        for (int k = 0; k < 3; ++k) {
            assert_finite(travel->direction[k], "a direction", setting);
        }
    }
    for (int i = 0; i < scene->value_count; ++i) {
        const pl_expect_value *value = &scene->values[i];
        assert_finite(value->value, "a value", setting);
        assert_true(!isinf(value->discrete));
        if (!(value->scale > 0 && isfinite(value->scale) && value->from <= value->until)) {
            fail_msg("%s: a scale of %g from %g s until %g s", setting, value->scale, value->from,
                     value->until);
        }
    }
    if (scene->rest_count + scene->travel_count + scene->value_count == 0) {
        /* No expectation: judged by what holds for every motion. */
        assert_true(strcmp(scene->primary_error, "chaotic_error") == 0 ||
                    strcmp(scene->primary_error, "momentum_error") == 0 ||
                    strcmp(scene->primary_error, "penetration_max") == 0 ||
                    strcmp(scene->primary_error, "energy_gain") == 0);
    }
}

/* True: it was refused, and said why in the form "NAME: expected ..., found ...". */
static bool refuses(const pl_scenario *s, const double *values, const char *setting)
{
    pl_scene scene;
    pl_error error = {.message = ""};
    const pl_status status = pl_scenario_build(s, values, 1, &scene, &error);
    if (status == PL_OK) {
        assert_int_equal(pl_scene_validate(&scene, NULL), PL_OK);
        check_reference(&scene, setting);
        pl_scene_free(&scene);
        return false;
    }
    assert_int_equal(status, PL_BAD_INPUT);
    assert_null(scene.bodies);
    if (strstr(error.message, "expected") == NULL || strstr(error.message, "expect.") != NULL) {
        fail_msg("%s: refused without a reason that a user understands: %s", setting,
                 error.message);
    }
    return true;
}

static int param_of(const pl_scenario *s, const char *name)
{
    for (int i = 0; i < s->param_count; ++i) {
        if (strcmp(s->params[i].name, name) == 0) {
            return i;
        }
    }
    fail_msg("%s has no parameter %s", s->name, name);
    return -1;
}

static void take_defaults(const pl_scenario *s, double *values)
{
    assert_int_equal(pl_scenario_values(s, NULL, 0, values, NULL), PL_OK);
}

/* Sets parameter k to one of its ends; the run stays short, and a step fits into it. */
static void take_end(const pl_scenario *s, int k, int end, double *values)
{
    values[k] = end == 0 ? s->params[k].min : s->params[k].max;
    const int dt = param_of(s, "dt"), duration = param_of(s, "duration");
    values[duration] = k == duration ? values[k] : fmax(0.1, values[dt]);
}

/* Values that end the scene at once, or that would make another scenario. */
static const char *const refused[] = {
    "slope-stick friction=0",   "slope-stick angle=1.2",      "slope-slide friction=1.9",
    "slope-slide angle=0",      "roll-slope friction=0",      "roll-slope angle=0",
    "roll-slope angle=1.5",     "carried-balls push=1",       "carried-balls friction=0.5",
    "reaction-split height=20", "reaction-split friction=10", "spinning-coin path=100",
    "multi-tower k=100",        "city houses=25000"};

static void test_one_extreme_parameter_builds_or_gives_reason(void **state)
{
    (void)state;
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        const pl_scenario *s = scenarios[i];
        for (int k = 0; k < 2 * s->param_count; ++k) {
            const int param = k / 2;
            double values[PL_MAX_PARAMS];
            char setting[128];
            take_defaults(s, values);
            take_end(s, param, k % 2, values);
            snprintf(setting, sizeof setting, "%s %s=%g", s->name, s->params[param].name,
                     values[param]);
            bool listed = false;
            for (size_t r = 0; r < sizeof refused / sizeof refused[0]; ++r) {
                listed = listed || strcmp(refused[r], setting) == 0;
            }
            const bool is_refused = refuses(s, values, setting);
            if (is_refused != listed && strcmp(s->params[param].name, "duration") != 0) {
                fail_msg("%s is %s", setting, listed ? "not refused" : "in its range, and refused");
            }
        }
    }
}

/* Two at a time, small scenes alone: there a reference is most easily lost. */
static void test_two_extreme_parameters_build_or_give_reason(void **state)
{
    (void)state;
    int count, built = 0;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        const pl_scenario *s = scenarios[i];
        for (int k = 0; k < 2 * s->param_count; ++k) {
            for (int j = 0; j < k / 2 * 2; ++j) {
                double values[PL_MAX_PARAMS];
                char setting[160];
                take_defaults(s, values);
                take_end(s, j / 2, j % 2, values);
                take_end(s, k / 2, k % 2, values);
                bool small = true;
                for (int p = 0; p < s->param_count; ++p) {
                    small = small && (!s->params[p].integer || values[p] <= 100);
                }
                snprintf(setting, sizeof setting, "%s %s=%g %s=%g", s->name, s->params[j / 2].name,
                         values[j / 2], s->params[k / 2].name, values[k / 2]);
                built += small && !refuses(s, values, setting);
            }
        }
    }
    assert_true(built > 1000);
}

static void test_a_rocket_that_hovers_or_whirls_is_refused(void **state)
{
    (void)state;
    const pl_scenario *s = pl_scenario_find("rocket", NULL);
    double values[PL_MAX_PARAMS];
    take_defaults(s, values);
    values[param_of(s, "thrust")] = 9.81;
    assert_true(refuses(s, values, "rocket thrust=9.81"));
    values[param_of(s, "offset")] = 0.01;
    assert_false(refuses(s, values, "rocket thrust=9.81 offset=0.01"));
    values[param_of(s, "duration")] = 1000;
    assert_true(refuses(s, values, "rocket duration=1000"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_extreme_parameter_builds_or_gives_reason),
        cmocka_unit_test(test_two_extreme_parameters_build_or_give_reason),
        cmocka_unit_test(test_a_rocket_that_hovers_or_whirls_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
