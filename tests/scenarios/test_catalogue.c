/* The catalogue: what all scenarios have in common, their settings, and the suites. */
#include "check.h"
#include "scenario_scene.h"
#include "scene_equal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void test_every_scenario_is_complete_and_builds(void **state)
{
    (void)state;
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        const pl_scenario *s = scenarios[i];
        const char *texts[] = {s->name,      s->title,    s->description,
                               s->reference, s->expected, s->source};
        for (size_t k = 0; k < sizeof texts / sizeof texts[0]; ++k) {
            assert_non_null(texts[k]);
            assert_true(strlen(texts[k]) > 0);
        }
        assert_true(strncmp(s->expected, "ok: ", 4) == 0 && strlen(s->expected) <= 120);
        assert_null(strchr(s->expected, '\n'));
        assert_ptr_equal(pl_scenario_find(s->name, NULL), s);
        assert_in_range(s->param_count, 2, PL_MAX_PARAMS);
        bool has_dt = false, has_duration = false;
        for (int k = 0; k < s->param_count; ++k) {
            const pl_param *param = &s->params[k];
            has_dt = has_dt || strcmp(param->name, "dt") == 0;
            has_duration = has_duration || strcmp(param->name, "duration") == 0;
            assert_true(param->min <= param->value && param->value <= param->max);
            assert_true(strlen(param->unit) > 0 && strlen(param->help) > 0);
        }
        assert_true(has_dt && has_duration);
        pl_scene scene;
        build_scenario(s->name, NULL, 0, 0, &scene);
        assert_int_equal(pl_scene_validate(&scene, NULL), PL_OK);
        assert_string_equal(scene.name, s->name);
        assert_string_equal(scene.primary_error, s->primary_error);
        pl_scene_free(&scene);
    }
}

/* What the bound of an accurate run is, and why. */
static void test_every_scenario_states_a_reasoned_acceptance(void **state)
{
    (void)state;
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        const pl_scenario *s = scenarios[i];
        pl_scene scene;
        build_scenario(s->name, NULL, 0, 0, &scene);
        assert_true(s->acceptance > 0 && isfinite(s->acceptance));
        assert_true(s->acceptance_reason != NULL && strlen(s->acceptance_reason) > 20);
        assert_null(strchr(s->acceptance_reason, '\n'));
        assert_close(scene.acceptance, s->acceptance, 0, 0);
        pl_scene_free(&scene);
    }
}

/* The names of the bits, in their order. */
static void name_needs(uint32_t needs, char *text, size_t size)
{
    text[0] = '\0';
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        if ((needs & bit) != 0) {
            const size_t used = strlen(text);
            snprintf(text + used, size - used, "%s%s", used > 0 ? " " : "", pl_needs_name(bit));
        }
    }
}

