/* The members of an ensemble: displaced by what is said, and no more; the same everywhere. */
#include "check.h"
#include "plumb/jitter.h"
#include "plumb/scenario.h"
#include "plumb/vec.h"
#include "referee/geometry/solid.h"
#include "scene_equal.h"

#include <math.h>
#include <string.h>

static pl_scene build(const char *name, const char *setting, uint64_t seed)
{
    const pl_scenario *scenario = pl_scenario_find(name, NULL);
    double values[PL_MAX_PARAMS];
    pl_scene scene = pl_scene_default();
    assert_non_null(scenario);
    assert_int_equal(pl_scenario_values(scenario, &setting, 1, values, NULL), PL_OK);
    assert_int_equal(pl_scenario_build(scenario, values, seed, &scene, NULL), PL_OK);
    return scene;
}

static void hash_of_member(const char *name, const char *setting, uint64_t seed, int member,
                           char hash[17])
{
    pl_scene scene = build(name, setting, 0);
    pl_scene_jitter(&scene, seed, member);
    assert_int_equal(pl_scene_validate(&scene, NULL), PL_OK);
    scene.primary_error[0] = '\0'; /* how it is judged has no part in it */
    scene.acceptance = (double)INFINITY;
    assert_int_equal(pl_scene_hash(&scene, hash, NULL), PL_OK);
    pl_scene_free(&scene);
}

/* Its size by its definition. */
static double size_of(const pl_shape *shape)
{
    if (shape->kind == PL_SHAPE_SPHERE) {
        return 2 * shape->radius;
    }
    assert_int_equal(shape->kind, PL_SHAPE_BOX);
    const double *h = shape->half_extents;
    return 2 * fmin(h[0], fmin(h[1], h[2]));
}

static void test_jitter_moves_bodies_by_a_ten_thousandth(void **state)
{
    (void)state;
    pl_scene before = build("pile", "n=200", 3), after = build("pile", "n=200", 3);
    double most = 0, least = 0, turned = 0;
    pl_scene_jitter(&after, 5, 2);
    for (int i = 0; i < before.body_count; ++i) {
        const pl_body *a = &before.bodies[i], *b = &after.bodies[i];
        if (a->is_static) {
            assert_same_body(b, a);
            continue;
        }
        for (int k = 0; k < 3; ++k) {
            double d = (b->position[k] - a->position[k]) / size_of(&a->shape);
            most = fmax(most, d);
            least = fmin(least, d);
        }
        turned = fmax(turned, pl_angle_between(a->orientation, b->orientation));
        assert_memory_equal(a->velocity, b->velocity, sizeof a->velocity);
        double square = 0;
        for (int k = 0; k < 4; ++k) {
            square += b->orientation[k] * b->orientation[k];
        }
        assert_close(square, 1, 1e-15, 0);
    }
    /* 600 numbers: some come close to either end, and none goes beyond, except for the rounding of
     * a position of some 10 m. */
    assert_at_most(most, 1e-4 + 1e-14);
    assert_at_most(-least, 1e-4 + 1e-14);
    assert_at_most(turned, 1e-4);
    assert_true(most > 0.97e-4 && least < -0.97e-4 && turned > 0.97e-4);
    pl_scene_free(&before);
    pl_scene_free(&after);
}

static void test_no_point_moves_by_more_than_the_bound(void **state)
{
    (void)state;
    pl_scene before = build("wall-collapse", "rows=4,columns=4", 0);
    pl_scene after = build("wall-collapse", "rows=4,columns=4", 0);
    pl_scene_jitter(&after, 1, 0);
    for (int i = 0; i < before.body_count; ++i) {
        const pl_body *a = &before.bodies[i], *b = &after.bodies[i];
        const double bound =
            1e-4 * (sqrt(3) * pl_scene_least_size(&before) + pl_bounding_radius(&a->shape));
        for (int corner = 0; corner < 8 && a->shape.kind == PL_SHAPE_BOX; ++corner) {
            const double *h = a->shape.half_extents;
            const pl_vec local = {corner & 1 ? h[0] : -h[0], corner & 2 ? h[1] : -h[1],
                                  corner & 4 ? h[2] : -h[2]};
            const pl_axes axes_a = pl_axes_of(a->orientation), axes_b = pl_axes_of(b->orientation);
            const pl_vec at = pl_vec_add(pl_vec_of(a->position), pl_to_world(&axes_a, local));
            const pl_vec to = pl_vec_add(pl_vec_of(b->position), pl_to_world(&axes_b, local));
            assert_at_most(pl_vec_length(pl_vec_sub(to, at)), bound);
        }
    }
    pl_scene_free(&before);
    pl_scene_free(&after);
}

