/* Volume, centre of mass and principal inertia of polyhedra against closed forms, slices, and the
 * same solid turned, moved, and cut another way. */
#include "check.h"
#include "plumb/vec.h"
#include "solid_for_tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double no_shift[3] = {0, 0, 0};
static const double no_turn[4] = {1, 0, 0, 0};

/* The mesh of a surface, in a scene of its own. */
static const pl_polyhedron *mesh_of(const solid_surface *s, pl_scene *scene)
{
    const pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    *scene = pl_scene_default();
    if (pl_scene_add_mesh(scene, NULL, s->vertices, s->vertex_count, s->triangles,
                          s->triangle_count, &made, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return made;
}

static void check_mesh(const solid_surface *s, const solid_moments *expected,
                       const double rotation[4], const double shift[3], double relative)
{
    pl_scene scene;
    known_check(mesh_of(s, &scene), expected, rotation, shift, relative);
    pl_scene_free(&scene);
}

static solid_surface surface; /* too large for the stack */

static void test_off_centre_box_equals_the_closed_form(void **state)
{
    (void)state;
    const double centre[3] = {5, -7, 11}, half[3] = {0.5, 1.5, 0.25};
    const int plus = 1;
    const solid_moments expected = known_moments_of_boxes(&centre, &half, &plus, 1);
    known_clear(&surface);
    known_add_box(&surface, centre, half, false);
    check_mesh(&surface, &expected, NULL, NULL, 1e-15);
    pl_scene scene;
    const pl_polyhedron *box = mesh_of(&surface, &scene);
    assert_memory_equal(box->axes, no_turn, sizeof no_turn);
    assert_memory_equal(box->centre, centre, sizeof centre);
    const pl_shape same = pl_shape_box(half[0], half[1], half[2]);
    double inertia[3];
    pl_shape_inertia(&same, 1, inertia);
    for (int k = 0; k < 3; ++k) {
        assert_close(box->inertia[k], inertia[k], 0, 1e-14); /* not sorted */
    }
    assert_close(box->radius, sqrt(0.25 + 2.25 + 0.0625), 0, 1e-15);
    pl_scene_free(&scene);
}

/* Of the corner of a cube, V = 1/6, <x> = 1/4; <x^2> = 1/10 and <x y> = 1/20 about the corner:
 * Dirichlet's integral. */
static void test_tetrahedron_has_the_closed_form(void **state)
{
    (void)state;
    const double vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const int triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    known_make_tetrahedron(&surface, vertices, triangles);
    solid_moments expected = {.volume = 1.0 / 6, .mean = {0.25, 0.25, 0.25}};
    for (int i = 0; i < 9; ++i) {
        expected.square[i / 3][i % 3] = (i / 3 == i % 3 ? 0.1 : 0.05) - 1.0 / 16;
    }
    check_mesh(&surface, &expected, NULL, NULL, 1e-15);
}

static void test_prism_has_the_closed_form_of_its_polygon(void **state)
{
    (void)state;
    const double radius[2] = {0.75, 0.75}, height[2] = {-2, 1};
    static const int sides[] = {3, 4, 7, 64, 1000};
    for (int i = 0; i < 5; ++i) {
        const solid_moments expected = known_moments_of_rings(sides[i], radius, height, 2, false);
        const double angle = 6.28318530717958647692 / sides[i];
        assert_close(expected.volume, 3 * sides[i] / 2.0 * 0.75 * 0.75 * sin(angle), 0, 1e-14);
        assert_close(expected.square[2][2], 9.0 / 12, 0, 1e-14);
        known_clear(&surface);
        known_add_rings(&surface, sides[i], radius, height, 2, false);
        check_mesh(&surface, &expected, NULL, NULL, 1e-13);
    }
}

static void torus_rings(double radius[12], double height[12])
{
    for (int j = 0; j < 12; ++j) {
        radius[j] = 2 + 0.5 * cos(j * 6.28318530717958647692 / 12);
        height[j] = 0.5 * sin(j * 6.28318530717958647692 / 12);
    }
}

static void test_torus_equals_its_slices(void **state)
{
    (void)state;
    double radius[12], height[12];
    torus_rings(radius, height);
    const solid_moments expected = known_moments_of_rings(24, radius, height, 12, true);
    known_clear(&surface);
    known_add_rings(&surface, 24, radius, height, 12, true);
    check_mesh(&surface, &expected, NULL, NULL, 1e-14);
    pl_scene scene;
    const pl_polyhedron *torus = mesh_of(&surface, &scene);
    assert_memory_equal(torus->centre, no_shift, sizeof no_shift); /* not rounding of it */
    assert_memory_equal(torus->axes, no_turn, sizeof no_turn);
    pl_scene_free(&scene);
    /* Of the round torus: 2 pi^2 R r^2, to the 24 and 12 sides' shortfall. */
    assert_close(expected.volume, 2 * 9.8696044 * 2 * 0.25, 0, 0.06);
}

/* The axes, centre and inertia go with the solid; a turned box is far from its axes. */
static void test_turned_and_moved_solids_keep_their_moments(void **state)
{
    (void)state;
    double radius[12], height[12];
    torus_rings(radius, height);
    const double centres[2][3] = {{0, 0, 0}, {2, 1, 0.5}}, halves[2][3] = {{1, 2, 3}, {1, 1, 1}};
    static const int signs[2] = {1, 1};
    check_random random = {.state = 5};
    for (int i = 0; i < 200; ++i) {
        double rotation[4], shift[3];
        check_quaternion(&random, rotation);
        for (int k = 0; k < 3; ++k) {
            shift[k] = check_uniform(&random, -10, 10);
        }
        const int count = i % 2 + 1; /* one box, or two that touch */
        const solid_moments expected = known_moments_of_boxes(centres, halves, signs, count);
        known_clear(&surface);
        for (int b = 0; b < count; ++b) {
            known_add_box(&surface, centres[b], halves[b], false);
        }
        known_move(&surface, rotation, shift);
        check_mesh(&surface, &expected, rotation, shift, 1e-13);
    }
    const solid_moments torus = known_moments_of_rings(24, radius, height, 12, true);
    const double rotation[4] = {0.5, 0.5, -0.5, 0.5}, shift[3] = {1, 2, 3};
    known_clear(&surface);
    known_add_rings(&surface, 24, radius, height, 12, true);
    known_move(&surface, rotation, shift);
    check_mesh(&surface, &torus, rotation, shift, 1e-14);
}

/* Coordinates that a million does not round: the very same bits. */
static void test_far_solid_has_the_same_inertia(void **state)
{
    (void)state;
    const double centre[3] = {0.5, -0.75, 0.25}, half[3] = {0.5, 1.5, 0.25};
    const double far[3] = {1e6, -1e6, 1e6};
    known_clear(&surface);
    known_add_box(&surface, centre, half, false);
    pl_scene near_scene, far_scene;
    const pl_polyhedron *near = mesh_of(&surface, &near_scene);
    known_move(&surface, no_turn, far);
    const pl_polyhedron *moved = mesh_of(&surface, &far_scene);
    assert_memory_equal(moved->inertia, near->inertia, sizeof near->inertia);
    assert_memory_equal(moved->axes, near->axes, sizeof near->axes);
    assert_close(moved->volume, near->volume, 0, 0);
    assert_close(moved->radius, near->radius, 0, 0);
    for (int k = 0; k < 3; ++k) {
        assert_close(moved->centre[k], near->centre[k] + far[k], 0, 0);
    }
    pl_scene_free(&near_scene);
    pl_scene_free(&far_scene);
    /* And others, by what a million rounds. */
    double radius[12], height[12];
    torus_rings(radius, height);
    const solid_moments torus = known_moments_of_rings(24, radius, height, 12, true);
    known_clear(&surface);
    known_add_rings(&surface, 24, radius, height, 12, true);
    known_move(&surface, no_turn, far);
    check_mesh(&surface, &torus, NULL, far, 1e-9);
}

static void test_halves_have_the_moments_of_the_whole(void **state)
{
    (void)state;
    const double whole[3] = {0, 0, 0}, whole_half[3] = {2, 1, 1};
    const double parts[2][3] = {{-1, 0, 0}, {1, 0, 0}}, part_half[3] = {1, 1, 1};
    pl_scene one, two;
    known_clear(&surface);
    known_add_box(&surface, whole, whole_half, false);
    const pl_polyhedron *a = mesh_of(&surface, &one);
    known_clear(&surface);
    known_add_box(&surface, parts[0], part_half, false);
    known_add_box(&surface, parts[1], part_half, false);
    const pl_polyhedron *b = mesh_of(&surface, &two);
    assert_close(b->volume, a->volume, 0, 1e-15);
    for (int k = 0; k < 3; ++k) {
        assert_close(b->inertia[k], a->inertia[k], 0, 1e-14);
        assert_close(b->centre[k], a->centre[k], 1e-15, 0);
    }
    pl_scene_free(&one);
    pl_scene_free(&two);
}

static void test_cavities_are_subtracted_and_their_contents_added(void **state)
{
    (void)state;
    const double centres[3][3] = {{0, 0, 0}, {0.5, 0.25, 0}, {0.5, 0, 0.25}};
    const double halves[3][3] = {{2, 2, 2}, {1, 1.25, 1}, {0.5, 0.5, 0.5}};
    static const int signs[3] = {1, -1, 1};
    const solid_moments expected = known_moments_of_boxes(centres, halves, signs, 3);
    for (int winding = 0; winding < 8; ++winding) {
        known_clear(&surface);
        for (int b = 0; b < 3; ++b) {
            known_add_box(&surface, centres[b], halves[b], (winding >> b & 1) != 0);
        }
        check_mesh(&surface, &expected, NULL, NULL, 1e-14);
    }
}

/* A rod of 1 m and 20 micrometres about its length, whose inertia is 1e-10 of the others. */
static void test_turned_rod_keeps_the_inertia_about_its_length(void **state)
{
    (void)state;
    const double centre[3] = {0, 0, 0}, half[3] = {0.5, 1e-5, 1e-5};
    check_random random = {.state = 8};
    for (int i = 0; i < 50; ++i) {
        double rotation[4], least = HUGE_VAL;
        check_quaternion(&random, rotation);
        known_clear(&surface);
        known_add_box(&surface, centre, half, false);
        known_move(&surface, i == 0 ? no_turn : rotation, no_shift);
        pl_scene scene;
        const pl_polyhedron *rod = mesh_of(&surface, &scene);
        for (int k = 0; k < 3; ++k) {
            least = fmin(least, rod->inertia[k]);
        }
        /* <x^2> is known to 1e-16, of which the small ones are 4e-10. */
        assert_close(least, 2.0 / 3 * 1e-10, 0, 1e-5);
        pl_scene_free(&scene);
    }
}

static void test_axes_are_right_handed_and_diagonalise(void **state)
{
    (void)state;
    check_random random = {.state = 21};
    for (int round = 0; round < 100; ++round) {
        double points[30][3];
        for (int i = 0; i < 90; ++i) {
            points[i / 3][i % 3] = check_uniform(&random, -1, 1) * (1 + i % 3);
        }
        pl_scene scene = pl_scene_default();
        const pl_polyhedron *p = NULL;
        assert_int_equal(pl_scene_add_hull(&scene, NULL, (const double(*)[3])points, 30, &p, NULL),
                         PL_OK);
        const double *q = p->axes;
        assert_close(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-15, 0);
        /* In the frame of its axes it has the identity. */
        known_clear(&surface);
        const pl_axes axes = pl_axes_of(q);
        for (int i = 0; i < p->vertex_count; ++i) {
            const pl_vec local = pl_to_local(&axes, pl_vec_of(p->vertices[i]));
            known_add_vertex(&surface, local.x, local.y, local.z);
        }
        memcpy(surface.triangles, p->triangles, (size_t)p->triangle_count * sizeof *p->triangles);
        surface.triangle_count = p->triangle_count;
        pl_scene turned_scene;
        const pl_polyhedron *turned = mesh_of(&surface, &turned_scene);
        assert_memory_equal(turned->axes, no_turn, sizeof no_turn);
        for (int k = 0; k < 3; ++k) {
            assert_close(turned->inertia[k], p->inertia[k], 0, 1e-13);
        }
        pl_scene_free(&turned_scene);
        pl_scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_off_centre_box_equals_the_closed_form),
        cmocka_unit_test(test_tetrahedron_has_the_closed_form),
        cmocka_unit_test(test_prism_has_the_closed_form_of_its_polygon),
        cmocka_unit_test(test_torus_equals_its_slices),
        cmocka_unit_test(test_turned_and_moved_solids_keep_their_moments),
        cmocka_unit_test(test_far_solid_has_the_same_inertia),
        cmocka_unit_test(test_halves_have_the_moments_of_the_whole),
        cmocka_unit_test(test_cavities_are_subtracted_and_their_contents_added),
        cmocka_unit_test(test_turned_rod_keeps_the_inertia_about_its_length),
        cmocka_unit_test(test_axes_are_right_handed_and_diagonalise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
