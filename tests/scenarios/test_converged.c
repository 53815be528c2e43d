/* The end statistics of converged runs belong to their own parameters alone. */
#include "check.h"
#include "scenario_scene.h"

#include <string.h>

static int statistics_of(const char *scenario, const char *const *settings, int count,
                         uint64_t seed)
{
    pl_scene scene;
    build_scenario(scenario, settings, count, seed, &scene);
    const int found = scene.statistic_count;
    pl_scene_free(&scene);
    return found;
}

static void test_statistics_hold_for_their_own_parameters(void **state)
{
    (void)state;
    static const char *const any_step[] = {"dt=0.001"};
    static const char *const others[] = {"friction=0.4", "duration=3", "n=26"};
    const int known = statistics_of("falling-cubes", NULL, 0, 0);
    assert_true(known > 0);
    assert_int_equal(statistics_of("falling-cubes", any_step, 1, 0), known);
    for (int i = 0; i < 3; ++i) {
        assert_int_equal(statistics_of("falling-cubes", &others[i], 1, 0), 0);
    }
}

static void test_every_chaotic_scenario_has_statistics(void **state)
{
    (void)state;
    int count, chaotic = 0;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        if (strcmp(scenarios[i]->primary_error, "chaotic_error") == 0) {
            /* That of rain is its own: its energy lost from impact to impact. */
            const int least = strcmp(scenarios[i]->name, "rain") == 0 ? 1 : 2;
            assert_true(statistics_of(scenarios[i]->name, NULL, 0, 0) >= least);
            ++chaotic;
        } else {
            assert_int_equal(statistics_of(scenarios[i]->name, NULL, 0, 0), 0);
        }
    }
    assert_int_equal(chaotic, 11);
}

static void test_other_seeds_draw_another_scene(void **state)
{
    (void)state;
    assert_int_equal(statistics_of("falling-cubes", NULL, 0, 1), 0);
    /* Nothing is drawn. */
    assert_int_equal(statistics_of("dominoes", NULL, 0, 1), statistics_of("dominoes", NULL, 0, 0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_statistics_hold_for_their_own_parameters),
        cmocka_unit_test(test_every_chaotic_scenario_has_statistics),
        cmocka_unit_test(test_other_seeds_draw_another_scene),
    };
    return cmocka_run_group_tests_name("converged", tests, NULL, NULL);
}
