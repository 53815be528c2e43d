/* Piles and containers: what they put where. */
#include "check.h"
#include "scenario_scene.h"
#include "scene_equal.h"

#include <math.h>

enum { SIDES = 5 }; /* floor and walls */

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* From the origin of the shape's frame to the farthest point. */
static double reach(const pl_shape *shape)
{
    double most = 0;
    switch (shape->kind) {
    case PL_SHAPE_SPHERE:
        return shape->radius;
    case PL_SHAPE_BOX:
        return length(shape->half_extents);
    case PL_SHAPE_CAPSULE:
        return shape->half_height + shape->radius;
    case PL_SHAPE_CYLINDER:
        return hypot(shape->half_height, shape->radius);
    default:
        for (int i = 0; i < shape->polyhedron->vertex_count; ++i) {
            most = fmax(most, length(shape->polyhedron->vertices[i]));
        }
        return most;
    }
}

static double distance_to_plane(const pl_body *plane, const pl_body *body)
{
    const double *n = plane->shape.normal, *x = body->position;
    return n[0] * x[0] + n[1] * x[1] + n[2] * x[2] - plane->shape.offset;
}

static double distance_between(const pl_body *a, const pl_body *b)
{
    double d[3];
    for (int k = 0; k < 3; ++k) {
        d[k] = a->position[k] - b->position[k];
    }
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* Signed distance from a static wall, a plane or an upright box, to a point. */
static double distance_to_wall(const pl_body *wall, const pl_body *body)
{
    if (wall->shape.kind == PL_SHAPE_PLANE) {
        return distance_to_plane(wall, body);
    }
    double most = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        double off = fabs(body->position[k] - wall->position[k]);
        most = fmax(most, off - wall->shape.half_extents[k]);
    }
    return most;
}

static void assert_apart_inside(const pl_scene *scene, int bodies)
{
    assert_int_equal(scene->body_count, SIDES + bodies);
    for (int i = SIDES; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        for (int k = 0; k < SIDES; ++k) {
            assert_true(distance_to_wall(&scene->bodies[k], body) > reach(&body->shape));
        }
        for (int k = SIDES; k < i; ++k) {
            assert_true(distance_between(&scene->bodies[k], body) >
                        reach(&scene->bodies[k].shape) + reach(&body->shape));
        }
    }
}

static void test_bodies_start_apart_inside_the_box(void **state)
{
    (void)state;
    const char *const shapes[] = {"shape=0", "shape=1", "shape=2"};
    for (int s = 0; s < 3; ++s) {
        const char *settings[] = {"n=150", shapes[s]};
        pl_scene scene;
        build_scenario("pile", settings, 2, 7, &scene);
        assert_apart_inside(&scene, 150);
        pl_scene_free(&scene);
    }
}

static void test_containers_hold_their_bodies_apart_inside(void **state)
{
    (void)state;
    static const char *const names[] = {"container", "rubble", "medley"};
    static const int counts[] = {100, 300, 80};
    for (int s = 0; s < 3; ++s) {
        pl_scene scene;
        build_scenario(names[s], NULL, 0, 3, &scene);
        assert_apart_inside(&scene, counts[s]);
        pl_scene_free(&scene);
    }
}

/* Four walls around the bodies, without a gap at the corners. */
static void test_container_is_closed_up_to_its_rim(void **state)
{
    (void)state;
    pl_scene scene;
    build_scenario("container", NULL, 0, 0, &scene);
    const pl_body *wall = &scene.bodies[1];
    const double low = wall[0].position[0] + wall[0].shape.half_extents[0];
    const double high = wall[1].position[0] - wall[1].shape.half_extents[0];
    assert_close(low, 0, 1e-12, 0);
    for (int i = 0; i < 4; ++i) {
        const double *h = wall[i].shape.half_extents;
        assert_true(wall[i].is_static);
        assert_close(wall[i].position[2], h[2], 0, 1e-15);
        assert_close(wall[i].position[i < 2], (low + high) / 2, 0, 1e-12);
        assert_true(2 * h[i < 2] >= high - low);
    }
    pl_scene_free(&scene);
}

