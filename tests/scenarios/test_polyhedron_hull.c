/* Hulls of points: that they are convex, hold all points, have no corner too many, and are the same
 * when they are made again. */
#include "check.h"
#include "plumb/vec.h"
#include "solid_for_tests.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 4096 };
static double points[MOST][3];

static const pl_polyhedron *hull_of(int count, pl_scene *scene)
{
    const pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    *scene = pl_scene_default();
    if (pl_scene_add_hull(scene, NULL, (const double(*)[3])points, count, &made, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return made;
}

static void put_point(int i, double x, double y, double z)
{
    const double place[3] = {x, y, z};
    memcpy(points[i], place, sizeof place);
}

static pl_vec corner_of(const pl_polyhedron *p, int triangle, int k)
{
    return pl_vec_of(p->vertices[p->triangles[triangle][k]]);
}

static double size_of(const pl_polyhedron *p)
{
    return 2 * p->radius + pl_vec_length(pl_vec_of(p->centre));
}

static int by_bytes(const void *left, const void *right)
{
    return memcmp(left, right, 2 * sizeof(int));
}

/* Each edge once in each direction, 2 V - 4 triangles: a sphere; no point of points[0 .. count)
 * above any triangle; every triangle turned outward. */
static void check_hull(const pl_polyhedron *p, int count)
{
    static int edges[6 * MOST][2];
    const double rounding = 1e-14 * size_of(p);
    assert_true(p->convex);
    assert_int_equal(p->triangle_count, 2 * p->vertex_count - 4);
    for (int t = 0; t < p->triangle_count; ++t) {
        const pl_vec a = corner_of(p, t, 0);
        const pl_vec normal =
            pl_vec_cross(pl_vec_sub(corner_of(p, t, 1), a), pl_vec_sub(corner_of(p, t, 2), a));
        const double length = pl_vec_length(normal);
        assert_true(length > 0);
        assert_true(pl_vec_dot(pl_vec_sub(a, pl_vec_of(p->centre)), normal) > 0);
        double longest = 0;
        for (int k = 0; k < 3; ++k) {
            edges[3 * t + k][0] = p->triangles[t][k];
            edges[3 * t + k][1] = p->triangles[t][(k + 1) % 3];
            longest =
                fmax(longest,
                     pl_vec_length(pl_vec_sub(corner_of(p, t, (k + 1) % 3), corner_of(p, t, k))));
        }
        /* The plane of a thin triangle is known to rounding over its height. */
        const double tilt = 2 * p->radius * longest / length;
        for (int i = 0; i < count; ++i) {
            const double above = pl_vec_dot(pl_vec_sub(pl_vec_of(points[i]), a), normal) / length;
            assert_at_most(above, rounding * (10 + tilt));
        }
    }
    const size_t edge_count = 3 * (size_t)p->triangle_count;
    qsort(edges, edge_count, sizeof edges[0], by_bytes);
    for (size_t i = 0; i < edge_count; ++i) {
        const int back[2] = {edges[i][1], edges[i][0]};
        assert_non_null(bsearch(back, edges, edge_count, sizeof edges[0], by_bytes));
        assert_true(i == 0 || by_bytes(edges[i - 1], edges[i]) != 0);
    }
}

static void check_made_again(const pl_polyhedron *p)
{
    pl_scene scene = pl_scene_default();
    const pl_polyhedron *again = NULL;
    assert_int_equal(pl_scene_add_hull(&scene, NULL, (const double(*)[3])p->vertices,
                                       p->vertex_count, &again, NULL),
                     PL_OK);
    assert_int_equal(again->vertex_count, p->vertex_count);
    assert_memory_equal(again->vertices, p->vertices,
                        (size_t)p->vertex_count * sizeof *p->vertices);
    assert_memory_equal(again->triangles, p->triangles,
                        (size_t)p->triangle_count * sizeof *p->triangles);
    assert_memory_equal(again->inertia, p->inertia, sizeof p->inertia);
    assert_memory_equal(again->axes, p->axes, sizeof p->axes);
    pl_scene_free(&scene);
}

/* A cube's corners among points inside, on its edges and on its faces, each given twice. */
static void test_grid_hull_is_the_ordered_cube_corners(void **state)
{
    (void)state;
    enum { SIDE = 5 };
    int count = 0;
    for (int copy = 0; copy < 2; ++copy) {
        for (int i = 0; i < SIDE * SIDE * SIDE; ++i) {
            put_point(count++, i % SIDE - 2, i / SIDE % SIDE - 2, i / SIDE / SIDE - 2);
        }
    }
    pl_scene scene;
    const pl_polyhedron *cube = hull_of(count, &scene);
    assert_int_equal(cube->vertex_count, 8);
    for (int i = 0; i < 8; ++i) {
        assert_close(cube->vertices[i][0], i & 1 ? 2 : -2, 0, 0);
        assert_close(cube->vertices[i][1], i & 2 ? 2 : -2, 0, 0);
        assert_close(cube->vertices[i][2], i & 4 ? 2 : -2, 0, 0);
    }
    check_hull(cube, count);
    check_made_again(cube);
    assert_close(cube->volume, 64, 0, 1e-15);
    pl_scene_free(&scene);
}

/* Each corner is farther out than all others in some direction, so none is too many: that of the
 * sum of its triangles' normals. */
static void check_corners(const pl_polyhedron *hull)
{
    for (int v = 0; v < hull->vertex_count; ++v) {
        pl_vec sum = {0, 0, 0};
        for (int t = 0; t < hull->triangle_count; ++t) {
            const int *corner = hull->triangles[t];
            const pl_vec a = corner_of(hull, t, 0);
            const pl_vec n = pl_vec_cross(pl_vec_sub(corner_of(hull, t, 1), a),
                                          pl_vec_sub(corner_of(hull, t, 2), a));
            if (corner[0] == v || corner[1] == v || corner[2] == v) {
                sum = pl_vec_mad(sum, 1 / pl_vec_length(n), n);
            }
        }
        for (int w = 0; w < hull->vertex_count; ++w) {
            const pl_vec arm =
                pl_vec_sub(pl_vec_of(hull->vertices[w]), pl_vec_of(hull->vertices[v]));
            assert_true(w == v || pl_vec_dot(arm, sum) < -1e-9);
        }
    }
}

/* Checks the hull of the first `count` points. */
static void check_hull_of(int count)
{
    pl_scene scene;
    const pl_polyhedron *hull = hull_of(count, &scene);
    check_hull(hull, count);
    check_made_again(hull);
    check_corners(hull);
    pl_scene_free(&scene);
}

/* Points of a lattice: many in one plane and on one line, in every order. */
static void test_hulls_of_lattice_points_have_true_corners_only(void **state)
{
    (void)state;
    check_random random = {.state = 113};
    for (int round = 0; round < 300; ++round) {
        const int count = 8 + round % 100, side = 3 + round % 4;
        for (int i = 0; i < count; ++i) {
            const double z = floor(check_uniform(&random, 0, side));
            const double y = floor(check_uniform(&random, 0, side));
            put_point(i, floor(check_uniform(&random, 0, side)), y, z);
        }
        check_hull_of(count);
    }
}

static void test_random_hulls_contain_all_points(void **state)
{
    (void)state;
    check_random random = {.state = 31};
    for (int round = 0; round < 60; ++round) {
        const int count = 4 + round * 5;
        for (int i = 0; i < count; ++i) {
            const double z = check_uniform(&random, 0, 3), y = check_uniform(&random, -2, 2);
            put_point(i, check_uniform(&random, -1, 1), y, z);
        }
        check_hull_of(count);
    }
}

/* Caps of many corners in one plane, turned so that none of their coordinates is round. */
static void test_turned_prisms_have_flat_caps_of_clear_triangles(void **state)
{
    (void)state;
    static const int sides[] = {3, 5, 12, 64, 500};
    check_random random = {.state = 77};
    for (int round = 0; round < 40; ++round) {
        const int n = sides[round % 5];
        double rotation[4];
        check_quaternion(&random, rotation);
        const pl_axes axes = pl_axes_of(rotation);
        const double far = round % 3 == 0 ? 1000 : 0;
        for (int i = 0; i < 2 * n; ++i) {
            const double angle = (i / 2) * 6.28318530717958647692 / n;
            const pl_vec place =
                pl_to_world(&axes, (pl_vec){cos(angle), sin(angle), i % 2 == 0 ? -0.5 : 0.5});
            put_point(i, place.x + far, place.y, place.z - far);
        }
        pl_scene scene;
        const pl_polyhedron *prism = hull_of(2 * n, &scene);
        assert_int_equal(prism->vertex_count, 2 * n);
        check_hull(prism, 2 * n);
        check_made_again(prism);
        int caps = 0;
        for (int t = 0; t < prism->triangle_count; ++t) {
            const int side = prism->triangles[t][0] % 2;
            const pl_vec a = corner_of(prism, t, 0);
            pl_vec normal = pl_vec_cross(pl_vec_sub(corner_of(prism, t, 1), a),
                                         pl_vec_sub(corner_of(prism, t, 2), a));
            normal = pl_vec_scale(normal, 1 / pl_vec_length(normal));
            if (prism->triangles[t][1] % 2 == side && prism->triangles[t][2] % 2 == side) {
                ++caps;
                assert_close(pl_vec_dot(normal, axes.axis[2]), side == 0 ? -1 : 1, 1e-6, 0);
            }
        }
        assert_int_equal(caps, 2 * (n - 2));
        assert_close(prism->volume, n / 2.0 * sin(6.28318530717958647692 / n), 0, 1e-11);
        pl_scene_free(&scene);
    }
}

static void test_hull_does_not_depend_on_scale(void **state)
{
    (void)state;
    for (int exponent = -40; exponent <= 40; exponent += 8) {
        const double size = pow(10, exponent);
        for (int i = 0; i < 27; ++i) {
            put_point(i, size * (i % 3), 2 * size * (i / 3 % 3), 3 * size * (i / 9));
        }
        pl_scene scene;
        const pl_polyhedron *box = hull_of(27, &scene);
        assert_int_equal(box->vertex_count, 8);
        assert_close(box->volume, 48 * size * size * size, 0, 1e-14);
        assert_close(box->inertia[0], (16 + 36) * size * size / 12, 0, 1e-14);
        pl_scene_free(&scene);
    }
}

static void expect_refused(int count, const char *part)
{
    pl_scene scene = pl_scene_default();
    pl_error error = {.status = PL_OK};
    const pl_polyhedron *made = NULL;
    assert_int_equal(
        pl_scene_add_hull(&scene, NULL, (const double(*)[3])points, count, &made, &error),
        PL_BAD_INPUT);
    assert_contains(error.message, part);
    assert_contains(error.message, "found");
    assert_null(made);
    assert_int_equal(scene.polyhedron_count, 0);
}

static void test_points_without_a_hull_are_refused(void **state)
{
    (void)state;
    check_random random = {.state = 3};
    expect_refused(0, "hull: points: expected 4 to 65536 points, found 0");
    expect_refused(3, "expected 4 to 65536 points, found 3");
    for (int i = 0; i < 100; ++i) {
        put_point(i, 7, 8, 9);
    }
    expect_refused(100, "do not all lie in one plane"); /* one place */
    for (int i = 0; i < 100; ++i) {
        put_point(i, i, 2 * i, -i);
    }
    expect_refused(100, "do not all lie in one plane"); /* one line */
    for (int round = 0; round < 20; ++round) {
        double rotation[4];
        check_quaternion(&random, rotation);
        const pl_axes axes = pl_axes_of(rotation);
        for (int i = 0; i < 100; ++i) {
            const double x = check_uniform(&random, -1, 1), y = check_uniform(&random, -1, 1);
            pl_vec_store(pl_to_world(&axes, (pl_vec){x, y, 1}), points[i]);
        }
        expect_refused(100, "expected points"); /* one plane, to rounding */
    }
    for (int i = 0; i < 8; ++i) {
        put_point(i, i & 1, i & 2, (i & 4) * 1e-9);
    }
    expect_refused(8, "a million times as long as wide");
    points[5][1] = nan("");
    expect_refused(8, "hull: points[5][1]: expected a finite number of at most 1e+50, found nan");
    points[5][1] = -HUGE_VAL;
    expect_refused(8, "hull: points[5][1]: expected a finite number of at most 1e+50, found -inf");
    points[5][1] = 1e51;
    expect_refused(8, "found 1e+51");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid_hull_is_the_ordered_cube_corners),
        cmocka_unit_test(test_hulls_of_lattice_points_have_true_corners_only),
        cmocka_unit_test(test_random_hulls_contain_all_points),
        cmocka_unit_test(test_turned_prisms_have_flat_caps_of_clear_triangles),
        cmocka_unit_test(test_hull_does_not_depend_on_scale),
        cmocka_unit_test(test_points_without_a_hull_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
