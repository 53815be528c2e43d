/* The canonical scenes through the command, on the real engines: what our engine must reach, and
 * that the others behave as they are known to. */
#include "check.h"
#include "plumb_process.h"
#include "run_result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One run; `set` is a NAME=VALUE or NULL. The caller decrefs. */
static json_t *run(const char *scenario, const char *set, const char *engine)
{
    const char *const arguments[] = {
        "run", scenario, "--engine", engine, "--json", "-", set ? "--set" : NULL, set, NULL};
    return run_to_json(arguments);
}

static void test_tower_of_ten_rests_within_0_1_mm(void **state)
{
    (void)state;
    json_t *r = run("tower", "n=10", "plumb");
    assert_string_equal(result_text(r, "schema"), "plumb.result/1");
    assert_string_equal(result_text(r, "outcome"), "ok");
    assert_close(metric(r, "rest_position_error"), 0, 1e-4, 0);
    assert_close(metric(r, "drift"), 0, 1e-4, 0);
    assert_at_most(metric(r, "residual_max"), 1e-8);
    assert_true(metric(r, "iterations_mean") > 0);
    assert_int_equal(json_integer_value(json_object_get(json_object_get(r, "steps"), "done")), 600);
    json_decref(r);
}

static void expect_within_a_factor_of_two(const char *set, const char *engine, double known)
{
    json_t *r = run("tower", set, engine);
    double error = metric(r, "rest_position_error");
    json_decref(r);
    if (!(error >= known / 2 && error <= known * 2)) {
        fail_msg("tower %s on %s: off by %g m, known to be off by %g m", set, engine, error, known);
    }
}

/* Largest displacement of a cube after 600 steps of 1/60 s, measured outside this project with each
 * library's own interface; ODE's are single samples of a scatter (its solver shuffles its rows). */
static void test_towers_on_ode_and_bullet_fail_as_known(void **state)
{
    (void)state;
    expect_within_a_factor_of_two("n=5", "ode:quick", 9.9e-3);
    expect_within_a_factor_of_two("n=10", "ode:quick", 0.14);
    expect_within_a_factor_of_two("n=5", "ode:dantzig", 7.6e-3);
    expect_within_a_factor_of_two("n=5", "bullet:si", 4.8e-2);
    expect_within_a_factor_of_two("n=10", "bullet:si", 0.80);
    expect_within_a_factor_of_two("n=5", "bullet:nncg,iterations=50", 1.3e-2);
    expect_within_a_factor_of_two("n=10", "bullet:nncg,iterations=50", 2.0e-2);
    const char *const falling[] = {"ode:quick", "ode:dantzig", "bullet:si"};
    for (size_t i = 0; i < sizeof falling / sizeof falling[0]; ++i) {
        json_t *r = run("tower", "n=25", falling[i]);
        assert_string_equal(result_text(r, "outcome"), "collapsed");
        json_decref(r);
    }
}

static void test_slopes_slide_and_stick_as_coulomb_says(void **state)
{
    (void)state;
    json_t *slide = run("slope-slide", NULL, "plumb");
    assert_close(metric(slide, "travel_error"), 0, 1e-9, 0);
    json_decref(slide);
    slide = run("slope-slide", NULL, "ode:dantzig");
    /* ODE moves by semi-implicit Euler, whose own answer is nearer to its travel. */
    assert_at_most(metric(slide, "discrete_error"), 0.5 * metric(slide, "travel_error"));
    json_decref(slide);
    json_t *stick = run("slope-stick", NULL, "plumb");
    assert_close(metric(stick, "rest_position_error"), 0, 1e-6, 0);
    assert_close(metric(stick, "drift"), 0, 1e-6, 0);
    json_decref(stick);
}

static void test_wall_of_a_hundred_stands_ten_seconds(void **state)
{
    (void)state;
    json_t *r = run("wall", NULL, "plumb");
    assert_string_equal(result_text(r, "outcome"), "ok");
    assert_close(metric(r, "rest_position_error"), 0, 1e-3, 0);
    json_decref(r);
}

