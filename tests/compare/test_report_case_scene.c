/* The scenes of cases, built again for the replay, and what the page gets of them. */
#include "report/page_data.h"

#include "check.h"
#include "report_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A ground and two bodies, of which one belongs where it is. */
static pl_scene small_scene(void)
{
    pl_scene scene = pl_scene_default();
    pl_material material = {.name = "m", .friction = 0.5};
    pl_body ground = pl_body_default(), box = pl_body_default(), ball = pl_body_default();
    assert_int_equal(pl_scene_add_material(&scene, &material, NULL, NULL), PL_OK);
    snprintf(ground.name, sizeof ground.name, "ground");
    ground.is_static = true;
    ground.shape = pl_shape_plane(0, 0, 1, 0);
    snprintf(box.name, sizeof box.name, "box");
    box.shape = pl_shape_box(0.5, 0.25, 0.125);
    box.position[2] = 0.125;
    snprintf(ball.name, sizeof ball.name, "ball");
    ball.shape = pl_shape_sphere(0.5);
    ball.position[0] = 3;
    ball.position[2] = 0.5;
    assert_int_equal(pl_scene_add_body(&scene, &ground, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &box, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &ball, NULL, NULL), PL_OK);
    pl_expect_rest rest = {.body = 1, .position = {0, 0, 0.125}};
    assert_int_equal(pl_scene_add_rest(&scene, &rest, NULL), PL_OK);
    return scene;
}

/* A result of one engine on a scene, with the scene's own poses. */
static json_t *result_of(const pl_scene *scene, const char *scenario, json_t *params)
{
    char hash[17];
    assert_int_equal(pl_scene_hash(scene, hash, NULL), PL_OK);
    json_t *poses = json_array();
    for (int i = 0; i < scene->body_count; ++i) {
        const double *p = scene->bodies[i].position, *q = scene->bodies[i].orientation;
        json_array_append_new(
            poses, json_pack("[f, f, f, f, f, f, f]", p[0], p[1], p[2], q[0], q[1], q[2], q[3]));
    }
    return json_pack("[{s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:{}, s:{s:f, s:f}}]", "schema",
                     "plumb.result/1", "scenario", scenario, "engine", "ode", "label", "ode:quick",
                     "outcome", "ok", "scene_hash", hash, "params", params, "final_poses", poses,
                     "metrics", "settings", "dt", scene->dt, "duration", scene->duration);
}

/* The one case of the page's data; takes `results`. The caller releases it. */
static json_t *case_of(json_t *results)
{
    made_report made = make_report(results);
    json_t *data = json_loads(made.data, 0, NULL);
    json_t *found = json_incref(json_array_get(json_object_get(data, "cases"), 0));
    assert_non_null(found);
    json_decref(data);
    free_report(&made);
    return found;
}

/* Writes the scene where `path` says; the caller removes it. */
static void write_scene(const pl_scene *scene, char path[64])
{
    snprintf(path, 64, "/tmp/plumb-scene-XXXXXX");
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    char *text = pl_scene_to_text(scene);
    assert_int_equal(write(descriptor, text, strlen(text)), strlen(text));
    close(descriptor);
    free(text);
}

static void test_every_scenario_of_the_catalogue_is_rebuilt(void **state)
{
    (void)state;
    int count = 0;
    const pl_scenario *const *all = pl_scenarios(&count);
    assert_true(count > 0);
    for (int i = 0; i < count; ++i) {
        double values[PL_MAX_PARAMS];
        pl_scene scene;
        assert_int_equal(pl_scenario_values(all[i], NULL, 0, values, NULL), PL_OK);
        assert_int_equal(pl_scenario_build(all[i], values, 0, &scene, NULL), PL_OK);
        json_t *params = json_object();
        for (int k = 0; k < all[i]->param_count; ++k) {
            json_object_set_new(params, all[i]->params[k].name, json_real(values[k]));
        }
        json_t *found = case_of(result_of(&scene, all[i]->name, params));
        const json_t *bodies = json_object_get(json_object_get(found, "scene"), "bodies");
        assert_int_equal(json_array_size(bodies), scene.body_count);
        json_decref(found);
        pl_scene_free(&scene);
    }
}

