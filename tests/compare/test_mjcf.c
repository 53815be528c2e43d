/* Scenes as MJCF. Whether MuJoCo reads the model as it is meant is test_adapter_mujoco's matter. */
#include "adapters/mujoco/mjcf.h"
#include "check.h"
#include "engine_run.h"
#include "polyhedra.h"
#include "scenario_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The text of the model, which the caller frees. */
static char *text_of(const pl_scene *scene)
{
    pl_text_buffer text = {0};
    pl_error error = {.message = ""};
    if (pl_mjcf_write(scene, &text, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return text.data;
}

static void assert_unsupported(const pl_scene *scene, const char *reason)
{
    pl_text_buffer text = {0};
    pl_error error = {.message = ""};
    assert_int_equal(pl_mjcf_write(scene, &text, &error), PL_UNSUPPORTED);
    assert_contains(error.message, reason);
    assert_null(text.data);
}

static void test_a_scene_read_back_gives_the_same_model(void **state)
{
    (void)state;
    static const char *const names[] = {"tower", "arch", "falling-cubes", "rest-shape"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        pl_scene scene = scenario_scene(names[i], NULL), again;
        char *json = pl_scene_to_text(&scene);
        pl_error error = {.message = ""};
        assert_int_equal(pl_scene_read_text(json, strlen(json), "scene", &again, &error), PL_OK);
        char *first = text_of(&scene), *second = text_of(&again);
        assert_string_equal(first, second);
        free(first);
        free(second);
        free(json);
        pl_scene_free(&scene);
        pl_scene_free(&again);
    }
}

static void test_names_are_escaped_and_differ_from_world(void **state)
{
    (void)state;
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    snprintf(scene.bodies[0].name, PL_NAME_SIZE, "world");
    snprintf(scene.bodies[1].name, PL_NAME_SIZE, "a <\"b\"> & c");
    pl_body cube = box_body(1, 0.5, 0.5, 0.5);
    put_body(&scene, cube);
    put_body(&scene, cube);
    snprintf(scene.bodies[2].name, PL_NAME_SIZE, "world_");
    snprintf(scene.bodies[3].name, PL_NAME_SIZE, "cube");
    char *text = text_of(&scene);
    assert_contains(text, "<body name=\"a &lt;&quot;b&quot;&gt; &amp; c\"");
    assert_contains(text, "<geom name=\"world\" type=\"plane\"");
    free(text);
    snprintf(scene.bodies[0].name, PL_NAME_SIZE, "floor");
    snprintf(scene.bodies[3].name, PL_NAME_SIZE, "world");
    text = text_of(&scene);
    assert_contains(text, "<body name=\"world_\"");
    assert_contains(text, "<body name=\"world__\"");
    assert_absent(text, "<body name=\"world\"");
    free(text);
    pl_scene_free(&scene);
}

/* Materials 0 and 1 with an exception between them; material 2 has the larger coefficient with
 * both. One floor and bodies of each. */
static pl_scene scene_of_materials(double exception)
{
    pl_scene scene = pl_scene_default();
    put_material(&scene, "ice", 0.2, 0);
    put_material(&scene, "rubber", 0.8, 0);
    pl_material_pair pair = {.material_a = 0, .material_b = 1, .friction = exception};
    assert_int_equal(pl_scene_add_pair(&scene, &pair, NULL), PL_OK);
    put_body(&scene, floor_body());
    for (int i = 0; i < 3; ++i) {
        pl_body cube = box_body(1, 0.5, 0.5, 0.5);
        cube.material = i > 0;
        cube.position[0] = 2 * i;
        put_body(&scene, cube);
    }
    return scene;
}

static void test_pairs_stand_where_the_larger_friction_is_wrong(void **state)
{
    (void)state;
    static const struct {
        double friction;
        int pairs, frictionless;
    } cases[] = {{0.35, 4, 0}, {0.8, 0, 0}, {0, 4, 4}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        /* The floor and a cube of ice against two cubes of rubber. */
        pl_scene scene = scene_of_materials(cases[i].friction);
        char *text = text_of(&scene);
        assert_int_equal(count_of(text, "<pair "), cases[i].pairs);
        assert_int_equal(count_of(text, "condim=\"1\""), cases[i].frictionless);
        free(text);
        pl_scene_free(&scene);
    }
}

/* MuJoCo raises a friction of 0 to 1e-5 where the contact has three dimensions. */
static void test_frictionless_geoms_have_contacts_of_one_dimension(void **state)
{
    (void)state;
    for (int rough = 0; rough < 2; ++rough) {
        pl_scene scene = scene_with_block(0.5 * rough, 1, 0.5, 0.5);
        char *text = text_of(&scene);
        assert_int_equal(count_of(text, "condim=\"1\""), 2 * !rough);
        free(text);
        pl_scene_free(&scene);
    }
}

static void test_scenes_that_mjcf_cannot_hold_are_refused(void **state)
{
    (void)state;
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    scene.materials[0].restitution = 0.5;
    assert_unsupported(&scene, "restitution 0.5");
    scene.materials[0].restitution = 0;
    scene.materials[0].friction = 5e-6;
    assert_unsupported(&scene, "friction 5e-06");
    scene.materials[0].friction = 0.5;
    pl_body body = box_body(1, 1, 1, 1);
    check_random random = {7};
    body.shape = pl_shape_of(mesh_of(&scene, random_hull(&scene, &random, 14)));
    put_body(&scene, body);
    assert_unsupported(&scene, "is a mesh");
    pl_scene_free(&scene);

    scene = scene_of_materials(0.35);
    for (int i = 0; i < 400; ++i) {
        pl_body cube = box_body(1, 0.5, 0.5, 0.5);
        cube.material = i % 2;
        put_body(&scene, cube);
    }
    assert_unsupported(&scene, "pairs of bodies");
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_scene_read_back_gives_the_same_model),
        cmocka_unit_test(test_names_are_escaped_and_differ_from_world),
        cmocka_unit_test(test_pairs_stand_where_the_larger_friction_is_wrong),
        cmocka_unit_test(test_frictionless_geoms_have_contacts_of_one_dimension),
        cmocka_unit_test(test_scenes_that_mjcf_cannot_hold_are_refused),
    };
    return cmocka_run_group_tests_name("mjcf", tests, NULL, NULL);
}
