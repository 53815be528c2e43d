/* On every scenario of the catalogue, a transform's way back undoes its way forth. */
#include "check.h"
#include "plumb/scenario.h"
#include "plumb/vec.h"
#include "transformed.h"

#include <float.h>
#include <string.h>

typedef void scene_law(const pl_check *check, const pl_transform *transform, const pl_scene *scene);

static void for_every_scenario_and_check(scene_law *law)
{
    int scenario_count;
    const pl_scenario *const *scenarios = pl_scenarios(&scenario_count);
    for (int i = 0; i < scenario_count; ++i) {
        double values[PL_MAX_PARAMS];
        pl_scene scene;
        pl_error error = {.message = ""};
        assert_int_equal(pl_scenario_values(scenarios[i], NULL, 0, values, &error), PL_OK);
        assert_int_equal(pl_scenario_build(scenarios[i], values, 0, &scene, &error), PL_OK);
        for (int k = 0; k < PL_CHECK_COUNT; ++k) {
            const pl_transform transform = transform_of(&pl_checks[k], &scene);
            law(&pl_checks[k], &transform, &scene);
        }
        pl_scene_free(&scene);
    }
}

static void check_states_come_back(const pl_check *check, const pl_transform *transform,
                                   const pl_scene *scene)
{
    (void)check;
    pl_scene other = transformed(transform, scene);
    const double far = pl_vec_length(pl_vec_of(transform->shift));
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        const int index = pl_transform_index(transform, i, scene->body_count);
        const pl_body_state there = pl_body_start(&other.bodies[index]);
        pl_body_state back;
        assert_string_equal(other.bodies[index].name, body->name);
        if (body->shape.kind != PL_SHAPE_PLANE) {
            pl_transform_state_back(transform, &there, &back);
            assert_vectors(back.position, body->position, DBL_EPSILON * far, 4 * DBL_EPSILON);
            assert_vectors(back.velocity, body->velocity, 0, 4 * DBL_EPSILON);
            assert_vectors(back.angular_velocity, body->angular_velocity, 0, 4 * DBL_EPSILON);
            assert_at_most(pl_angle_between(back.orientation, body->orientation), 1e-15);
        }
    }
    pl_scene_free(&other);
}

static void test_states_come_back_to_rounding_on_every_scenario(void **state)
{
    (void)state;
    for_every_scenario_and_check(check_states_come_back);
}

static void check_validity(const pl_check *check, const pl_transform *transform,
                           const pl_scene *scene)
{
    pl_error error = {.message = ""};
    pl_scene other = transformed(transform, scene);
    if (pl_scene_validate(&other, &error) != PL_OK) {
        fail_msg("%s of %s: %s", check->name, scene->name, error.message);
    }
    assert_int_equal(pl_scene_steps(&other), pl_scene_steps(scene));
    pl_scene_free(&other);
}

static void test_transformed_scenes_are_valid_with_equal_steps(void **state)
{
    (void)state;
    for_every_scenario_and_check(check_validity);
}

/* The inverse of a check's transform, which must be of a single kind. */
static pl_transform inverse(const pl_check *check, const pl_scene *scene)
{
    pl_check undo = *check;
    undo.amount = check->kind == PL_CHECK_SCALE ? 1 / check->amount : -check->amount;
    return transform_of(&undo, scene);
}

static void check_same_body(const pl_body *a, const pl_body *b, double far, bool exactly)
{
    const double r = 16 * DBL_EPSILON;
    assert_close(a->mass, b->mass, 0, r);
    assert_vectors(a->inertia, b->inertia, 0, r);
    assert_vectors(a->position, b->position, DBL_EPSILON * far, r);
    assert_vectors(a->shape.normal, b->shape.normal, r, 0);
    assert_vectors(a->shape.half_extents, b->shape.half_extents, 0, r);
    assert_close(a->shape.offset, b->shape.offset, 2 * DBL_EPSILON * far + r, r);
    assert_close(a->shape.radius, b->shape.radius, 0, r);
    assert_close(a->shape.half_height, b->shape.half_height, 0, r);
    const pl_polyhedron *p = a->shape.polyhedron, *q = b->shape.polyhedron;
    for (int i = 0; q != NULL && i < q->vertex_count; ++i) {
        assert_vectors(p->vertices[i], q->vertices[i], 0, r);
    }
    if (q != NULL) {
        assert_close(p->volume, q->volume, 0, 1e-12);
        assert_vectors(p->centre, q->centre, 1e-12 * q->radius, 0);
    }
    /* Those of a hull are found again for every copy, and a face of four corners has two ways. */
    if (q != NULL && (!q->convex || exactly)) {
        assert_memory_equal(p->triangles, q->triangles,
                            (size_t)q->triangle_count * sizeof *q->triangles);
    }
}

static void check_there_and_back(const pl_check *check, const pl_transform *transform,
                                 const pl_scene *scene)
{
    if (transform->order != PL_ORDER_SAME || transform->has_copy) {
        return;
    }
    const pl_transform undo = inverse(check, scene);
    const double far = pl_vec_length(pl_vec_of(transform->shift));
    pl_scene there = transformed(transform, scene);
    pl_scene back = transformed(&undo, &there);
    assert_vectors(back.gravity, scene->gravity, 0, 4 * DBL_EPSILON);
    assert_close(back.dt, scene->dt, 0, 4 * DBL_EPSILON);
    assert_close(back.duration, scene->duration, 0, 4 * DBL_EPSILON);
    for (int i = 0; i < scene->body_count; ++i) {
        check_same_body(&back.bodies[i], &scene->bodies[i], far, check->kind == PL_CHECK_AGAIN);
    }
    for (int i = 0; i < scene->force_count; ++i) {
        assert_vectors(back.forces[i].force, scene->forces[i].force, 0, 16 * DBL_EPSILON);
        assert_vectors(back.forces[i].at, scene->forces[i].at, 0, 16 * DBL_EPSILON);
    }
    pl_scene_free(&back);
    pl_scene_free(&there);
}

static void test_inverse_transform_restores_every_scenario(void **state)
{
    (void)state;
    for_every_scenario_and_check(check_there_and_back);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_states_come_back_to_rounding_on_every_scenario),
        cmocka_unit_test(test_transformed_scenes_are_valid_with_equal_steps),
        cmocka_unit_test(test_inverse_transform_restores_every_scenario),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
