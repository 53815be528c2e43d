/* Conformance of every adapter of this build, all profiles: that engines run with the settings
 * that the harness states, and say what they did. */
#include "check.h"
#include "engine_run.h"

#include <math.h>
#include <string.h>

static void law_descriptor(const pl_engine_choice *choice)
{
    const pl_engine_info *engine = choice->engine;
    assert_true(engine->profiles[0].in_default_comparison);
    uint32_t shapes = PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX;
    assert_int_equal(engine->capabilities & shapes, shapes);
    for (int i = 0; i < engine->option_count; ++i) {
        assert_true(choice->values[i] >= engine->options[i].min);
        assert_true(choice->values[i] <= engine->options[i].max);
        if (engine->options[i].integer) {
            assert_close(choice->values[i], round(choice->values[i]), 0, 0);
        }
    }
    pl_session session = pl_session_begin(choice);
    assert_int_equal(pl_session_load(&session, NULL), PL_OK);
    session.loaded.table.destroy(NULL);
    pl_session_end(&session);
}

static void test_descriptors_are_whole_and_defaults_in_range(void **state)
{
    (void)state;
    for_each_profile(law_descriptor);
}

static void law_settings(const pl_engine_choice *choice)
{
    pl_scene scene = scene_of_pairs(choice);
    memcpy(scene.gravity, (double[]){0.5, -1.5, -8.25}, sizeof scene.gravity);
    pl_body box = box_body(3.7, 0.2, 0.5, 0.9), ball = pl_body_default();
    box.material = 1;
    box.position[2] = 5;
    memcpy(box.inertia, (double[]){0.31, 0.22, 0.43}, sizeof box.inertia);
    ball.shape = pl_shape_sphere(0.3);
    ball.mass = 1e-3;
    ball.material = 1;
    ball.position[2] = 9;
    put_body(&scene, box);
    put_body(&scene, ball);
    engine_run r;
    scene.dt = 1.0 / 60;
    engine_start(&r, choice, &scene);
    double mass[MOST_BODIES], inertia[MOST_BODIES][3];
    pl_engine_settings settings = {.mass = mass, .inertia = inertia, .body_count = 3};
    pl_session_read_settings(&r.session, &settings);
    assert_int_equal(settings.body_count, 3);
    assert_true(isnan(settings.dt) || settings.dt == scene.dt);
    for (int b = 0; b < 3; ++b) {
        const pl_body *body = &scene.bodies[b];
        assert_close(mass[b], body->is_static ? 0 : body->mass, 0, 1e-15);
        for (int k = 0; k < 3; ++k) {
            assert_close(inertia[b][k], body->is_static ? 0 : body->inertia[k], 0, 1e-15);
            assert_close(settings.gravity[k], scene.gravity[k], 0, 0);
        }
    }
    for (int order = 0; order < 2; ++order) {
        const pl_pair_coefficients pair = pl_session_read_pair(&r.session, order, 1 - order);
        assert_close(pair.friction, 0.35, 0, 0);
        if (has_restitution(choice)) {
            assert_close(pair.restitution, 0.6, 0, 0);
        }
    }
    const pl_pair_coefficients pair = pl_session_read_pair(&r.session, 1, 2);
    assert_close(pair.friction, 0.8, 1e-15, 0);
    if (has_restitution(choice)) {
        assert_close(pair.restitution, 0.9, 1e-15, 0);
    }
    engine_finish(&r);
    pl_scene_free(&scene);
}

static void test_settings_read_back_equal_the_scene(void **state)
{
    (void)state;
    for_each_profile(law_settings);
}

static bool is_built_in(const char *name)
{
    int count = 0;
    const pl_built_in *known = pl_built_in_engines(&count);
    for (int i = 0; i < count; ++i) {
        if (strcmp(known[i].name, name) == 0) {
            return known[i].entry != NULL;
        }
    }
    return false;
}

/* The table of options, which `list engines` shows, states the default values of the
 * library itself. */
