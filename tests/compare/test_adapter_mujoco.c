/* What only MuJoCo's adapter does: its models are those of the scenes, its memory grows, and what it
 * merely warns of ends a run. All other laws are those of every engine (test_adapters_*.c). */
#include "adapters/mujoco/mjcf.h"
#include "check.h"
#include "engine_run.h"
#include "scenario_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef PLUMB_HAVE_ENGINE
#include <mujoco/mujoco.h>

/* The model as MuJoCo's own tools would load it. */
static mjModel *load(const pl_scene *scene)
{
    pl_text_buffer text = {0};
    char message[1000] = "";
    mjVFS *files = malloc(sizeof *files);
    assert_int_equal(pl_mjcf_write(scene, &text, NULL), PL_OK);
    assert_non_null(files);
    mj_defaultVFS(files);
    assert_int_equal(mj_makeEmptyFileVFS(files, "model.xml", (int)text.length), 0);
    memcpy(files->filedata[0], text.data, text.length);
    mjModel *model = mj_loadXML("model.xml", files, message, sizeof message);
    assert_string_equal(message, ""); /* no warning either */
    mj_deleteVFS(files);
    free(files);
    pl_text_free(&text);
    assert_non_null(model);
    return model;
}

static void test_models_load_with_the_scenes_bodies(void **state)
{
    (void)state;
    static const char *const names[] = {"tower", "arch", "wall", "falling-cubes", "torque-free"};
    for (size_t n = 0; n < sizeof names / sizeof *names; ++n) {
        pl_scene scene = scenario_scene(names[n], NULL);
        mjModel *model = load(&scene);
        print_message("    %s\n", names[n]);
        assert_int_equal(model->ngeom, scene.body_count);
        for (int i = 0; i < scene.body_count; ++i) {
            const pl_body *body = &scene.bodies[i];
            int geom = mj_name2id(model, mjOBJ_GEOM, body->name);
            assert_in_range(geom, 0, model->ngeom - 1);
            int number = model->geom_bodyid[geom];
            assert_close(model->body_mass[number], body->is_static ? 0 : body->mass, 0, 0);
            for (int k = 0; k < 3; ++k) {
                double inertia = body->is_static ? 0 : body->inertia[k];
                assert_close(model->body_inertia[3 * number + k], inertia, 0, 0);
            }
        }
        mj_deleteModel(model);
        pl_scene_free(&scene);
    }
}

/* The geom of a hull in MuJoCo is centred and turned by its own integrals. */
static void test_vertices_of_a_hull_are_where_they_should_be(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    const double corners[5][3] = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0.1, 0.2, 3}, {1, 1, 1}};
    put_material(&scene, "stone", 0.5, 0);
    const pl_polyhedron *solid = NULL;
    assert_int_equal(pl_scene_add_hull(&scene, "", corners, 5, &solid, NULL), PL_OK);
    pl_body body = pl_body_default();
    check_random random = {3};
    body.mass = 2;
    body.shape = pl_shape_of(solid);
    pl_shape_inertia(&body.shape, body.mass, body.inertia);
    check_quaternion(&random, body.orientation);
    memcpy(body.position, (double[]){4, -5, 6}, sizeof body.position);
    put_body(&scene, body);
    mjModel *model = load(&scene);
    mjData *data = mj_makeData(model);
    mj_forward(model, data);
    for (int c = 0; c < 5; ++c) {
        double nearest = INFINITY, corner[3];
        mju_rotVecQuat(corner, corners[c], body.orientation);
        mju_addTo3(corner, body.position);
        for (int v = 0; v < model->nmeshvert; ++v) {
            double local[3], world[3];
            mju_f2n(local, model->mesh_vert + 3 * v, 3);
            mju_rotVecMat(world, local, data->geom_xmat);
            mju_addTo3(world, data->geom_xpos);
            nearest = fmin(nearest, mju_dist3(world, corner));
        }
        assert_at_most(nearest, 1e-6); /* MuJoCo keeps vertices in single precision */
    }
    mj_deleteData(data);
    mj_deleteModel(model);
    pl_scene_free(&scene);
}

