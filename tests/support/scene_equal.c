#include "scene_equal.h"

#include "check.h"

#include <string.h>

pl_scene read_scene(const char *text)
{
    pl_scene scene;
    pl_error error = {.message = ""};
    if (pl_scene_read_text(text, strlen(text), "scene", &scene, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return scene;
}

/* Structures are compared member by member: the padding between has no value. */
static void same_doubles(const double *actual, const double *expected, size_t count)
{
    assert_memory_equal(actual, expected, count * sizeof *actual);
}

/* All but the name: a polyhedron without one gets one in a file where bodies share it. */
static void same_polyhedron(const pl_polyhedron *actual, const pl_polyhedron *expected)
{
    assert_int_equal(actual->convex, expected->convex);
    assert_int_equal(actual->vertex_count, expected->vertex_count);
    assert_int_equal(actual->triangle_count, expected->triangle_count);
    same_doubles(actual->vertices[0], expected->vertices[0], 3 * (size_t)expected->vertex_count);
    assert_memory_equal(actual->triangles, expected->triangles,
                        (size_t)expected->triangle_count * sizeof *expected->triangles);
    same_doubles(&actual->volume, &expected->volume, 1);
    same_doubles(actual->centre, expected->centre, 3);
    same_doubles(actual->axes, expected->axes, 4);
    same_doubles(actual->inertia, expected->inertia, 3);
    same_doubles(&actual->radius, &expected->radius, 1);
}

static void same_shape(const pl_shape *actual, const pl_shape *expected)
{
    assert_int_equal(actual->kind, expected->kind);
    same_doubles(actual->normal, expected->normal, 3);
    same_doubles(&actual->offset, &expected->offset, 1);
    same_doubles(&actual->radius, &expected->radius, 1);
    same_doubles(&actual->half_height, &expected->half_height, 1);
    same_doubles(actual->half_extents, expected->half_extents, 3);
    assert_int_equal(actual->polyhedron == NULL, expected->polyhedron == NULL);
    if (expected->polyhedron != NULL) {
        same_polyhedron(actual->polyhedron, expected->polyhedron);
    }
}

void assert_same_body(const pl_body *actual, const pl_body *expected)
{
    assert_string_equal(actual->name, expected->name);
    assert_int_equal(actual->is_static, expected->is_static);
    assert_int_equal(actual->material, expected->material);
    same_shape(&actual->shape, &expected->shape);
    same_doubles(&actual->mass, &expected->mass, 1);
    same_doubles(actual->inertia, expected->inertia, 3);
    same_doubles(actual->position, expected->position, 3);
    same_doubles(actual->orientation, expected->orientation, 4);
    same_doubles(actual->velocity, expected->velocity, 3);
    same_doubles(actual->angular_velocity, expected->angular_velocity, 3);
}

static void same_force(const pl_force *actual, const pl_force *expected)
{
    assert_int_equal(actual->body, expected->body);
    assert_int_equal(actual->frame, expected->frame);
    same_doubles(actual->force, expected->force, 3);
    same_doubles(actual->at, expected->at, 3);
    same_doubles(&actual->from, &expected->from, 1);
    same_doubles(&actual->until, &expected->until, 1);
}

static void same_surfaces(const pl_scene *actual, const pl_scene *expected)
{
    assert_int_equal(actual->material_count, expected->material_count);
    for (int i = 0; i < expected->material_count; ++i) {
        const pl_material *a = &actual->materials[i], *b = &expected->materials[i];
        assert_string_equal(a->name, b->name);
        same_doubles(&a->friction, &b->friction, 1);
        same_doubles(&a->restitution, &b->restitution, 1);
    }
    assert_int_equal(actual->pair_count, expected->pair_count);
    for (int i = 0; i < expected->pair_count; ++i) {
        const pl_material_pair *a = &actual->pairs[i], *b = &expected->pairs[i];
        assert_int_equal(a->material_a, b->material_a);
        assert_int_equal(a->material_b, b->material_b);
        same_doubles(&a->friction, &b->friction, 1);
        same_doubles(&a->restitution, &b->restitution, 1);
    }
}

static void same_expectations(const pl_scene *actual, const pl_scene *expected)
{
    assert_int_equal(actual->rest_count, expected->rest_count);
    for (int i = 0; i < expected->rest_count; ++i) {
        const pl_expect_rest *a = &actual->rests[i], *b = &expected->rests[i];
        assert_int_equal(a->body, b->body);
        assert_int_equal(a->has_orientation, b->has_orientation);
        same_doubles(a->position, b->position, 3);
        if (b->has_orientation) {
            same_doubles(a->orientation, b->orientation, 4);
        }
    }
    assert_int_equal(actual->travel_count, expected->travel_count);
    for (int i = 0; i < expected->travel_count; ++i) {
        const pl_expect_travel *a = &actual->travels[i], *b = &expected->travels[i];
        assert_int_equal(a->body, b->body);
        same_doubles(a->direction, b->direction, 3);
        same_doubles(&a->distance, &b->distance, 1);
        /* NAN has many bit patterns. */
        assert_int_equal(a->discrete != a->discrete, b->discrete != b->discrete);
        if (b->discrete == b->discrete) {
            same_doubles(&a->discrete, &b->discrete, 1);
        }
    }
    assert_int_equal(actual->value_count, expected->value_count);
    for (int i = 0; i < expected->value_count; ++i) {
        const pl_expect_value *a = &actual->values[i], *b = &expected->values[i];
        assert_int_equal(a->body, b->body);
        assert_int_equal(a->quantity, b->quantity);
        same_doubles(a->direction, b->direction, 3);
        same_doubles(&a->from, &b->from, 1);
        same_doubles(&a->until, &b->until, 1);
        same_doubles(&a->value, &b->value, 1);
        assert_int_equal(a->discrete != a->discrete, b->discrete != b->discrete);
        if (b->discrete == b->discrete) {
            same_doubles(&a->discrete, &b->discrete, 1);
        }
        same_doubles(&a->scale, &b->scale, 1);
        same_doubles(&a->answer, &b->answer, 1);
    }
    assert_int_equal(actual->statistic_count, expected->statistic_count);
    for (int i = 0; i < expected->statistic_count; ++i) {
        const pl_expect_statistic *a = &actual->statistics[i], *b = &expected->statistics[i];
        assert_int_equal(a->metric, b->metric);
        same_doubles(&a->low, &b->low, 1);
        same_doubles(&a->high, &b->high, 1);
        same_doubles(&a->scale, &b->scale, 1);
    }
    assert_string_equal(actual->primary_error, expected->primary_error);
    same_doubles(&actual->collapse_distance, &expected->collapse_distance, 1);
}

void assert_same_scene(const pl_scene *actual, const pl_scene *expected)
{
    assert_string_equal(actual->name, expected->name);
    same_doubles(actual->gravity, expected->gravity, 3);
    same_doubles(&actual->dt, &expected->dt, 1);
    same_doubles(&actual->duration, &expected->duration, 1);
    same_surfaces(actual, expected);
    assert_int_equal(actual->body_count, expected->body_count);
    for (int i = 0; i < expected->body_count; ++i) {
        assert_same_body(&actual->bodies[i], &expected->bodies[i]);
    }
    assert_int_equal(actual->force_count, expected->force_count);
    for (int i = 0; i < expected->force_count; ++i) {
        same_force(&actual->forces[i], &expected->forces[i]);
    }
    same_expectations(actual, expected);
}
