/* Parameters of scene files: an expression gives the scene that its number gives, and what is wrong with
 * one is said with its line, column and field. */
#include "check.h"
#include "plumb/scenario.h"
#include "text_fault.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char with_parameters[] =
    "{ \"plumb_scene\": 1, \"dt\": \"1/rate\", \"duration\": \"2*v/(mu*9.81)\",\n"
    "  \"parameters\": { \"mu\": { \"value\": 0.5, \"low\": 0.1, \"high\": 1, \"unit\": \"1\",\n"
    "                           \"description\": \"friction of all bodies\" },\n"
    "    \"v\": 4, \"rate\": 100, \"r\": 0.25, \"push\": 0 },\n"
    "  \"gravity\": [0, 0, \"-9.81\"],\n"
    "  \"materials\": { \"m\": { \"friction\": \"mu\", \"restitution\": \"mu*mu\" },\n"
    "                 \"n\": { \"friction\": 0, \"restitution\": 0 } },\n"
    "  \"pairs\": [ { \"a\": \"m\", \"b\": \"n\", \"friction\": \"mu/2\", \"restitution\": 0 } ],\n"
    "  \"shapes\": { \"tetra\": { \"type\": \"hull\",\n"
    "    \"points\": [[0, 0, 0], [\"r\", 0, 0], [0, \"r\", 0], [0, 0, \"r\"]] } },\n"
    "  \"bodies\": [\n"
    "    { \"name\": \"floor\", \"material\": \"n\",\n"
    "      \"shape\": { \"type\": \"plane\", \"normal\": [0, 0, 1], \"offset\": \"r-r\" } },\n"
    "    { \"name\": \"ball\", \"material\": \"m\", \"density\": \"1000*r\",\n"
    "      \"shape\": { \"type\": \"sphere\", \"radius\": \"r\" }, \"position\": [0, 0, \"2*r\"],\n"
    "      \"orientation\": [\"cos(pi/8)\", 0, 0, \"sin(pi/8)\"],\n"
    "      \"velocity\": [\"v\", 0, 0], \"forces\": [ { \"force\": [\"push\", 0, 0], \"until\": "
    "\"r\" } ] },\n"
    "    { \"name\": \"stone\", \"material\": \"m\", \"mass\": 1, \"shape\": \"tetra\",\n"
    "      \"position\": [5, 0, 3] } ],\n"
    "  \"expect\": { \"values\": [ { \"body\": \"ball\", \"quantity\": \"position\",\n"
    "      \"direction\": [1, 0, 0], \"value\": \"v*v/(2*mu*9.81)\" } ] } }\n";