static void test_needs_are_those_of_the_default_scene(void **state)
{
    (void)state;
    static const char *const expected[][2] = {
        {"tower", "friction rotation plane box"},
        {"mass-ratio", "friction rotation plane box"},
        {"slope-stick", "friction rotation plane box"},
        {"slope-slide", "friction rotation plane box"},
        {"slide-to-stop", "friction rotation plane box"},
        {"wall", "friction rotation plane box"},
        {"wall-collapse", "friction rotation plane sphere box"},
        {"pile", "friction rotation plane sphere box"},
        {"rest-shape", "friction rotation plane box"},
        {"linked-rings", "friction rotation mesh"},
        {"roll-slope", "friction rotation plane sphere"},
        {"blocks", "friction rotation plane mesh"},
        {"thin-wall", "friction rotation sphere box"},
        {"rocket", "rotation forces box"},
        {"slope-threshold", "friction rotation plane box"},
        {"slope-tip", "friction rotation plane box"},
        {"ladder", "friction rotation plane box"},
        {"multi-tower", "friction rotation plane box"},
        {"pyramid", "friction rotation plane box"},
        {"overhang", "friction rotation box"},
        {"cylinder-pyramid", "friction rotation plane cylinder"},
        {"sphere-pyramid", "friction rotation plane sphere"},
        {"large-step", "friction rotation plane box"},
        {"far-from-origin", "friction rotation plane box"},
        {"initial-overlap", "friction rotation plane box"},
        {"thin-rod", "friction rotation plane box"},
        {"arch", "friction rotation box hull"},
        {"card-house", "friction rotation plane box"},
        {"painleve", "friction rotation plane box"},
        {"needle-in-gap", "rotation plane box"},
        {"free-fall", "sphere"},
        {"projectile", "sphere"},
        {"bowling", "friction rotation plane sphere"},
        {"torque-free", "rotation box"},
        {"bounce", "restitution plane sphere"},
        {"oblique-impact", "friction restitution rotation plane sphere"},
        {"collision-train", "restitution sphere"},
        {"rocking-block", "friction rotation plane box"},
        {"isotropy", "friction rotation plane box"},
        {"carried-balls", "friction rotation forces plane sphere box"},
        {"reaction-split", "friction rotation plane box"},
        {"spin-stop", "friction rotation plane box"},
        {"cradle", "restitution sphere"},
        {"dominoes", "friction rotation plane box"},
        {"falling-cubes", "friction rotation plane box"},
        {"domino-into-pile", "friction rotation plane box"},
        {"domino-spiral", "friction rotation plane box"},
        {"container", "friction rotation plane box"},
        {"rubble", "friction rotation plane hull"},
        {"medley", "friction rotation plane sphere box capsule cylinder hull mesh"},
        {"top", "rotation plane hull"},
        {"slide-and-spin", "friction rotation plane hull"},
        {"bounce-row", "friction restitution rotation plane sphere"},
        {"dropped-load", "friction rotation plane box"},
        {"lid", "friction rotation plane box"},
        {"raft", "friction rotation plane box"},
        {"rain", "friction restitution rotation plane sphere"},
        {"spinning-coin", "friction rotation plane cylinder"},
        {"overlapping-start", "friction rotation plane sphere box"},
        {"city", "friction rotation plane box"},
        {"avalanche", "friction rotation plane hull"},
        {"seams", "rotation box"},
        {"pedestal", "restitution rotation box"},
    };
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    assert_int_equal(count, sizeof expected / sizeof expected[0]);
    for (int i = 0; i < count; ++i) {
        char needs[128];
        assert_string_equal(scenarios[i]->name, expected[i][0]);
        name_needs(pl_scenario_needs(scenarios[i]), needs, sizeof needs);
        assert_string_equal(needs, expected[i][1]);
    }
}

static void test_same_seed_gives_the_same_scene_and_file(void **state)
{
    (void)state;
    static const char *const jittered[] = {"offset=0.1"};
    char hash[3][17];
    const uint64_t seeds[3] = {7, 7, 8};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene;
        build_scenario("tower", jittered, 1, seeds[i], &scene);
        assert_int_equal(pl_scene_hash(&scene, hash[i], NULL), PL_OK);
        pl_scene_free(&scene);
    }
    assert_string_equal(hash[0], hash[1]);
    assert_string_not_equal(hash[0], hash[2]);
}

static void test_every_scene_reads_back_from_its_file(void **state)
{
    (void)state;
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        pl_scene scene, again;
        pl_error error = {.message = ""};
        build_scenario(scenarios[i]->name, NULL, 0, 3, &scene);
        char *text = pl_scene_to_text(&scene);
        assert_non_null(text);
        if (pl_scene_read_text(text, strlen(text), "scene", &again, &error) != PL_OK) {
            fail_msg("%s", error.message);
        }
        assert_same_scene(&again, &scene);
        free(text);
        pl_scene_free(&scene);
        pl_scene_free(&again);
    }
}

static void test_dt_and_duration_reach_the_scene(void **state)
{
    (void)state;
    static const char *const settings[] = {"dt=1/240", "duration=0.5"};
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        pl_scene scene;
        build_scenario(scenarios[i]->name, settings, 2, 0, &scene);
        assert_close(scene.dt, 1.0 / 240, 0, 0);
        assert_int_equal(pl_scene_steps(&scene), 120);
        pl_scene_free(&scene);
    }
}