static void test_no_two_stones_are_alike(void **state)
{
    (void)state;
    pl_scene scene;
    build_scenario("rubble", NULL, 0, 0, &scene);
    for (int i = SIDES; i < scene.body_count; ++i) {
        const pl_shape *stone = &scene.bodies[i].shape;
        assert_int_equal(stone->kind, PL_SHAPE_HULL);
        assert_true(stone->polyhedron->vertex_count >= 8);
        assert_true(reach(stone) < 0.4 && reach(stone) > 0.15);
        for (int k = SIDES; k < i; ++k) {
            assert_true(pl_shape_volume(stone) != pl_shape_volume(&scene.bodies[k].shape));
        }
    }
    pl_scene_free(&scene);
}

static void test_medley_has_every_kind_of_shape(void **state)
{
    (void)state;
    bool seen[PL_SHAPE_KIND_COUNT] = {false};
    pl_scene scene;
    build_scenario("medley", NULL, 0, 0, &scene);
    for (int i = 0; i < scene.body_count; ++i) {
        seen[scene.bodies[i].shape.kind] = true;
    }
    for (int kind = 0; kind < PL_SHAPE_KIND_COUNT; ++kind) {
        assert_true(seen[kind]);
    }
    pl_scene_free(&scene);
}

static void test_shape_parameter_selects_the_kinds_of_bodies(void **state)
{
    (void)state;
    const char *const shapes[] = {"shape=0", "shape=1", "shape=2"};
    for (int s = 0; s < 3; ++s) {
        const char *settings[] = {"n=100", shapes[s]};
        int spheres = 0;
        pl_scene scene;
        build_scenario("pile", settings, 2, 1, &scene);
        for (int i = SIDES; i < scene.body_count; ++i) {
            spheres += scene.bodies[i].shape.kind == PL_SHAPE_SPHERE;
        }
        if (s == 2) {
            assert_in_range(spheres, 30, 70);
        } else {
            assert_int_equal(spheres, s == 0 ? 100 : 0);
        }
        pl_scene_free(&scene);
    }
}

static void test_mass_is_volume_and_every_body_its_own(void **state)
{
    (void)state;
    pl_scene scene;
    build_scenario("pile", NULL, 0, 5, &scene);
    for (int i = SIDES; i < scene.body_count; ++i) {
        const pl_body *body = &scene.bodies[i];
        assert_close(body->mass, pl_shape_volume(&body->shape), 0, 1e-15);
        for (int k = SIDES; k < i; ++k) {
            assert_true(body->mass != scene.bodies[k].mass);
            assert_true(body->orientation[0] != scene.bodies[k].orientation[0]);
        }
    }
    pl_scene_free(&scene);
}

static void test_pile_depends_only_on_the_seed(void **state)
{
    (void)state;
    pl_scene first, again, other;
    char hash[17], other_hash[17];
    build_scenario("pile", NULL, 0, 3, &first);
    build_scenario("pile", NULL, 0, 3, &again);
    build_scenario("pile", NULL, 0, 4, &other);
    assert_same_scene(&again, &first);
    assert_int_equal(pl_scene_hash(&first, hash, NULL), PL_OK);
    assert_int_equal(pl_scene_hash(&other, other_hash, NULL), PL_OK);
    assert_string_not_equal(hash, other_hash);
    pl_scene_free(&first);
    pl_scene_free(&again);
    pl_scene_free(&other);
}

static void test_pile_expects_no_overlap_only(void **state)
{
    (void)state;
    pl_scene scene;
    build_scenario("pile", NULL, 0, 0, &scene);
    assert_int_equal(scene.rest_count, 0);
    assert_int_equal(scene.travel_count, 0);
    assert_string_equal(scene.primary_error, "chaotic_error");
    assert_true(isinf(scene.collapse_distance));
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bodies_start_apart_inside_the_box),
        cmocka_unit_test(test_containers_hold_their_bodies_apart_inside),
        cmocka_unit_test(test_container_is_closed_up_to_its_rim),
        cmocka_unit_test(test_no_two_stones_are_alike),
        cmocka_unit_test(test_medley_has_every_kind_of_shape),
        cmocka_unit_test(test_shape_parameter_selects_the_kinds_of_bodies),
        cmocka_unit_test(test_mass_is_volume_and_every_body_its_own),
        cmocka_unit_test(test_pile_depends_only_on_the_seed),
        cmocka_unit_test(test_pile_expects_no_overlap_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