static void test_scene_has_shapes_places_and_rests(void **state)
{
    (void)state;
    pl_scene scene = small_scene();
    json_t *json = pl_case_scene_json(&scene);
    char *text = json_dumps(json, JSON_COMPACT);
    assert_contains(text, "\"name\":\"box\",\"static\":false,\"shape\":[\"box\",[0.5,0.25,0.125]],"
                          "\"at\":[0.0,0.0,0.125],\"turn\":[1.0,0.0,0.0,0.0]");
    assert_contains(text, "\"shape\":[\"plane\",[0.0,0.0,1.0,0.0]]");
    assert_contains(text, "\"shape\":[\"sphere\",[0.5,0.0]]");
    assert_contains(text, "\"rests\":[{\"body\":1,\"at\":[0.0,0.0,0.125],\"turn\":null}]");
    free(text);
    json_decref(json);
    pl_scene_free(&scene);
}

static void test_scene_file_is_rebuilt_at_the_runs_step(void **state)
{
    (void)state;
    char path[64];
    pl_scene scene = small_scene();
    write_scene(&scene, path);
    scene.dt = 1.0 / 240; /* as --dt does */
    scene.duration = 2;
    json_t *found = case_of(result_of(&scene, path, json_object()));
    const json_t *built = json_object_get(found, "scene");
    assert_close(json_number_value(json_object_get(built, "dt")), 1.0 / 240, 0, 0);
    json_decref(found);
    unlink(path);
    pl_scene_free(&scene);
}

static void test_changed_scene_gives_a_reason_and_no_scene(void **state)
{
    (void)state;
    char path[64];
    pl_scene scene = small_scene();
    json_t *results = result_of(&scene, "", json_object());
    scene.bodies[1].position[0] = 0.1;
    write_scene(&scene, path);
    json_object_set_new(json_array_get(results, 0), "scenario", json_string(path));
    json_t *found = case_of(results);
    assert_null(json_object_get(found, "scene"));
    assert_contains(json_string_value(json_object_get(found, "scene_error")),
                    "the scene as it is built today");
    json_decref(found);
    unlink(path);
    pl_scene_free(&scene);
}

static void test_unreadable_scene_gives_a_reason_and_no_scene(void **state)
{
    (void)state;
    static const char *const names[] = {
        "/nonexistent.json", "-", "/dev/zero", "/tmp", "", "no such"};
    pl_scene scene = small_scene();
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        json_t *found = case_of(result_of(&scene, names[i], json_object()));
        assert_null(json_object_get(found, "scene"));
        assert_contains(json_string_value(json_object_get(found, "scene_error")),
                        "there is no scene file");
        json_decref(found);
    }
    pl_scene_free(&scene);
}

static void test_final_poses_are_flat_and_rounded(void **state)
{
    (void)state;
    static const struct {
        const char *poses;
        size_t count;
    } rows[] = {
        {"null", 0}, {"7", 0}, {"[[0.12345678,0,0,1,0,0,0]]", 7}, {"[[],null,[\"x\"],{}]", 28}};
    pl_scene scene = small_scene();
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        json_t *results = result_of(&scene, "", json_object());
        json_object_set_new(json_array_get(results, 0), "final_poses",
                            json_loads(rows[i].poses, JSON_DECODE_ANY, NULL));
        json_t *found = case_of(results);
        const json_t *cell = json_array_get(json_object_get(found, "cells"), 0);
        const json_t *final = json_object_get(cell, "final");
        assert_int_equal(json_array_size(final), rows[i].count);
        if (rows[i].count == 7) {
            assert_close(json_number_value(json_array_get(final, 0)), 0.123457, 0, 0);
        }
        json_decref(found);
    }
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_scenario_of_the_catalogue_is_rebuilt),
        cmocka_unit_test(test_scene_has_shapes_places_and_rests),
        cmocka_unit_test(test_scene_file_is_rebuilt_at_the_runs_step),
        cmocka_unit_test(test_changed_scene_gives_a_reason_and_no_scene),
        cmocka_unit_test(test_unreadable_scene_gives_a_reason_and_no_scene),
        cmocka_unit_test(test_final_poses_are_flat_and_rounded),
    };
    return cmocka_run_group_tests_name("report_case_scene", tests, NULL, NULL);
}