static void test_thousand_brick_wall_crashes_no_engine(void **state)
{
    (void)state;
    const char *const engines[] = {"plumb", "ode:quick", "bullet:si", "bullet:nncg"};
    for (size_t i = 0; i < sizeof engines / sizeof engines[0]; ++i) {
        const char *const arguments[] = {
            "run",      "wall-collapse", "--set", "rows=25",   "--set", "columns=40", "--engine",
            engines[i], "--json",        "-",     "--timeout", "300",   NULL};
        json_t *r = run_to_json(arguments);
        assert_string_equal(result_text(r, "outcome"), "ok");
        assert_int_equal(json_integer_value(json_object_get(json_object_get(r, "steps"), "done")),
                         300);
        if (i == 0) {
            assert_close(metric(r, "energy_gain"), 0, 1e-6, 0);
        }
        json_decref(r);
    }
}

static void test_two_runs_give_the_same_hash(void **state)
{
    (void)state;
    char hash[2][32];
    for (int i = 0; i < 2; ++i) {
        json_t *r = run("wall-collapse", "rows=6", "plumb");
        const json_t *m = json_object_get(json_object_get(r, "metrics"), "state_hash");
        snprintf(hash[i], sizeof hash[i], "%s", json_string_value(json_object_get(m, "value")));
        json_decref(r);
    }
    assert_int_equal(strlen(hash[0]), 16);
    assert_string_equal(hash[0], hash[1]);
}

static const char two_boxes[] =
    "{ \"plumb_scene\": 1, \"name\": \"two boxes\", \"duration\": 2,\n"
    "  \"materials\": { \"wood\": { \"friction\": 0.5, \"restitution\": 0 } },\n"
    "  \"bodies\": [\n"
    "    { \"name\": \"floor\", \"static\": true, \"material\": \"wood\",\n"
    "      \"shape\": { \"type\": \"plane\", \"normal\": [0, 0, 1], \"offset\": 0 } },\n"
    "    { \"name\": \"lower\", \"mass\": 2, \"material\": \"wood\", \"position\": [0, 0, 0.5],\n"
    "      \"shape\": { \"type\": \"box\", \"half_extents\": [0.5, 0.5, 0.5] } },\n"
    "    { \"name\": \"upper\", \"density\": 1000, \"material\": \"wood\", \"position\": [0.1, 0, "
    "1.1],\n"
    "      \"shape\": { \"type\": \"box\", \"half_extents\": [0.3, 0.2, 0.1] } } ],\n"
    "  \"expect\": { \"rest\": [ { \"body\": \"lower\", \"position\": [0, 0, 0.5] },\n"
    "                        { \"body\": \"upper\", \"position\": [0.1, 0, 1.1] } ] } }\n";

static void test_user_scene_runs_on_all_engines(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *path = path_in(directory, "two boxes.json");
    write_text(path, two_boxes);
    const char *const engines[] = {"plumb", "ode", "bullet"};
    /* 48 kg on 2 kg: the reference engines press the lower box into the floor, by as much as they
     * do. */
    const double bound[] = {1e-7, 0.1, 0.1};
    for (int i = 0; i < 3; ++i) {
        json_t *r = run(path, NULL, engines[i]);
        assert_string_equal(result_text(r, "outcome"), "ok");
        assert_string_equal(result_text(r, "primary_error"), "rest_position_error");
        assert_close(metric(r, "reference_error"), 0, bound[i], 0);
        json_decref(r);
    }
    free(path);
    remove_directory(directory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tower_of_ten_rests_within_0_1_mm),
        cmocka_unit_test(test_towers_on_ode_and_bullet_fail_as_known),
        cmocka_unit_test(test_slopes_slide_and_stick_as_coulomb_says),
        cmocka_unit_test(test_wall_of_a_hundred_stands_ten_seconds),
        cmocka_unit_test(test_thousand_brick_wall_crashes_no_engine),
        cmocka_unit_test(test_two_runs_give_the_same_hash),
        cmocka_unit_test(test_user_scene_runs_on_all_engines),
    };
    return cmocka_run_group_tests_name("canonical", tests, NULL, NULL);
}
