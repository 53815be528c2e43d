/* What plumb:accurate must reach at h = 1/60 s: the laws of rest, of friction and of collapse,
 * through the runner and by the referee's metrics. */
#include "engines/registry.h"

#include "check.h"
#include "plumb_process.h"
#include "run_result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char engine[] = "plumb:accurate";
static const double gravity = 9.81; /* m/s^2 */
static const double frictions[] = {0.1, 0.5, 1};
enum { FRICTION_COUNT = 3 };

/* One run with up to 16 further arguments (NULL-terminated). */
static json_t *run_accurate(const char *scenario, const char *const *options)
{
    const char *arguments[32] = {"run",    scenario, "--engine",  engine,
                                 "--json", "-",      "--timeout", "300"};
    int count = 8;
    for (; *options != NULL; ++options) {
        assert_true(count < 31);
        arguments[count++] = *options;
    }
    return run_to_json(arguments);
}

/* A run whose violations are all reported before the test fails. */
typedef struct judged {
    const char *what;
    json_t *result;
    int violations;
} judged;

static void judge_bound(judged *j, const char *name, double value, double bound)
{
    if (!(value <= bound)) {
        print_error("%s: %s is %g, at most %g is due\n", j->what, name, value, bound);
        j->violations += 1;
    }
}

static void judge_metric(judged *j, const char *name, double bound)
{
    judge_bound(j, name, metric(j->result, name), bound);
}

/* All but one step in twenty. */
static void judge_most_residuals(judged *j, double bound)
{
    judge_bound(j, "residual p95", metric_percentile(j->result, "residual_max", "p95"), bound);
}

static judged judge_begin(const char *what, json_t *result)
{
    judged j = {.what = what, .result = result};
    if (strcmp(result_text(result, "outcome"), "ok") != 0) {
        print_error("%s: %s: %s\n", what, result_text(result, "outcome"),
                    result_text(result, "reason"));
        j.violations = 1;
    }
    return j;
}

/* Returns the violations. */
static int judge_end(judged *j)
{
    json_decref(j->result);
    return j->violations;
}

/* Standing structures stay within a micrometre, with every step solved, and almost no work. */
static int violations_at_rest(const char *scenario, const char *const *options, const char *what)
{
    judged j = judge_begin(what, run_accurate(scenario, options));
    judge_metric(&j, "rest_position_error", 1e-6);
    judge_metric(&j, "drift", 1e-6);
    judge_metric(&j, "residual_max", 1e-8);
    judge_metric(&j, "iterations_mean", 2);
    judge_metric(&j, "iterations_max", 15);
    return judge_end(&j);
}

static void test_towers_stand_exactly_with_two_iterations_a_step(void **state)
{
    (void)state;
    static const char *const sizes[] = {"n=5", "n=25", "n=100", "n=400", "n=1000"};
    static const char *const durations[] = {"60", "60", "60", "10", "5"};
    int violations = 0;
    for (int i = 0; i < 5; ++i) {
        const char *const options[] = {"--set", sizes[i], "--duration", durations[i], NULL};
        violations += violations_at_rest("tower", options, sizes[i]);
    }
    assert_int_equal(violations, 0);
}

static void test_heavy_loads_on_light_cubes_stand_exactly(void **state)
{
    (void)state;
    static const char *const top[] = {"--set", "n=100", "--set", "top_mass=1000", NULL};
    static const char *const rising[] = {"--set", "n=100", "--set", "rising_mass=1000", NULL};
    static const char *const ratio[] = {"--set", "k=6", NULL};
    int violations = violations_at_rest("tower", top, "tower of 100, top 1000 times as heavy");
    violations += violations_at_rest("tower", rising, "tower of 100, masses rising to 1000");
    violations += violations_at_rest("mass-ratio", ratio, "a million on one");
    assert_int_equal(violations, 0);
}

static void test_displaced_towers_of_a_hundred_stand(void **state)
{
    (void)state;
    static const char *const seeds[] = {"1", "2", "3"};
    int violations = 0;
    for (int i = 0; i < 3; ++i) {
        const char *const options[] = {"--set",  "n=100",      "--set", "offset=0.05", "--seed",
                                       seeds[i], "--duration", "10",    NULL};
        judged j = judge_begin(seeds[i], run_accurate("tower", options));
        judge_metric(&j, "residual_max", 1e-6);
        judge_metric(&j, "iterations_max", 60);
        violations += judge_end(&j);
    }
    assert_int_equal(violations, 0);
}