static void test_option_tables_of_reference_engines_match_library_defaults(void **state)
{
    (void)state;
    static const char *const specs[] = {"ode:quick", "ode:dantzig", "bullet:si", "bullet:nncg"};
    for (size_t s = 0; s < sizeof specs / sizeof *specs; ++s) {
        pl_engine_choice choice;
        if (pl_engine_choose(specs[s], &choice, NULL) == PL_UNSUPPORTED) {
            continue;
        }
        for (int i = 0; i < choice.engine->option_count; ++i) {
            print_message("    %s %s\n", specs[s], choice.engine->options[i].name);
            /* Bullet writes some of its doubles as floats. */
            assert_close(choice.values[i], choice.engine->options[i].value, 0, 1e-7);
        }
    }
}

static bool is_cited(const pl_engine_info *engine, int profile, const char *option)
{
    for (int i = 0; i < engine->source_count; ++i) {
        const pl_engine_source *source = &engine->sources[i];
        if (source->profile == profile && source->option != NULL &&
            strcmp(source->option, option) == 0) {
            return true;
        }
    }
    return false;
}

/* A profile named `recommended` is the shipped one, which is the first, with the cited changes. */
static void test_recommended_profiles_change_just_what_they_cite(void **state)
{
    (void)state;
    static const char *const specs[] = {"ode:recommended", "bullet:recommended",
                                        "mujoco:recommended"};
    for (size_t s = 0; s < sizeof specs / sizeof *specs; ++s) {
        pl_engine_choice choice;
        pl_status status = pl_engine_choose(specs[s], &choice, NULL);
        if (status == PL_UNSUPPORTED) {
            continue;
        }
        assert_int_equal(status, PL_OK);
        const double *shipped = pl_engine_profile_values(choice.engine, 0);
        for (int i = 0; i < choice.engine->option_count; ++i) {
            const char *name = choice.engine->options[i].name;
            print_message("    %s %s\n", specs[s], name);
            assert_int_equal(choice.values[i] != shipped[i],
                             is_cited(choice.engine, choice.profile, name));
        }
    }
}

/* Iterations and residual of five stacked cubes in the first step. */
static pl_step_stats stack_stats(const char *spec)
{
    pl_scene scene = pl_scene_default();
    put_material(&scene, "stone", 0.5, 0);
    put_body(&scene, floor_body());
    for (int i = 0; i < 5; ++i) {
        pl_body cube = box_body(1, 0.5, 0.5, 0.5);
        cube.position[2] = 0.5 + i;
        put_body(&scene, cube);
    }
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose(spec, &choice, NULL), PL_OK);
    engine_run r;
    scene.dt = 1.0 / 60;
    engine_start(&r, &choice, &scene);
    engine_step(&r);
    pl_step_stats stats = r.stats;
    assert_int_equal(r.contact_count, (int)stats.contacts);
    engine_finish(&r);
    pl_scene_free(&scene);
    return stats;
}

static void test_reported_iterations_are_the_requested_ones_or_none(void **state)
{
    (void)state;
    if (is_built_in("ode")) {
        assert_close(stack_stats("ode").iterations, 20, 0, 0);
        assert_close(stack_stats("ode:quick,iterations=7").iterations, 7, 0, 0);
        assert_true(isnan(stack_stats("ode:dantzig").iterations));
        assert_true(isnan(stack_stats("ode").residual));
    }
    if (is_built_in("bullet")) {
        assert_close(stack_stats("bullet").iterations, 10, 0, 0);
        assert_close(stack_stats("bullet:nncg,iterations=7").iterations, 7, 0, 0);
        assert_true(stack_stats("bullet").residual >
                    stack_stats("bullet:si,iterations=99").residual);
        assert_true(isnan(stack_stats("bullet:dantzig").iterations));
        assert_true(isnan(stack_stats("bullet:lemke").residual));
    }
}