static void test_a_hull_turns_about_its_centre_of_mass(void **state)
{
    (void)state;
    static const double far_points[][3] = {{1000, 0, 0}, {1002, 0, 0}, {1000, 3, 0}, {1000, 0, 1}};
    pl_scene scene = pl_scene_default();
    const pl_material stone = {.name = "stone"};
    const pl_polyhedron *hull = NULL;
    assert_int_equal(pl_scene_add_material(&scene, &stone, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_hull(&scene, "far", far_points, 4, &hull, NULL), PL_OK);
    pl_body body = pl_body_default();
    body.shape = pl_shape_of(hull);
    assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    const pl_body *b = &scene.bodies[0];
    const pl_vec at = pl_centre_of_mass(&b->shape, b->position, b->orientation);
    pl_scene_jitter(&scene, 0, 0);
    const pl_vec to = pl_centre_of_mass(&b->shape, b->position, b->orientation);
    assert_at_most(pl_vec_length(pl_vec_sub(to, at)), 1e-4 * sqrt(3) * pl_scene_least_size(&scene));
    pl_scene_free(&scene);
}

/* The hashes are of the bits: they hold on every machine, compiler and level of optimisation. */
static void test_ensemble_member_is_equal_everywhere(void **state)
{
    (void)state;
    static const struct {
        const char *name, *setting;
        uint64_t seed;
        int member;
        const char *hash;
    } members[] = {
        {"pile", "n=30", 0, 0, "6e7c66ba57a6d563"},
        {"pile", "n=30", 0, 7, "dfe7ef25b0d42e7c"},
        {"wall-collapse", "rows=3,columns=5", 42, 0, "676633dbf2ead08c"},
    };
    for (size_t i = 0; i < sizeof members / sizeof members[0]; ++i) {
        char hash[17];
        hash_of_member(members[i].name, members[i].setting, members[i].seed, members[i].member,
                       hash);
        assert_string_equal(hash, members[i].hash);
    }
}

static void test_members_and_seeds_differ(void **state)
{
    (void)state;
    char hashes[12][17];
    for (int i = 0; i < 12; ++i) {
        hash_of_member("pile", "n=3", (uint64_t)(i / 4), i % 4, hashes[i]);
        for (int k = 0; k < i; ++k) {
            assert_string_not_equal(hashes[i], hashes[k]);
        }
    }
}

static void test_least_size_is_the_smallest_dynamic_body(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    const pl_material stone = {.name = "stone"};
    assert_int_equal(pl_scene_add_material(&scene, &stone, NULL, NULL), PL_OK);
    pl_body body = pl_body_default();
    body.is_static = true;
    body.shape = pl_shape_sphere(0.01);
    assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    assert_true(isinf(pl_scene_least_size(&scene)));
    const pl_shape shapes[] = {pl_shape_sphere(2), pl_shape_box(1.5, 1, 3),
                               pl_shape_cylinder(1, 0.75), pl_shape_capsule(0.5, 9)};
    const double sizes[] = {4, 2, 1.5, 1};
    body.is_static = false;
    for (int i = 0; i < 4; ++i) {
        body.shape = shapes[i];
        body.name[0] = (char)('a' + i);
        assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
        assert_close(pl_scene_least_size(&scene), sizes[i], 0, 0);
    }
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_jitter_moves_bodies_by_a_ten_thousandth),
        cmocka_unit_test(test_no_point_moves_by_more_than_the_bound),
        cmocka_unit_test(test_a_hull_turns_about_its_centre_of_mass),
        cmocka_unit_test(test_ensemble_member_is_equal_everywhere),
        cmocka_unit_test(test_members_and_seeds_differ),
        cmocka_unit_test(test_least_size_is_the_smallest_dynamic_body),
    };
    return cmocka_run_group_tests_name("ensemble jitter", tests, NULL, NULL);
}