/* A block of 1 x 1 x 0.5 m on a plane of any angle (rad), expected to rest, as a scene file. The
 * catalogue's slopes know on which side of the threshold they are. */
static void write_slope(const char *path, double friction, double angle)
{
    char text[2048];
    double s = sin(angle), c = cos(angle);
    (void)snprintf(
        text, sizeof text,
        "{ \"plumb_scene\": 1, \"name\": \"threshold\",\n"
        "  \"materials\": { \"block\": { \"friction\": %.17g, \"restitution\": 0 } },\n"
        "  \"bodies\": [\n"
        "    { \"name\": \"slope\", \"static\": true, \"material\": \"block\",\n"
        "      \"shape\": { \"type\": \"plane\", \"normal\": [%.17g, 0, %.17g], \"offset\": 0 } "
        "},\n"
        "    { \"name\": \"block\", \"mass\": 1, \"material\": \"block\",\n"
        "      \"shape\": { \"type\": \"box\", \"half_extents\": [0.5, 0.5, 0.25] },\n"
        "      \"position\": [%.17g, 0, %.17g], \"orientation\": [%.17g, 0, %.17g, 0] } ] }\n",
        friction, s, c, s / 4, c / 4, cos(angle / 2), sin(angle / 2));
    write_text(path, text);
}

/* How far downhill body 1 ends. */
static double end_downhill(const char *path, double angle, const char *duration)
{
    const char *const options[] = {"--duration", duration, NULL};
    json_t *result = run_accurate(path, options);
    const json_t *pose = json_array_get(json_object_get(result, "final_poses"), 1);
    double x = json_number_value(json_array_get(pose, 0));
    double z = json_number_value(json_array_get(pose, 2));
    assert_string_equal(result_text(result, "outcome"), "ok");
    json_decref(result);
    return x * cos(angle) - z * sin(angle);
}

/* By the creep from 2 s to 4 s, when what the first steps left of speed is used up: v to start with
 * takes v / (10 m/s^2 x the angle below the threshold) to stop. A block that slides, `beyond` rad
 * above the threshold, has a = g beyond / cos(threshold), and 3 s x a then on the mean. The line
 * between holding and sliding is that of 2e-9 rad beyond, 6e-8 m/s. */
static bool sticks(const char *path, double friction, double angle)
{
    const double beyond = 2e-9;
    write_slope(path, friction, angle);
    double creep = (end_downhill(path, angle, "4") - end_downhill(path, angle, "2")) / 2;
    return creep < 3 * gravity * beyond / cos(atan(friction));
}

static void test_friction_holds_up_to_its_angle(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *path = path_in(directory, "slope.json");
    double found[FRICTION_COUNT];
    for (int i = 0; i < FRICTION_COUNT; ++i) {
        double low = atan(frictions[i]) - 1e-3, high = atan(frictions[i]) + 1e-3;
        assert_true(sticks(path, frictions[i], low));
        assert_false(sticks(path, frictions[i], high));
        while (high - low > 1e-9) {
            double middle = low + (high - low) / 2;
            *(sticks(path, frictions[i], middle) ? &low : &high) = middle;
        }
        found[i] = low + (high - low) / 2;
    }
    free(path);
    remove_directory(directory);
    for (int i = 0; i < FRICTION_COUNT; ++i) {
        assert_close(found[i], atan(frictions[i]), 1e-8, 0);
    }
}

/* One of the catalogue's slopes at `part` of the threshold's angle. */
static json_t *run_slope(const char *scenario, double friction, double part, const char *duration)
{
    char friction_text[48], angle_text[48];
    (void)snprintf(friction_text, sizeof friction_text, "friction=%.17g", friction);
    (void)snprintf(angle_text, sizeof angle_text, "angle=%.17g", part * atan(friction));
    const char *const options[] = {"--set",      friction_text, "--set", angle_text,
                                   "--duration", duration,      NULL};
    return run_accurate(scenario, options);
}