/* A box on 60 planes that are one: 240 contacts, twice those that memory was reserved for. */
static void test_more_contacts_than_reserved_are_all_solved(void **state)
{
    (void)state;
    enum { PLANES = 60 };
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose("mujoco", &choice, NULL), PL_OK);
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    scene.dt = 1.0 / 240;
    for (int i = 1; i < PLANES; ++i) {
        put_body(&scene, floor_body());
    }
    pl_session session = pl_session_begin(&choice);
    pl_error error = {.message = ""};
    assert_int_equal(pl_session_load(&session, &error), PL_OK);
    assert_int_equal(pl_session_create(&session, &scene, &error), PL_OK);
    pl_step_stats stats;
    for (int n = 0; n < 480; ++n) {
        assert_int_equal(pl_session_step(&session, &stats, NULL, &error), PL_OK);
        if (n == 0) { /* MuJoCo lists contacts of depth 0, but gives them no force */
            assert_close(stats.contacts, 0, 0, 0);
        }
    }
    assert_close(stats.contacts, 4 * PLANES, 0, 0);
    pl_contact *contacts = NULL;
    int capacity = 0, count = 0;
    double weight = 0;
    assert_int_equal(pl_session_read_contacts(&session, &contacts, &capacity, &count, &error),
                     PL_OK);
    assert_int_equal(count, 4 * PLANES);
    for (int i = 0; i < count; ++i) {
        weight += contacts[i].impulse[2] * (contacts[i].body_b == 1 ? 1 : -1);
    }
    assert_close(weight, g * scene.dt, 0, 1e-6);
    free(contacts);
    pl_session_end(&session);
    pl_scene_free(&scene);
}

/* MuJoCo only warns, and starts again from the initial state. */
static void test_state_that_mujoco_resets_ends_the_run(void **state)
{
    (void)state;
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose("mujoco", &choice, NULL), PL_OK);
    pl_scene scene = scene_with_block(0.5, 1e-3, 0.5, 0.5);
    pl_force push = {.force = {1e12, 0, 0}, .body = 1, .from = 0.1, .until = INFINITY};
    assert_int_equal(pl_scene_add_force(&scene, &push, NULL), PL_OK);
    remove("MUJOCO_LOG.TXT");
    pl_session session = pl_session_begin(&choice);
    pl_error error = {.message = ""};
    assert_int_equal(pl_session_load(&session, &error), PL_OK);
    assert_int_equal(pl_session_create(&session, &scene, &error), PL_OK);
    pl_status status = PL_OK;
    pl_step_stats stats;
    int steps = 0;
    while (status == PL_OK && steps < 20) {
        status = pl_session_step(&session, &stats, NULL, &error);
        ++steps;
    }
    assert_int_equal(status, PL_FAILED);
    assert_int_equal(steps, 7); /* the first that starts at 0.1 s */
    assert_contains(error.message, "QACC");
    assert_int_not_equal(access("MUJOCO_LOG.TXT", F_OK), 0);
    pl_session_end(&session);
    pl_scene_free(&scene);
}

/* The Hessian of 20000 bodies alone is beyond what MuJoCo counts in 32 bits. */
static void test_scene_beyond_mujocos_memory_is_declined(void **state)
{
    (void)state;
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose("mujoco", &choice, NULL), PL_OK);
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    for (int i = 0; i < 20000; ++i) {
        put_body(&scene, scene.bodies[1]);
    }
    pl_session session = pl_session_begin(&choice);
    pl_error error = {.message = ""};
    assert_int_equal(pl_session_load(&session, &error), PL_OK);
    assert_int_equal(pl_session_create(&session, &scene, &error), PL_UNSUPPORTED);
    assert_contains(error.message, "32 bits");
    pl_session_end(&session);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_models_load_with_the_scenes_bodies),
        cmocka_unit_test(test_vertices_of_a_hull_are_where_they_should_be),
        cmocka_unit_test(test_more_contacts_than_reserved_are_all_solved),
        cmocka_unit_test(test_state_that_mujoco_resets_ends_the_run),
        cmocka_unit_test(test_scene_beyond_mujocos_memory_is_declined),
    };
    return cmocka_run_group_tests_name("adapter mujoco", tests, NULL, NULL);
}
#else
int main(void)
{
    return 77; /* skipped: this build has no MuJoCo */
}
#endif
