/* Other forms of the same scene: static boxes split or as meshes, and starts a fraction of a step later. */
#include "check.h"
#include "plumb/vec.h"
#include "studies/metamorphic/transform.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double half_extents[3] = {0.7, 0.3, 1.1};

/* A tilted static box, a static sphere and a dynamic box. */
static pl_scene boxes_scene(check_random *random)
{
    pl_scene scene = pl_scene_default();
    const pl_material material = {.name = "m"};
    pl_body body = pl_body_default();
    assert_int_equal(pl_scene_add_material(&scene, &material, NULL, NULL), PL_OK);
    body.is_static = true;
    body.shape = pl_shape_box(half_extents[0], half_extents[1], half_extents[2]);
    snprintf(body.name, sizeof body.name, "box");
    check_quaternion(random, body.orientation);
    for (int k = 0; k < 3; ++k) {
        body.position[k] = check_uniform(random, -3, 3);
    }
    assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    body = pl_body_default();
    body.is_static = true;
    body.shape = pl_shape_sphere(0.5);
    snprintf(body.name, sizeof body.name, "ball");
    assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    body = pl_body_default();
    body.shape = pl_shape_box(1, 1, 1);
    body.position[0] = 20;
    snprintf(body.name, sizeof body.name, "moving box");
    assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    return scene;
}

static bool is_inside(const pl_body *box, pl_vec point)
{
    const pl_axes axes = pl_axes_of(box->orientation);
    const pl_vec local = pl_to_local(&axes, pl_vec_sub(point, pl_vec_of(box->position)));
    return fabs(local.x) <= box->shape.half_extents[0] &&
           fabs(local.y) <= box->shape.half_extents[1] &&
           fabs(local.z) <= box->shape.half_extents[2];
}

static void test_halves_fill_the_same_solid_without_overlap(void **state)
{
    (void)state;
    check_random random = {.state = 1};
    for (int i = 0; i < 30; ++i) {
        pl_scene scene = boxes_scene(&random), split;
        const int axis = i % 3;
        int inside = 0;
        assert_int_equal(pl_static_box_count(&scene), 1);
        assert_int_equal(pl_split_boxes(&scene, axis, &split, NULL), PL_OK);
        assert_int_equal(split.body_count, 4);
        assert_int_equal(split.bodies[1].shape.kind, PL_SHAPE_SPHERE);
        assert_close(split.bodies[2].shape.half_extents[0], 1, 0, 0);
        assert_true(split.bodies[3].is_static);
        for (int k = 0; k < 2000; ++k) {
            const pl_axes axes = pl_axes_of(scene.bodies[0].orientation);
            const pl_vec local = {check_uniform(&random, -1.2, 1.2),
                                  check_uniform(&random, -1.2, 1.2),
                                  check_uniform(&random, -1.2, 1.2)};
            const pl_vec point =
                pl_vec_add(pl_vec_of(scene.bodies[0].position), pl_to_world(&axes, local));
            const int parts =
                is_inside(&split.bodies[0], point) + is_inside(&split.bodies[3], point);
            assert_int_equal(parts, is_inside(&scene.bodies[0], point));
            inside += parts;
        }
        assert_true(inside > 100);
        pl_scene_free(&split);
        pl_scene_free(&scene);
    }
}

static void test_mesh_has_the_box_s_volume_and_surface(void **state)
{
    (void)state;
    check_random random = {.state = 2};
    static const int divisions[] = {1, 2, 8};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = boxes_scene(&random), meshed;
        const int n = divisions[i];
        assert_int_equal(pl_tessellate_boxes(&scene, n, &meshed, NULL), PL_OK);
        const pl_shape *shape = &meshed.bodies[0].shape;
        assert_int_equal(shape->kind, PL_SHAPE_MESH);
        assert_int_equal(meshed.body_count, 3);
        assert_int_equal(meshed.bodies[2].shape.kind, PL_SHAPE_BOX);
        const pl_polyhedron *mesh = shape->polyhedron;
        assert_int_equal(mesh->triangle_count, 12 * n * n);
        assert_int_equal(mesh->vertex_count, 6 * n * n + 2);
        assert_close(mesh->volume, pl_shape_volume(&scene.bodies[0].shape), 0, 1e-14);
        for (int v = 0; v < mesh->vertex_count; ++v) {
            double nearest = HUGE_VAL;
            for (int k = 0; k < 3; ++k) {
                assert_at_most(fabs(mesh->vertices[v][k]), half_extents[k]);
                nearest = fmin(nearest, half_extents[k] - fabs(mesh->vertices[v][k]));
            }
            assert_close(nearest, 0, 0, 0);
        }
        pl_scene_free(&meshed);
        pl_scene_free(&scene);
    }
}