static void test_block_just_below_the_angle_stays(void **state)
{
    (void)state;
    int violations = 0;
    for (int i = 0; i < FRICTION_COUNT; ++i) {
        char what[48];
        (void)snprintf(what, sizeof what, "friction %g", frictions[i]);
        judged j = judge_begin(what, run_slope("slope-stick", frictions[i], 0.999, "10"));
        judge_metric(&j, "creep", 1e-10);
        violations += judge_end(&j);
    }
    assert_int_equal(violations, 0);
}

static void test_block_just_above_the_angle_slides(void **state)
{
    (void)state;
    int violations = 0;
    for (int i = 0; i < FRICTION_COUNT; ++i) {
        char what[48];
        (void)snprintf(what, sizeof what, "friction %g", frictions[i]);
        judged j = judge_begin(what, run_slope("slope-slide", frictions[i], 1.001, "2"));
        judge_metric(&j, "lift", 1e-9);
        judge_metric(&j, "travel_error", 0.5); /* it does slide */
        violations += judge_end(&j);
    }
    assert_int_equal(violations, 0);
}

/* Of body 1 along the azimuth (degrees), which starts over the origin. */
static double distance_slid(const json_t *result, double azimuth)
{
    const json_t *pose = json_array_get(json_object_get(result, "final_poses"), 1);
    double angle = azimuth * atan(1) / 45;
    return json_number_value(json_array_get(pose, 0)) * cos(angle) +
           json_number_value(json_array_get(pose, 1)) * sin(angle);
}

static void test_pushed_block_stops_equally_in_all_directions(void **state)
{
    (void)state;
    double least = HUGE_VAL, most = 0;
    int violations = 0;
    for (int azimuth = 0; azimuth <= 90; azimuth += 5) {
        char what[48];
        (void)snprintf(what, sizeof what, "azimuth=%d", azimuth);
        const char *const options[] = {"--set", what, NULL};
        judged j = judge_begin(what, run_accurate("slide-to-stop", options));
        judge_metric(&j, "travel_error", 2e-4);
        least = fmin(least, distance_slid(j.result, azimuth));
        most = fmax(most, distance_slid(j.result, azimuth));
        violations += judge_end(&j);
    }
    assert_int_equal(violations, 0);
    assert_close(least, most, 0, 1e-9);
}

static void test_a_wall_of_a_thousand_rests_exactly(void **state)
{
    (void)state;
    static const char *const options[] = {"--set",      "rows=25", "--set", "columns=40",
                                          "--duration", "5",       NULL};
    judged j = judge_begin("wall 25 x 40", run_accurate("wall", options));
    judge_metric(&j, "rest_position_error", 1e-6);
    assert_int_equal(judge_end(&j), 0);
}

static void test_a_small_wall_collapses_with_its_steps_solved(void **state)
{
    (void)state;
    static const char *const options[] = {"--set", "rows=10", "--set", "columns=10", NULL};
    judged j = judge_begin("collapse of 10 x 10", run_accurate("wall-collapse", options));
    judge_most_residuals(&j, 1e-4);
    assert_int_equal(judge_end(&j), 0);
}

static void test_thousand_brick_wall_collapses_without_energy_gain(void **state)
{
    (void)state;
    static const char *const options[] = {"--set", "rows=25", "--set", "columns=40", NULL};
    judged j = judge_begin("collapse of 25 x 40", run_accurate("wall-collapse", options));
    judge_metric(&j, "penetration_max", 1e-3);
    judge_metric(&j, "energy_step_gain", 1e-8);
    judge_most_residuals(&j, 1e-2);
    assert_int_equal(judge_end(&j), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_towers_stand_exactly_with_two_iterations_a_step),
        cmocka_unit_test(test_heavy_loads_on_light_cubes_stand_exactly),
        cmocka_unit_test(test_displaced_towers_of_a_hundred_stand),
        cmocka_unit_test(test_friction_holds_up_to_its_angle),
        cmocka_unit_test(test_block_just_below_the_angle_stays),
        cmocka_unit_test(test_block_just_above_the_angle_slides),
        cmocka_unit_test(test_pushed_block_stops_equally_in_all_directions),
        cmocka_unit_test(test_a_wall_of_a_thousand_rests_exactly),
        cmocka_unit_test(test_a_small_wall_collapses_with_its_steps_solved),
        cmocka_unit_test(test_thousand_brick_wall_collapses_without_energy_gain),
    };
    return cmocka_run_group_tests_name("accurate", tests, NULL, NULL);
}
