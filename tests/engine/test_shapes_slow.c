/* What every profile must reach with every shape at h = 1/60 s: rest, rolling, flight at a wall,
 * and a ring that hangs in a ring; through the runner and by the referee's metrics. */
#include "check.h"
#include "run_result.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char *const profiles[] = {"plumb:default", "plumb:accurate", "plumb:fast"};
enum { PROFILE_COUNT = 3 };

/* One run; up to four settings, NULL-terminated. */
static json_t *run(const char *scenario, const char *profile, const char *const *settings)
{
    const char *arguments[20] = {"run", scenario, "--engine", profile, "--json", "-"};
    int count = 6;
    for (; *settings != NULL; ++settings) {
        arguments[count++] = "--set";
        arguments[count++] = *settings;
    }
    return run_to_json(arguments);
}

/* Tells a violation, so that one run of the test tells all of them. */
static int violated(const json_t *result, const char *what, const char *name, double bound)
{
    double value = metric(result, name);
    if (value <= bound) {
        return 0;
    }
    print_error("%s: %s is %g, at most %g is due; outcome %s\n", what, name, value, bound,
                json_string_value(json_object_get(result, "outcome")));
    return 1;
}

static void test_every_shape_rests_for_10_s(void **state)
{
    (void)state;
    int violations = 0;
    for (int p = 0; p < PROFILE_COUNT; ++p) {
        for (int shape = 0; shape <= 7; ++shape) {
            for (int mesh = 0; mesh <= 1; ++mesh) {
                char shape_is[16], mesh_is[16], what[64];
                snprintf(shape_is, sizeof shape_is, "shape=%d", shape);
                snprintf(mesh_is, sizeof mesh_is, "mesh=%d", mesh);
                snprintf(what, sizeof what, "%s %s %s", profiles[p], shape_is, mesh_is);
                const char *const settings[] = {shape_is, mesh_is, NULL};
                json_t *result = run("rest-shape", profiles[p], settings);
                violations += violated(result, what, "rest_position_error", 1e-6);
                violations += violated(result, what, "rest_rotation_error", 1e-6);
                json_decref(result);
            }
        }
    }
    assert_int_equal(violations, 0);
}

static void test_a_ring_hangs_in_a_ring(void **state)
{
    (void)state;
    int violations = 0;
    for (int p = 0; p < PROFILE_COUNT; ++p) {
        const char *const resting[] = {NULL};
        json_t *result = run("linked-rings", profiles[p], resting);
        violations += violated(result, profiles[p], "rest_position_error", 1e-6);
        json_decref(result);
        /* Dropped, it swings and may come to lie askew, but stays in the ring. */
        const char *const dropped[] = {"drop=0.2", NULL};
        result = run("linked-rings", profiles[p], dropped);
        violations += violated(result, profiles[p], "rest_position_error", 0.1);
        violations += violated(result, profiles[p], "penetration_max",
                               strcmp(profiles[p], "plumb:accurate") == 0 ? 1e-3 : 0.05);
        json_decref(result);
    }
    assert_int_equal(violations, 0);
}

static void test_sphere_and_cylinder_roll_by_their_inertia(void **state)
{
    (void)state;
    int violations = 0;
    static const char *const shapes[] = {"shape=0", "shape=1"};
    for (int p = 0; p < PROFILE_COUNT; ++p) {
        for (int i = 0; i < 2; ++i) {
            const char *const settings[] = {shapes[i], NULL};
            json_t *result = run("roll-slope", profiles[p], settings);
            /* Soft contacts move by semi-implicit Euler in steps of 1/480 s: 1/960 after 2 s. */
            bool soft = strcmp(profiles[p], "plumb:fast") == 0;
            violations += violated(result, profiles[p], "travel_error", soft ? 1.2e-3 : 1e-3);
            json_decref(result);
        }
        const char *const prism[] = {"shape=2", NULL};
        json_t *result = run("roll-slope", profiles[p], prism);
        violations += violated(result, profiles[p], "penetration_max", 5e-3);
        json_decref(result);
    }
    assert_int_equal(violations, 0);
}

static void test_what_flies_at_a_thin_wall_stops_there(void **state)
{
    (void)state;
    int violations = 0;
    static const char *const shapes[] = {"shape=0", "shape=1", "shape=2"};
    static const char *const speeds[] = {"speed=50", "speed=200", "speed=1000"};
    for (int p = 0; p < PROFILE_COUNT; ++p) {
        for (int i = 0; i < 9; ++i) {
            const char *const settings[] = {shapes[i / 3], speeds[i % 3], NULL};
            json_t *result = run("thin-wall", profiles[p], settings);
            violations += violated(result, profiles[p], "rest_position_error", 1e-6);
            json_decref(result);
        }
    }
    assert_int_equal(violations, 0);
}

static void test_a_rocket_flies_as_its_thrust_says(void **state)
{
    (void)state;
    int violations = 0;
    for (int p = 0; p < PROFILE_COUNT; ++p) {
        const char *const on_axis[] = {NULL};
        json_t *result = run("rocket", profiles[p], on_axis);
        violations += violated(result, profiles[p], "travel_error", 1e-12);
        json_decref(result);
        const char *const off_centre[] = {"offset=0.05", NULL};
        result = run("rocket", profiles[p], off_centre);
        violations += violated(result, profiles[p], "travel_error", 1e-3);
        violations += violated(result, profiles[p], "momentum_error", 1e-3);
        json_decref(result);
    }
    assert_int_equal(violations, 0);
}

/* A pile of every shape: nothing sinks into anything for good. */
static void test_a_pile_of_every_shape_holds(void **state)
{
    (void)state;
    const char *const settings[] = {"shape=4", "n=60", "duration=3", NULL};
    json_t *result = run("pile", "plumb:accurate", settings);
    int violations = violated(result, "pile", "penetration_rest", 5e-4) +
                     violated(result, "pile", "energy_step_gain", 1e-8);
    double p95 = metric_percentile(result, "penetration_max", "p95");
    if (!(p95 <= 3e-4)) {
        print_error("pile: 95 %% of the overlaps are below %g, at most 3e-4 is due\n", p95);
        violations += 1;
    }
    json_decref(result);
    assert_int_equal(violations, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_shape_rests_for_10_s),
        cmocka_unit_test(test_a_ring_hangs_in_a_ring),
        cmocka_unit_test(test_sphere_and_cylinder_roll_by_their_inertia),
        cmocka_unit_test(test_what_flies_at_a_thin_wall_stops_there),
        cmocka_unit_test(test_a_rocket_flies_as_its_thrust_says),
        cmocka_unit_test(test_a_pile_of_every_shape_holds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