/* ---- Late starts ---- */

/* A plane z = 0 and a ball of radius 1 m, as a test needs it. */
static pl_scene ball_scene(double friction)
{
    pl_scene scene = pl_scene_default();
    const pl_material material = {.name = "m", .friction = friction};
    pl_body body = pl_body_default();
    assert_int_equal(pl_scene_add_material(&scene, &material, NULL, NULL), PL_OK);
    body.is_static = true;
    body.shape = pl_shape_plane(0, 0, 1, 0);
    snprintf(body.name, sizeof body.name, "floor");
    assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    body = pl_body_default();
    body.shape = pl_shape_sphere(1);
    body.position[2] = 1;
    snprintf(body.name, sizeof body.name, "ball");
    assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    scene.dt = 0.01;
    scene.duration = 1;
    return scene;
}

/* Whether the late start of the scene is known, and then the later scene, for its ball. */
static bool late(const pl_scene *scene, pl_body *ball)
{
    const char *reason = NULL;
    pl_scene later;
    *ball = pl_body_default();
    assert_int_equal(pl_late_start(scene, 0.25, &later, &reason, NULL), PL_OK);
    if (reason != NULL) {
        return false;
    }
    assert_int_equal(pl_scene_steps(&later), pl_scene_steps(scene) - 1);
    *ball = later.bodies[1];
    pl_scene_free(&later);
    return true;
}

static void test_free_flight_starts_later_on_its_parabola(void **state)
{
    (void)state;
    pl_scene scene = ball_scene(0.5);
    pl_body *ball = &scene.bodies[1], later;
    const double t = 0.0025;
    ball->position[2] = 5;
    ball->velocity[0] = 3;
    ball->velocity[2] = 2;
    ball->angular_velocity[1] = 8;
    assert_true(late(&scene, &later));
    assert_close(later.position[0], 3 * t, 0, 1e-15);
    assert_close(later.position[2], 5 + 2 * t - 9.81 * t * t / 2, 0, 1e-15);
    assert_close(later.velocity[2], 2 - 9.81 * t, 0, 1e-15);
    assert_close(later.angular_velocity[1], 8, 0, 0);
    assert_close(later.orientation[2], sin(8 * t / 2), 0, 1e-15);
    assert_close(later.orientation[0], cos(8 * t / 2), 0, 1e-15);
    ball->position[2] = 1.0001; /* it lands within the time */
    ball->velocity[2] = -1;
    assert_false(late(&scene, &later));
    pl_scene_free(&scene);
}

static void test_only_a_constant_spin_is_known(void **state)
{
    (void)state;
    pl_scene scene = ball_scene(0.5);
    pl_body *body = &scene.bodies[1], later;
    body->position[2] = 5;
    body->shape = pl_shape_box(0.1, 0.2, 0.3);
    pl_shape_inertia(&body->shape, body->mass, body->inertia);
    body->angular_velocity[1] = 8;
    assert_true(late(&scene, &later));
    body->angular_velocity[2] = 1;
    assert_false(late(&scene, &later));
    pl_scene_free(&scene);
}

