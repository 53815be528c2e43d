/* Meshes: what is refused and where, what is made good, and which way surfaces face. */
#include "check.h"
#include "plumb/vec.h"
#include "solid_for_tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static solid_surface surface; /* too large for the stack */

static const double origin[3] = {0, 0, 0};
static const double ones[3] = {1, 1, 1};

static pl_status add_mesh(pl_scene *scene, const pl_polyhedron **made, pl_error *error)
{
    *scene = pl_scene_default();
    *made = NULL;
    return pl_scene_add_mesh(scene, NULL, (const double(*)[3])surface.vertices,
                             surface.vertex_count, (const int(*)[3])surface.triangles,
                             surface.triangle_count, made, error);
}

static double volume_of_mesh(void)
{
    pl_scene scene;
    const pl_polyhedron *made;
    pl_error error = {.message = ""};
    if (add_mesh(&scene, &made, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    const double volume = made->volume;
    pl_scene_free(&scene);
    return volume;
}

static void expect_refused(const char *message)
{
    pl_scene scene;
    const pl_polyhedron *made;
    pl_error error = {.status = PL_OK};
    assert_int_equal(add_mesh(&scene, &made, &error), PL_BAD_INPUT);
    assert_contains(error.message, message);
    assert_null(made);
    assert_int_equal(scene.polyhedron_count, 0);
}

static void make_cube(void)
{
    known_clear(&surface);
    known_add_box(&surface, origin, ones, false);
}

static void test_faults_of_a_triangle_are_located(void **state)
{
    (void)state;
    make_cube();
    surface.triangles[7][2] = 8;
    expect_refused("mesh: triangles[7][2]: expected the index of a vertex from 0 to 7, found 8 in "
                   "triangle 7");
    surface.triangles[7][2] = -1;
    expect_refused("mesh: triangles[7][2]: expected the index of a vertex from 0 to 7, found -1");
    make_cube();
    surface.triangles[3][1] = surface.triangles[3][2];
    expect_refused("mesh: triangles[3]: expected three different vertices, found 4, 6 and 6 in "
                   "triangle 3");
    make_cube();
    surface.vertices[6][0] = nan("");
    expect_refused("mesh: vertices[6][0]: expected a finite number of at most 1e+50, found nan");
    make_cube();
    /* The triangle 0 of vertices 0, 2, 3 becomes a line. */
    surface.vertices[2][0] = -0.5;
    surface.vertices[2][1] = -0.5;
    surface.vertices[3][0] = 0;
    surface.vertices[3][1] = 0;
    expect_refused("mesh: triangles[0]: expected a triangle with an area, found vertices 0, 2 and "
                   "3 of triangle 0 on one line");
    surface.triangle_count = 3;
    expect_refused("mesh: triangles: expected 4 to 2097152 triangles, found 3");
    surface.vertex_count = 3;
    expect_refused("mesh: vertices: expected 4 to 2097152 vertices, found 3");
}

static void test_every_open_edge_is_found(void **state)
{
    (void)state;
    for (int t = 0; t < 12; ++t) {
        make_cube();
        memmove(surface.triangles[t], surface.triangles[t + 1],
                (size_t)(11 - t) * sizeof surface.triangles[0]);
        --surface.triangle_count;
        expect_refused("expected a closed surface, each edge of two triangles, found triangle ");
    }
    make_cube();
    known_add_vertex(&surface, 5, 5, 5);
    known_add_triangle(&surface, 0, 1, 8);
    expect_refused("mesh: triangles[1]: expected each edge to be of two triangles, found that of "
                   "vertices 0 and 1 in 3, such as triangles 1, 4 and 12");
}

/* The projective plane of six vertices: each edge of two triangles, and only one side. */
static void test_surface_with_one_side_is_refused(void **state)
{
    (void)state;
    static const int plane[10][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                                     {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
    check_random random = {.state = 4};
    known_clear(&surface);
    for (int i = 0; i < 6; ++i) {
        const double z = check_uniform(&random, -1, 1), y = check_uniform(&random, -1, 1);
        known_add_vertex(&surface, check_uniform(&random, -1, 1), y, z);
    }
    for (int t = 0; t < 10; ++t) {
        known_add_triangle(&surface, plane[t][0], plane[t][1], plane[t][2]);
    }
    expect_refused("expected a surface with two sides, found that triangles ");
}

static void test_any_winding_gives_the_same_solid(void **state)
{
    (void)state;
    pl_scene scene, other;
    const pl_polyhedron *right, *made;
    make_cube();
    assert_int_equal(add_mesh(&scene, &right, NULL), PL_OK);
    for (int winding = 0; winding < 4096; winding += 37) {
        make_cube();
        for (int t = 0; t < 12; ++t) {
            if (winding >> t & 1) {
                int *corner = surface.triangles[t];
                const int swapped = corner[1];
                corner[1] = corner[2];
                corner[2] = swapped;
            }
        }
        assert_int_equal(add_mesh(&other, &made, NULL), PL_OK);
        assert_close(made->volume, 8, 0, 1e-15);
        assert_memory_equal(made->triangles, right->triangles, 12 * sizeof *made->triangles);
        pl_scene_free(&other);
    }
    pl_scene_free(&scene);
}

static void test_unused_vertices_are_left_out(void **state)
{
    (void)state;
    pl_scene scene;
    const pl_polyhedron *made;
    known_clear(&surface);
    known_add_vertex(&surface, 1e6, 0, 0);
    known_add_box(&surface, origin, ones, false);
    known_add_vertex(&surface, 0, 1e6, 0);
    assert_int_equal(add_mesh(&scene, &made, NULL), PL_OK);
    assert_int_equal(made->vertex_count, 8);
    assert_close(made->radius, sqrt(3), 0, 1e-15);
    assert_close(made->vertices[made->triangles[0][0]][2], -1, 0, 0);
    pl_scene_free(&scene);
}

/* Two boxes at every small whole offset: they are apart, touch, lie in each other or cross, as the
 * numbers say. */
static void test_boxes_cross_where_their_insides_partly_overlap(void **state)
{
    (void)state;
    const double half[3] = {1, 1, 1}, other_half[2][3] = {{1, 1, 1}, {0.5, 2, 1}};
    int crossing = 0, others = 0;
    for (int i = 0; i < 2 * 7 * 7 * 7; ++i) {
        const double *h = other_half[i / 343];
        const double centre[3] = {(i % 7 - 3) * 0.75, (i / 7 % 7 - 3) * 0.75,
                                  (i / 49 % 7 - 3) * 0.75};
        bool overlap = true, within = true, around = true;
        for (int k = 0; k < 3; ++k) {
            overlap = overlap && fabs(centre[k]) < half[k] + h[k];
            within = within && fabs(centre[k]) + h[k] < half[k];
            around = around && fabs(centre[k]) + half[k] < h[k];
        }
        known_clear(&surface);
        known_add_box(&surface, origin, half, false);
        known_add_box(&surface, centre, h, false);
        if (overlap && !within && !around) {
            expect_refused("expected a surface that does not cross itself");
            ++crossing;
        } else {
            assert_close(volume_of_mesh(), 8 + 8 * h[0] * h[1] * h[2], 0, 1e-14);
            ++others;
        }
    }
    assert_true(crossing > 100 && others > 100);
}

/* The edges of two tetrahedra in a cube cross in the middles of its faces: no edge goes through a
 * triangle's inside. */
static void test_star_of_two_tetrahedra_crosses(void **state)
{
    (void)state;
    known_clear(&surface);
    for (int star = 0; star < 2; ++star) {
        const int first = surface.vertex_count;
        for (int i = 0; i < 8; ++i) {
            if (((i & 1) + (i >> 1 & 1) + (i >> 2 & 1)) % 2 == star) {
                known_add_vertex(&surface, i & 1, i >> 1 & 1, i >> 2 & 1);
            }
        }
        for (int skipped = 0; skipped < 4; ++skipped) {
            known_add_triangle(&surface, first + (skipped + 1) % 4, first + (skipped + 2) % 4,
                               first + (skipped + 3) % 4);
        }
    }
    expect_refused("expected a surface that does not cross itself");
}

/* A pyramid on a square, whose apex is pushed straight down through the base: triangles with one
 * common vertex cross. */
static void test_triangles_with_a_common_vertex_can_cross(void **state)
{
    (void)state;
    static const double low[2] = {0.5, 4};
    for (int i = 0; i < 2; ++i) {
        known_clear(&surface);
        /* Two pyramids of one apex; the second one's base reaches into the first or not. */
        const int apex = known_add_vertex(&surface, 0, 0, 0);
        for (int p = 0; p < 2; ++p) {
            const int first = surface.vertex_count;
            const double x = p == 0 ? 0 : low[i];
            known_add_vertex(&surface, x - 1, -1, 2);
            known_add_vertex(&surface, x + 1, -1, 2);
            known_add_vertex(&surface, x, 1, 2);
            known_add_triangle(&surface, apex, first + 1, first);
            known_add_triangle(&surface, apex, first + 2, first + 1);
            known_add_triangle(&surface, apex, first, first + 2);
            known_add_triangle(&surface, first, first + 1, first + 2);
        }
        if (i == 0) {
            expect_refused("expected a surface that does not cross itself");
        } else {
            assert_close(volume_of_mesh(), 2 * 4.0 / 3, 0, 1e-14);
        }
    }
}

/* Two solids whose distance is within rounding touch, at every place and angle. */
static void test_touching_within_rounding_is_not_crossing(void **state)
{
    (void)state;
    check_random random = {.state = 17};
    const double beside[3] = {2, 0.5, 0.25}, far[3] = {100, -200, 300};
    for (int i = 0; i < 100; ++i) {
        double rotation[4];
        check_quaternion(&random, rotation);
        make_cube();
        known_add_box(&surface, beside, ones, false);
        known_move(&surface, rotation, far);
        assert_close(volume_of_mesh(), 16, 0, 1e-10);
    }
}

static void test_self_crossing_surface_is_found_anywhere(void **state)
{
    (void)state;
    double radius[32], height[32];
    for (int j = 0; j < 32; ++j) { /* a figure of eight turned about an axis next to it */
        const double angle = j * 6.28318530717958647692 / 32 + 0.05;
        radius[j] = 3 + cos(angle);
        height[j] = sin(2 * angle) + 0.3 * cos(angle);
    }
    check_random random = {.state = 61};
    for (int i = 0; i < 20; ++i) {
        double rotation[4];
        check_quaternion(&random, rotation);
        known_clear(&surface);
        known_add_rings(&surface, 40, radius, height, 32, true);
        known_move(&surface, rotation, origin);
        expect_refused("mesh: triangles[");
        expect_refused("in each other");
    }
}

static void test_surface_that_encloses_nothing_is_refused(void **state)
{
    (void)state;
    const double vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, 0}};
    const int triangles[4][3] = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {2, 1, 0}};
    known_make_tetrahedron(&surface, vertices, triangles);
    expect_refused("expected a surface that encloses a volume, found 0 m^3 in that of triangle 0");
}

static void test_mesh_made_again_from_itself_is_the_same(void **state)
{
    (void)state;
    const double inner[3] = {0.5, 0.5, 0.5};
    pl_scene scene, other;
    const pl_polyhedron *made, *again;
    known_clear(&surface);
    known_add_vertex(&surface, 9, 9, 9);
    known_add_box(&surface, origin, ones, true);
    known_add_box(&surface, origin, inner, false);
    assert_int_equal(add_mesh(&scene, &made, NULL), PL_OK);
    other = pl_scene_default();
    assert_int_equal(pl_scene_add_mesh(&other, "again", (const double(*)[3])made->vertices,
                                       made->vertex_count, (const int(*)[3])made->triangles,
                                       made->triangle_count, &again, NULL),
                     PL_OK);
    assert_string_equal(again->name, "again");
    assert_false(again->convex);
    assert_int_equal(again->vertex_count, 16);
    assert_memory_equal(again->vertices, made->vertices, 16 * sizeof *made->vertices);
    assert_memory_equal(again->triangles, made->triangles, 24 * sizeof *made->triangles);
    assert_memory_equal(again->inertia, made->inertia, sizeof made->inertia);
    pl_scene_free(&scene);
    pl_scene_free(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_faults_of_a_triangle_are_located),
        cmocka_unit_test(test_every_open_edge_is_found),
        cmocka_unit_test(test_surface_with_one_side_is_refused),
        cmocka_unit_test(test_any_winding_gives_the_same_solid),
        cmocka_unit_test(test_unused_vertices_are_left_out),
        cmocka_unit_test(test_boxes_cross_where_their_insides_partly_overlap),
        cmocka_unit_test(test_star_of_two_tetrahedra_crosses),
        cmocka_unit_test(test_triangles_with_a_common_vertex_can_cross),
        cmocka_unit_test(test_touching_within_rounding_is_not_crossing),
        cmocka_unit_test(test_self_crossing_surface_is_found_anywhere),
        cmocka_unit_test(test_surface_that_encloses_nothing_is_refused),
        cmocka_unit_test(test_mesh_made_again_from_itself_is_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
