/* The scenes of the suite field: the solids that they are made of, and where their bodies must come to rest,
 * by other ways than the builders'. */
#include "check.h"
#include "scenario_scene.h"

#include <math.h>
#include <string.h>

/* The polyhedron of the body of this name. */
static const pl_body *body_named(const pl_scene *scene, const char *name)
{
    for (int i = 0; i < scene->body_count; ++i) {
        if (strcmp(scene->bodies[i].name, name) == 0) {
            return &scene->bodies[i];
        }
    }
    fail_msg("there is no body %s", name);
    return NULL;
}

static void check_volume(const char *scenario, const char *const *settings, const char *body,
                         double volume)
{
    pl_scene scene = scenario_scene(scenario, settings);
    assert_close(body_named(&scene, body)->shape.polyhedron->volume, volume, 0, 1e-12);
    pl_scene_free(&scene);
}

static void test_solids_have_the_volumes_of_their_parts(void **state)
{
    (void)state;
    const double w = 0.5, side = 3, depth = 2.5;
    check_volume("tip-passes", (const char *[]){"tip=0", NULL}, "tip", 1.0 * 3 / 3);
    check_volume("tip-passes", (const char *[]){"tip=1", NULL}, "tip", 2.0 * 3 / 2);
    check_volume("tip-passes", (const char *[]){"ground=2", NULL}, "ground", 30.0 * 8 * 1);
    check_volume("tip-in-gap", (const char *[]){"mesh=1", NULL}, "ground",
                 (side * side - w * w) * depth);
    check_volume("tip-in-gap", (const char *[]){"mesh=1", "tip=1", NULL}, "ground",
                 side * (side * depth - w * 0.9 * depth));
    check_volume("tessellated-rest", (const char *[]){"n=1", NULL}, "slab", 10.0 * 10 * 1);
    check_volume("tessellated-rest", (const char *[]){"n=20", NULL}, "slab", 10.0 * 10 * 1);
}

/* Two triangles for each quad, and as many for each strip of the sides. */
static void test_slabs_have_their_number_of_triangles(void **state)
{
    (void)state;
    static const char *const settings[][2] = {{"n=1", NULL}, {"n=7", NULL}, {"n=40", NULL}};
    static const int counts[] = {1, 7, 40};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("tessellated-rest", settings[i]);
        const pl_polyhedron *slab = body_named(&scene, "slab")->shape.polyhedron;
        const int n = counts[i];
        int on_top = 0;
        for (int t = 0; t < slab->triangle_count; ++t) {
            bool top = true;
            for (int k = 0; k < 3; ++k) {
                top = top && slab->vertices[slab->triangles[t][k]][2] == 0.5;
            }
            on_top += top;
        }
        assert_int_equal(slab->triangle_count, 4 * n * n + 8 * n);
        assert_int_equal(on_top, 2 * n * n);
        pl_scene_free(&scene);
    }
}

/* At the level of the edges the tip at rest is as wide as the gap: bisected along the line from its point to
 * a corner of its base. */
static void test_tip_at_rest_is_as_wide_as_its_gap(void **state)
{
    (void)state;
    static const char *const settings[][3] = {
        {"width=0.3", "tip=0", NULL}, {"width=0.5", "tip=1", NULL}, {"width=0.6", "tip=0", NULL}};
    static const double widths[] = {0.3, 0.5, 0.6};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("tip-in-gap", settings[i]);
        double low = 0, high = 1;
        for (int k = 0; k < 60; ++k) {
            const double middle = (low + high) / 2;
            const double z = scene.rests[0].position[2] + 3 * middle;
            *(z < 0 ? &low : &high) = middle;
        }
        assert_close(2 * 0.5 * low, widths[i], 1e-12, 0);
        assert_close(scene.bodies[scene.rests[0].body].position[2] - scene.rests[0].position[2],
                     0.1, 1e-12, 0);
        pl_scene_free(&scene);
    }
}

/* Boxes of one layer cover its rectangle without a gap and without overlap, and lie on the layer below. */
static void test_layers_of_planks_cover_their_rectangle(void **state)
{
    (void)state;
    pl_scene scene = scenario_scene("kapla", NULL);
    double area = 0, side[2][2] = {{0}};
    assert_int_equal(scene.rest_count, 96);
    for (int i = 1; i < scene.body_count; ++i) {
        const pl_body *a = &scene.bodies[i];
        const double *half = a->shape.half_extents;
        const int layer = (i - 1) / 8;
        assert_close(a->position[2], 0.05 + 0.1 * layer, 1e-12, 0);
        area += 4 * half[0] * half[1];
        for (int k = 0; k < 2; ++k) {
            side[k][0] = fmin(side[k][0], a->position[k] - half[k]);
            side[k][1] = fmax(side[k][1], a->position[k] + half[k]);
        }
        for (int j = i + 1; j < scene.body_count && (j - 1) / 8 == layer; ++j) {
            const pl_body *other = &scene.bodies[j];
            double apart = -1;
            for (int k = 0; k < 2; ++k) {
                apart = fmax(apart, fabs(a->position[k] - other->position[k]) - 2 * half[k]);
            }
            assert_true(apart > -1e-12);
        }
    }
    assert_close(area, 12 * (side[0][1] - side[0][0]) * (side[1][1] - side[1][0]), 1e-12, 0);
    pl_scene_free(&scene);
}

/* A slide of the full time ends where friction has taken all of the energy. */
static void test_slide_over_slab_loses_its_energy_to_friction(void **state)
{
    (void)state;
    pl_scene scene = scenario_scene("tessellated-slide", NULL);
    const double distance = scene.values[0].value, g = 9.81;
    assert_close(0.05 * g * distance, 10.0 * 10 / 2, 1e-10, 0);
    pl_scene_free(&scene);
}

/* Rings are turned by a right angle from one to the next; each touches the one above in one point of their
 * common axis. */
static void test_each_ring_hangs_from_the_one_above(void **state)
{
    (void)state;
    static const char *const settings[] = {"rings=5", NULL};
    pl_scene scene = scenario_scene("linked-rings", settings);
    assert_int_equal(scene.rest_count, 5);
    double reach = 0; /* of the inner side, from the axis down */
    const pl_polyhedron *ring = scene.bodies[0].shape.polyhedron;
    for (int v = 0; v < ring->vertex_count; ++v) {
        const double *p = ring->vertices[v];
        const double radius = sqrt(p[0] * p[0] + p[1] * p[1]);
        reach = v == 0 ? radius : fmin(reach, radius);
    }
    reach *= cos(acos(-1) / 24); /* the middle of a piece */
    for (int i = 1; i <= 5; ++i) {
        const pl_body *body = &scene.bodies[i], *above = &scene.bodies[i - 1];
        assert_close(above->position[2] - body->position[2], 2 * reach, 1e-12, 0);
        assert_close(fabs(body->orientation[1]), i % 2 == 0 ? sqrt(0.5) : 0, 1e-15, 0);
        assert_close(fabs(body->orientation[2]), i % 2 == 0 ? 0 : sqrt(0.5), 1e-15, 0);
    }
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solids_have_the_volumes_of_their_parts),
        cmocka_unit_test(test_slabs_have_their_number_of_triangles),
        cmocka_unit_test(test_tip_at_rest_is_as_wide_as_its_gap),
        cmocka_unit_test(test_layers_of_planks_cover_their_rectangle),
        cmocka_unit_test(test_slide_over_slab_loses_its_energy_to_friction),
        cmocka_unit_test(test_each_ring_hangs_from_the_one_above),
    };
    return cmocka_run_group_tests_name("catalogue_field", tests, NULL, NULL);
}