/* Small boxes side by side, not touching, on a floor or on one large slab that joins them all. */
static pl_status step_many(const char *spec, bool slab, pl_error *error)
{
    pl_scene scene = pl_scene_default();
    put_material(&scene, "stone", 0.5, 0);
    put_body(&scene, floor_body());
    if (slab) {
        pl_body body = box_body(1000, 20, 20, 0.25);
        body.position[2] = 0.25;
        put_body(&scene, body);
    }
    for (int i = 0; i < 40 * 40; ++i) {
        pl_body box = box_body(1, 0.3, 0.3, 0.3);
        box.position[0] = i % 40 - 19.5;
        box.position[1] = i / 40 - 19.5;
        box.position[2] = 0.299 + (slab ? 0.5 : 0);
        put_body(&scene, box);
    }
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose(spec, &choice, NULL), PL_OK);
    pl_session session = pl_session_begin(&choice);
    assert_int_equal(pl_session_load(&session, error), PL_OK);
    assert_int_equal(pl_session_create(&session, &scene, error), PL_OK);
    pl_step_stats stats;
    pl_status status = pl_session_step(&session, &stats, NULL, error);
    pl_session_end(&session);
    pl_scene_free(&scene);
    return status;
}

static void test_dense_solvers_decline_only_islands_beyond_their_memory(void **state)
{
    (void)state;
    static const char *const specs[] = {"ode:dantzig", "bullet:dantzig", "bullet:lemke"};
    for (size_t s = 0; s < sizeof specs / sizeof *specs; ++s) {
        pl_engine_choice choice;
        pl_error error = {.message = ""};
        if (pl_engine_choose(specs[s], &choice, NULL) == PL_UNSUPPORTED) {
            continue;
        }
        assert_int_equal(step_many(specs[s], true, &error), PL_UNSUPPORTED);
        print_message("    %s\n", error.message);
        assert_contains(error.message, specs[s]);
        assert_contains(error.message, "GiB");
        assert_contains(error.message, "rows");
        if (strcmp(specs[s], "ode:dantzig") == 0) {
            assert_int_equal(step_many(specs[s], false, &error), PL_OK);
        }
    }
}

/* Height after two seconds of a cube of side 1 that starts 5 mm deep in the floor. */
static double rest_height(const char *spec)
{
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose(spec, &choice, NULL), PL_OK);
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    scene.bodies[1].position[2] -= 5e-3;
    engine_run r;
    scene.dt = 1.0 / 60;
    engine_start(&r, &choice, &scene);
    for (int n = 0; n < 120; ++n) {
        engine_step(&r);
    }
    double height = r.now[1].position[2];
    engine_finish(&r);
    pl_scene_free(&scene);
    return height;
}

static void test_penetration_within_odes_surface_layer_stays(void **state)
{
    (void)state;
    if (!is_built_in("ode")) {
        skip();
    }
    assert_close(rest_height("ode:dantzig"), 0.5, 1e-6, 0);
    assert_close(rest_height("ode:dantzig,surface_layer=0.01"), 0.495, 1e-6, 0);
    assert_close(rest_height("ode:dantzig,surface_layer=0.002"), 0.498, 1e-6, 0);
}

static void test_iterations_that_dantzig_cannot_have_are_declined(void **state)
{
    (void)state;
    pl_engine_choice choice;
    pl_error error = {.message = ""};
    if (pl_engine_choose("ode:dantzig,iterations=50", &choice, NULL) == PL_UNSUPPORTED) {
        skip();
    }
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    pl_session session = pl_session_begin(&choice);
    assert_int_equal(pl_session_load(&session, &error), PL_OK);
    assert_int_equal(pl_session_create(&session, &scene, &error), PL_UNSUPPORTED);
    assert_null(session.instance);
    assert_contains(error.message, "iterations");
    pl_session_end(&session);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_descriptors_are_whole_and_defaults_in_range),
        cmocka_unit_test(test_settings_read_back_equal_the_scene),
        cmocka_unit_test(test_option_tables_of_reference_engines_match_library_defaults),
        cmocka_unit_test(test_recommended_profiles_change_just_what_they_cite),
        cmocka_unit_test(test_reported_iterations_are_the_requested_ones_or_none),
        cmocka_unit_test(test_dense_solvers_decline_only_islands_beyond_their_memory),
        cmocka_unit_test(test_penetration_within_odes_surface_layer_stays),
        cmocka_unit_test(test_iterations_that_dantzig_cannot_have_are_declined),
    };
    return cmocka_run_group_tests_name("adapters settings", tests, NULL, NULL);
}