/* Reads a text that must be right. */
static pl_scene read_text(const char *text)
{
    pl_scene scene;
    pl_error error = {.message = ""};
    if (pl_scene_read_text(text, strlen(text), "text", &scene, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return scene;
}

static void test_substituted_scene_has_the_written_one_s_hash(void **state)
{
    (void)state;
    char *text = strdup(with_parameters);
    static const char *const numbers[][2] = {{"\"1/rate\"", "0.01"},
                                             {"\"2*v/(mu*9.81)\"", "1.6309887869520896"},
                                             {"\"mu\"", "0.5"},
                                             {"\"mu*mu\"", "0.25"},
                                             {"\"mu/2\"", "0.25"},
                                             {"\"r\"", "0.25"},
                                             {"\"r\"", "0.25"},
                                             {"\"r\"", "0.25"},
                                             {"\"r-r\"", "0"},
                                             {"\"1000*r\"", "250"},
                                             {"\"r\"", "0.25"},
                                             {"\"2*r\"", "0.5"},
                                             {"\"cos(pi/8)\"", "0.92387953251128674"},
                                             {"\"sin(pi/8)\"", "0.38268343236508978"},
                                             {"\"v\"", "4"},
                                             {"\"push\"", "0"},
                                             {"\"r\"", "0.25"},
                                             {"\"v*v/(2*mu*9.81)\"", "1.6309887869520896"},
                                             {"\"-9.81\"", "-9.81"}};
    pl_scene scene = read_text(text);
    /* Without parameters, the same text with numbers. */
    char *begin = strstr(text, "\"parameters\""), *end = strstr(text, "\"gravity\"");
    memmove(begin, end, strlen(end) + 1);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        char *next = text_with(text, numbers[i][0], numbers[i][1]);
        free(text);
        text = next;
    }
    pl_scene plain = read_text(text);
    char hash[17], plain_hash[17];
    assert_int_equal(pl_scene_hash(&scene, hash, NULL), PL_OK);
    assert_int_equal(pl_scene_hash(&plain, plain_hash, NULL), PL_OK);
    char *one = pl_scene_to_text(&scene), *other = pl_scene_to_text(&plain);
    assert_string_equal(one, other);
    assert_string_equal(hash, plain_hash);
    assert_absent(one, "parameters");
    free(one);
    free(other);
    free(text);
    pl_scene_free(&scene);
    pl_scene_free(&plain);
}

static void test_bad_parameters_are_located(void **state)
{
    (void)state;
    static const text_fault faults[] = {
        {"\"v\": 4,", "\"v\": 4, @\"w\": 4,", "parameters.w",
         "a field that uses the parameter, found none"},
        {"\"v\": 4,", "\"v\": 4, @\"pi\": 4,", "parameters.pi",
         "expected a name of at most 63 letters"},
        {"\"v\": 4,", "\"v\": 4, @\"dt\": 4,", "parameters.dt", "expected a name"},
        {"\"v\": 4,", "\"v\": 4, @\"2v\": 4,", "parameters[\"2v\"]", "expected a name"},
        {"\"v\": 4,", "\"v\": @\"4\",", "parameters.v", "expected a number or an object, found"},
        {"\"low\": 0.1", "@\"lo\": 0.1", "parameters.mu.lo", "did you mean \"low\"?"},
        {"\"value\": 0.5", "\"value\": @2", "parameters.mu.value",
         "expected a number from 0.1 to 1"},
        {"\"high\": 1", "\"high\": @0.1", "parameters.mu.high", "expected a number above low, 0.1"},
        {"\"value\": 0.5, ", "", "parameters.mu.value", "expected a number, found nothing"},
        {"\"radius\": \"r\"", "\"radius\": @\"r*q\"", "bodies[1].shape.radius",
         "found \"q\" at character 3 of \"r*q\""},
        {"\"friction\": \"mu\"", "\"friction\": @\"m\"", "materials.m.friction",
         "did you mean \"mu\"?"},
        {"[\"r\", 0, 0]", "[@\"r/0\", 0, 0]", "shapes.tetra.points[1][0]", "other than 0"},
        {"\"until\": \"r\"", "\"until\": @\"r(\"", "bodies[1].forces[0].until",
         "expected an operator or the end"},
        {"\"value\": \"v*v", "\"value\": @\"v**v", "expect.values[0].value", "found '*'"},
        {"\"radius\": \"r\"", "\"radius\": @\"-r\"", "bodies[1].shape.radius",
         "above 0, found -0.25"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; ++i) {
        char *text = text_with(with_parameters, faults[i].from, faults[i].to);
        int line = 0, column = 0;
        const bool has_mark = strchr(faults[i].to, '@') != NULL;
        if (has_mark) {
            take_mark(text, &line, &column);
        }
        pl_scene scene;
        pl_error error = {.message = ""};
        char expected[128];
        assert_int_equal(pl_scene_read_text(text, strlen(text), "bad.json", &scene, &error),
                         PL_BAD_INPUT);
        snprintf(expected, sizeof expected, "bad.json:%d:%d: %s: ", line, column, faults[i].path);
        assert_contains(error.message, has_mark ? expected : faults[i].path);
        assert_contains(error.message, faults[i].part);
        assert_null(scene.bodies);
        free(text);
    }
}

static void test_words_stay_words(void **state)
{
    (void)state;
    /* A body, a material and a shape with the name of a parameter. */
    static const char text[] =
        "{ \"plumb_scene\": 1, \"name\": \"r\", \"parameters\": { \"r\": 2 },\n"
        "  \"materials\": { \"r\": { \"friction\": 0, \"restitution\": 0 } },\n"
        "  \"shapes\": { \"r\": { \"type\": \"sphere\", \"radius\": \"r\" } },\n"
        "  \"bodies\": [ { \"name\": \"r\", \"mass\": 1, \"material\": \"r\", \"shape\": \"r\" } ] "
        "}";
    pl_scene scene = read_text(text);
    assert_string_equal(scene.name, "r");
    assert_string_equal(scene.bodies[0].name, "r");
    assert_close(scene.bodies[0].shape.radius, 2, 0, 0);
    pl_scene_free(&scene);
}

/* A file with `text`, open as a scenario. */
static pl_scenario *open_text(const char *text)
{
    char path[] = "/tmp/plumb_parameters_XXXXXX";
    const int file = mkstemp(path);
    pl_scenario *scenario = NULL;
    pl_error error = {.message = ""};
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), strlen(text));
    close(file);
    const pl_status status = pl_scenario_open_file(path, &scenario, &error);
    unlink(path);
    if (status != PL_OK) {
        fail_msg("%s", error.message);
    }
    return scenario;
}