static void test_bad_settings_are_refused(void **state)
{
    (void)state;
    assert_setting_refused("tower", "n", "expected NAME=VALUE, found \"n\"");
    assert_setting_refused("tower", "frction=1", "did you mean \"friction\"?");
    assert_setting_refused("tower", "elasticity=1",
                           "it has n, friction, offset, top_mass, rising_mass, yaw, height, dt");
    assert_setting_refused("tower", "n=ten", "n: expected a number, found \"ten\"");
    assert_setting_refused("tower", "n=", "expected a number");
    assert_setting_refused("tower", "n=nan", "expected a number");
    assert_setting_refused("tower", "n=0x10", "expected a number");
    assert_setting_refused("tower", "n=10 ", "expected a number");
    assert_setting_refused("tower", "n=1e999", "expected a number");
    assert_setting_refused("tower", "n=10.5", "expected a whole number, found 10.5");
    assert_setting_refused("tower", "n=0", "expected 1 to 2000");
    assert_setting_refused("tower", "n=2001", "expected 1 to 2000");
    assert_setting_refused("tower", "offset=0.3", "expected 0 to 0.2");
    assert_setting_refused("tower", "dt=1/0", "expected a number");
    assert_setting_refused("tower", "dt=20", "dt: expected");
    assert_setting_refused("tower", "duration=0.001", "duration: expected at least dt");
    assert_setting_refused("tower", "duration=1e6", "at most 10000000 steps");
    assert_setting_refused("slope-slide", "friction=2", "expected 0 to 1.9");
}

static void test_unknown_names_get_the_nearest(void **state)
{
    (void)state;
    pl_error error = {.message = ""};
    assert_null(pl_scenario_find("wal-colapse", &error));
    assert_contains(error.message, "did you mean \"wall-collapse\"?");
    assert_null(pl_scenario_find("zzzzzz", &error));
    assert_string_equal(error.message, "unknown scenario \"zzzzzz\"");
    assert_null(pl_suite_find("cannonical", &error));
    assert_contains(error.message, "did you mean \"canonical\"?");
}

static void test_canonical_suite_is_these_in_order(void **state)
{
    (void)state;
    static const char *const expected[] = {"tower",         "multi-tower",   "slope-stick",
                                           "slope-slide",   "slope-tip",     "wall",
                                           "wall-collapse", "falling-cubes", "rocket"};
    enum { COUNT = sizeof expected / sizeof expected[0] };
    const pl_suite *suite = pl_suite_find("canonical", NULL);
    assert_non_null(suite);
    assert_int_equal(suite->entry_count, COUNT);
    for (int i = 0; i < COUNT; ++i) {
        assert_string_equal(suite->entries[i].scenario, expected[i]);
    }
    assert_string_equal(suite->entries[1].setting, "k=2,n=10");
    assert_string_equal(suite->entries[6].setting, "rows=10,columns=10");
    assert_null(suite->published_metric);
}

static void test_paper_suite_holds_the_table_of_the_source(void **state)
{
    (void)state;
    static const char *const towers[] = {"n=5", "n=10", "n=25"};
    static const double iterations[] = {1.65, 36, 47};
    const pl_suite *suite = pl_suite_find("paper", NULL);
    assert_non_null(suite);
    assert_int_equal(suite->entry_count, 3);
    for (int i = 0; i < 3; ++i) {
        assert_string_equal(suite->entries[i].scenario, "tower");
        assert_string_equal(suite->entries[i].setting, towers[i]);
        assert_close(suite->entries[i].published, iterations[i], 0, 0);
    }
    assert_string_equal(suite->published_metric, "iterations_mean");
    assert_contains(suite->source, "Table 2");
}

static void test_suites_name_known_scenarios_and_settings(void **state)
{
    (void)state;
    int count;
    const pl_suite *suites = pl_suites(&count);
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < suites[i].entry_count; ++k) {
            const pl_suite_entry *entry = &suites[i].entries[k];
            pl_scene scene;
            build_scenario(entry->scenario, &entry->setting, entry->setting == NULL ? 0 : 1, 0,
                           &scene);
            pl_scene_free(&scene);
        }
        assert_true((suites[i].published_metric == NULL) == (suites[i].source == NULL));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_scenario_is_complete_and_builds),
        cmocka_unit_test(test_every_scenario_states_a_reasoned_acceptance),
        cmocka_unit_test(test_needs_are_those_of_the_default_scene),
        cmocka_unit_test(test_same_seed_gives_the_same_scene_and_file),
        cmocka_unit_test(test_every_scene_reads_back_from_its_file),
        cmocka_unit_test(test_dt_and_duration_reach_the_scene),
        cmocka_unit_test(test_bad_settings_are_refused),
        cmocka_unit_test(test_unknown_names_get_the_nearest),
        cmocka_unit_test(test_canonical_suite_is_these_in_order),
        cmocka_unit_test(test_paper_suite_holds_the_table_of_the_source),
        cmocka_unit_test(test_suites_name_known_scenarios_and_settings),
    };
    return cmocka_run_group_tests_name("catalogue", tests, NULL, NULL);
}