static void test_uniform_motion_on_a_level_top_is_known(void **state)
{
    (void)state;
    pl_scene scene = ball_scene(0.5);
    pl_body *ball = &scene.bodies[1], later;
    ball->velocity[0] = 4; /* rolls */
    ball->angular_velocity[1] = 4;
    assert_true(late(&scene, &later));
    assert_close(later.position[0], 0.01, 0, 1e-15);
    assert_close(later.position[2], 1, 0, 0);
    assert_close(later.velocity[2], 0, 0, 0);
    ball->angular_velocity[1] = 3.9; /* slips */
    assert_false(late(&scene, &later));
    ball->angular_velocity[1] = 0; /* slides with friction */
    assert_false(late(&scene, &later));
    scene.materials[0].friction = 0;
    assert_true(late(&scene, &later));
    assert_close(later.position[0], 0.01, 0, 1e-15);
    scene.bodies[0].shape = pl_shape_plane(0.6, 0, 0.8, 0); /* a slope */
    ball->position[0] = 0.6;
    ball->position[2] = 0.8;
    assert_false(late(&scene, &later));
    pl_scene_free(&scene);
}

static void test_body_stays_only_if_it_is_expected_to(void **state)
{
    (void)state;
    pl_scene scene = ball_scene(0.5);
    pl_body later;
    assert_false(late(&scene, &later));
    const pl_expect_rest rest = {.body = 1, .position = {0, 0, 1}, .orientation = {1, 0, 0, 0}};
    assert_int_equal(pl_scene_add_rest(&scene, &rest, NULL), PL_OK);
    assert_true(late(&scene, &later));
    assert_close(later.position[2], 1, 0, 0);
    const pl_force force = {.body = 1, .force = {1, 0, 0}, .until = HUGE_VAL};
    assert_int_equal(pl_scene_add_force(&scene, &force, NULL), PL_OK);
    assert_false(late(&scene, &later));
    pl_scene_free(&scene);
}

static void test_slider_passes_flush_boxes_but_no_step(void **state)
{
    (void)state;
    pl_scene scene = ball_scene(0);
    pl_body *floor = &scene.bodies[0], *cube = &scene.bodies[1], later;
    floor->shape = pl_shape_box(1, 1, 0.5);
    floor->position[2] = -0.5;
    floor->orientation[0] = 1;
    pl_body next = *floor;
    next.position[0] = 2;
    snprintf(next.name, sizeof next.name, "next");
    cube->shape = pl_shape_box(0.25, 0.25, 0.25);
    pl_shape_inertia(&cube->shape, cube->mass, cube->inertia);
    cube->position[0] = 0.7499; /* its edge passes the seam within the time */
    cube->position[2] = 0.25;
    cube->velocity[0] = 2;
    assert_int_equal(pl_scene_add_body(&scene, &next, NULL, NULL), PL_OK);
    assert_true(late(&scene, &later));
    assert_close(later.position[0], 0.7499 + 0.005, 0, 1e-15);
    scene.bodies[2].position[2] += 0.01; /* a step up */
    assert_false(late(&scene, &later));
    scene.bodies[2].position[2] -= 0.01;
    scene.bodies[1].position[0] = -1.1; /* its centre is beyond the edge: it tips */
    assert_false(late(&scene, &later));
    pl_scene_free(&scene);
}

static void test_state_between_frames_is_exact_under_constant_force(void **state)
{
    (void)state;
    const pl_body body = {.shape = pl_shape_sphere(1)};
    const double dt = 0.1, g = -9.81, v = 3, f = 0.3;
    const pl_body_state now = {.orientation = {1, 0, 0, 0}, .velocity = {0, 0, v}};
    pl_body_state next = now, at;
    next.velocity[2] = v + g * dt;
    pl_state_between(&body, &now, &next, dt, f, &at);
    assert_close(at.position[2], v * f * dt + g * f * f * dt * dt / 2, 0, 1e-14);
    assert_close(at.velocity[2], v + g * f * dt, 0, 1e-14);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_halves_fill_the_same_solid_without_overlap),
        cmocka_unit_test(test_mesh_has_the_box_s_volume_and_surface),
        cmocka_unit_test(test_free_flight_starts_later_on_its_parabola),
        cmocka_unit_test(test_only_a_constant_spin_is_known),
        cmocka_unit_test(test_uniform_motion_on_a_level_top_is_known),
        cmocka_unit_test(test_body_stays_only_if_it_is_expected_to),
        cmocka_unit_test(test_slider_passes_flush_boxes_but_no_step),
        cmocka_unit_test(test_state_between_frames_is_exact_under_constant_force)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