static void test_file_is_a_scenario_with_its_parameters(void **state)
{
    (void)state;
    pl_scenario *scenario = open_text(with_parameters);
    double values[PL_MAX_PARAMS];
    pl_scene scene;
    pl_error error = {.message = ""};
    const char *const set[] = {"mu=0.25,v=2"}, *const far[] = {"mu=2"}, *const unknown[] = {"nu=1"};
    assert_int_equal(scenario->param_count, 7);
    assert_string_equal(scenario->params[0].help, "friction of all bodies");
    assert_close(scenario->params[0].max, 1, 0, 0);
    assert_int_equal(pl_scenario_values(scenario, far, 1, values, &error), PL_BAD_INPUT);
    assert_contains(error.message, "mu: expected 0.1 to 1 (1), found 2");
    assert_int_equal(pl_scenario_values(scenario, unknown, 1, values, &error), PL_BAD_INPUT);
    assert_contains(error.message, "did you mean \"mu\"?");
    assert_int_equal(pl_scenario_values(scenario, set, 1, values, &error), PL_OK);
    assert_int_equal(pl_scenario_build(scenario, values, 0, &scene, &error), PL_OK);
    assert_close(scene.materials[0].friction, 0.25, 0, 0);
    assert_close(scene.values[0].value, 2 * 2 / (2 * 0.25 * 9.81), 0, 1e-15);
    assert_close(scene.duration, 2 * 2 / (0.25 * 9.81), 0, 1e-15);
    assert_close(scene.dt, 0.01, 0, 0);
    pl_scene_free(&scene);
    pl_scenario_close_file(scenario);
}

static void test_given_times_replace_a_file_s_own(void **state)
{
    (void)state;
    char *text = text_with(with_parameters, "\"value\": \"v*v/(2*mu*9.81)\"",
                           "\"value\": \"v\", \"discrete\": \"v+mu\"");
    pl_scenario *scenario = open_text(text);
    double values[PL_MAX_PARAMS];
    pl_scene scene;
    pl_error error = {.message = ""};
    static const struct {
        const char *setting;
        bool keeps;
    } cases[] = {{"v=4", true}, {"dt=0.01", true}, {"dt=0.02", false}};
    for (int i = 0; i < 3; ++i) {
        assert_int_equal(pl_scenario_values(scenario, &cases[i].setting, 1, values, &error), PL_OK);
        assert_int_equal(pl_scenario_build(scenario, values, 0, &scene, &error), PL_OK);
        assert_true(isnan(scene.values[0].discrete) != cases[i].keeps);
        pl_scene_free(&scene);
    }
    const char *duration = "duration=1";
    assert_int_equal(pl_scenario_values(scenario, &duration, 1, values, &error), PL_OK);
    assert_int_equal(pl_scenario_build(scenario, values, 0, &scene, &error), PL_BAD_INPUT);
    assert_contains(error.message, "--duration cannot replace");
    pl_scenario_close_file(scenario);
    free(text);
}

static void test_escaped_key_is_the_same_key(void **state)
{
    (void)state;
    char *text = text_with(with_parameters, "\"parameters\"", "\"p\\u0061rameters\"");
    pl_scenario *scenario = open_text(text);
    assert_int_equal(scenario->param_count, 7);
    pl_scenario_close_file(scenario);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_substituted_scene_has_the_written_one_s_hash),
        cmocka_unit_test(test_bad_parameters_are_located),
        cmocka_unit_test(test_words_stay_words),
        cmocka_unit_test(test_file_is_a_scenario_with_its_parameters),
        cmocka_unit_test(test_given_times_replace_a_file_s_own),
        cmocka_unit_test(test_escaped_key_is_the_same_key)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
