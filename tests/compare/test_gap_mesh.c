/* Gaps of meshes, against convex shapes with the same surface and against rings by closed form. */
#include "referee/geometry/gap.h"

#include "check.h"
#include "polyhedra.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static pl_placed_shape placed_at(const pl_shape *shape, double x, double y, double z)
{
    return (pl_placed_shape){.shape = shape, .position = {x, y, z}, .orientation = {1, 0, 0, 0}};
}

static double gap_of(const pl_placed_shape *a, const pl_placed_shape *b)
{
    double gap = nan("");
    assert_int_equal(pl_gap(a, b, HUGE_VAL, &gap), PL_OK);
    return gap;
}

/* ---- Convex meshes against hulls ---- */

enum { HULLS = 10 };

typedef struct pool {
    pl_scene scene;
    check_random random;
    pl_shape hulls[HULLS], meshes[HULLS];
    pl_arena arena; /* of the surfaces */
    const pl_surface *surfaces[HULLS];
} pool;

static void fill_pool(pool *p, uint64_t seed)
{
    p->scene = pl_scene_default();
    p->random.state = seed;
    for (int i = 0; i < HULLS; ++i) {
        const pl_polyhedron *hull = random_hull(&p->scene, &p->random, 4 + 3 * i);
        p->hulls[i] = pl_shape_of(hull);
        p->meshes[i] = pl_shape_of(mesh_of(&p->scene, hull));
        p->surfaces[i] = pl_surface_create(&p->meshes[i], &p->arena);
    }
}

static void empty_pool(pool *p)
{
    pl_arena_free(&p->arena);
    pl_scene_free(&p->scene);
}

/* The shape of a pair's second body: convex, and as it is measured against the mesh. */
typedef struct partner {
    pl_shape convex, measured;
    const pl_surface *surface;
} partner;

enum { PARTNERS = 6 };

static partner random_partner(pool *p, int which)
{
    int hull = (int)check_uniform(&p->random, 0, HULLS);
    double r = check_uniform(&p->random, 0.1, 0.6), h = check_uniform(&p->random, 0.1, 0.6);
    const pl_shape shapes[PARTNERS] = {pl_shape_sphere(r),     pl_shape_box(r, h, 0.4),
                                       pl_shape_capsule(r, h), pl_shape_cylinder(r, h),
                                       p->hulls[hull],         p->hulls[hull]};
    partner made = {.convex = shapes[which], .measured = shapes[which]};
    if (which == PARTNERS - 1) {
        made.measured = p->meshes[hull];
        made.surface = p->surfaces[hull];
    }
    return made;
}

typedef struct mesh_pair {
    partner other;
    pl_placed_shape hull, convex; /* as two convex shapes */
    pl_placed_shape mesh, measured;
} mesh_pair;

static void place_pair(pool *p, mesh_pair *pair, int which)
{
    int i = (int)check_uniform(&p->random, 0, HULLS);
    pair->other = random_partner(p, which);
    pair->hull = placed_at(&p->hulls[i], 0, 0, 0);
    pair->convex = placed_at(&pair->other.convex, 0, 0, 0);
    check_quaternion(&p->random, pair->hull.orientation);
    check_quaternion(&p->random, pair->convex.orientation);
    for (int k = 0; k < 3; ++k) {
        pair->convex.position[k] = check_uniform(&p->random, -1.5, 1.5);
    }
    pair->mesh = pair->hull;
    pair->mesh.shape = &p->meshes[i];
    pair->mesh.surface = p->surfaces[i];
}

static void set_measured(mesh_pair *pair)
{
    pair->measured = pair->convex;
    pair->measured.shape = &pair->other.measured;
    pair->measured.surface = pair->other.surface;
}

/* Slides the second along a ray from the first until their gap as convex shapes is -depth. */
static void slide_to(pool *p, mesh_pair *pair, double depth)
{
    double direction[3], low = 0, high = 6;
    for (int k = 0; k < 3; ++k) {
        direction[k] = check_uniform(&p->random, -1, 1);
    }
    direction[0] += 1.1;
    for (int i = 0; i < 55; ++i) {
        double middle = (low + high) / 2;
        for (int k = 0; k < 3; ++k) {
            pair->convex.position[k] = middle * direction[k];
        }
        if (gap_of(&pair->hull, &pair->convex) < -depth) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

static void test_mesh_apart_has_the_distance_of_its_hull(void **state)
{
    (void)state;
    static pool p;
    int apart = 0;
    fill_pool(&p, UINT64_C(88172645463325252));
    for (int i = 0; i < 300 * PARTNERS; ++i) {
        mesh_pair pair;
        double hull;
        place_pair(&p, &pair, i % PARTNERS);
        set_measured(&pair);
        assert_int_equal(pl_gap_convex(&pair.hull, &pair.convex, HUGE_VAL, &hull), PL_OK);
        if (hull > 0) {
            apart += 1;
            assert_close(gap_of(&pair.mesh, &pair.measured), hull, 1e-10, 0);
        } else {
            assert_true(gap_of(&pair.mesh, &pair.measured) < 0);
        }
    }
    assert_true(apart > 100 * PARTNERS);
    empty_pool(&p);
}

/* All pairs of features: vertex in face, edge across edge, face on face, rim on edge. An overlap
 * near a sharp corner is not shallow, and the depth of the mesh may be less than the minimum
 * translation. */
static void test_shallow_mesh_has_the_depth_of_its_hull(void **state)
{
    (void)state;
    static pool p;
    int same = 0, seen = 0;
    fill_pool(&p, UINT64_C(362436069));
    for (int i = 0; i < 120 * PARTNERS; ++i) {
        mesh_pair pair;
        place_pair(&p, &pair, i % PARTNERS);
        slide_to(&p, &pair, 1e-6);
        set_measured(&pair);
        double hull = -gap_of(&pair.hull, &pair.convex);
        if (fabs(hull - 1e-6) > 1e-8) {
            continue; /* the ray has missed, or the depth is below the resolution of libccd */
        }
        double depth = -gap_of(&pair.mesh, &pair.measured);
        assert_true(depth >= 0.5 * hull);
        assert_at_most(depth, hull + 1e-10);
        seen += 1;
        same += fabs(depth - hull) < 1e-10;
    }
    assert_true(seen > 60 * PARTNERS);
    assert_true(same >= 0.98 * seen);
    empty_pool(&p);
}

static void test_mesh_gap_is_independent_of_order_and_bound(void **state)
{
    (void)state;
    static pool p;
    fill_pool(&p, UINT64_C(777));
    for (int i = 0; i < 100 * PARTNERS; ++i) {
        mesh_pair pair;
        double within = check_uniform(&p.random, 0, 0.5), bounded;
        place_pair(&p, &pair, i % PARTNERS);
        set_measured(&pair);
        double gap = gap_of(&pair.mesh, &pair.measured);
        assert_close(gap_of(&pair.measured, &pair.mesh), gap, 1e-12, 0);
        pair.mesh.surface = pair.measured.surface = NULL; /* made for the call */
        assert_int_equal(pl_gap(&pair.mesh, &pair.measured, within, &bounded), PL_OK);
        if (gap > within) {
            assert_true(bounded > within);
        } else {
            assert_close(bounded, gap, 1e-12, 0);
        }
    }
    empty_pool(&p);
}

/* ---- Boxes ---- */

/* Face on face, for all sizes of cells and rotations about the vertical. */
static void test_box_mesh_on_box_has_the_face_depth(void **state)
{
    (void)state;
    check_random random = {UINT64_C(99)};
    pl_scene scene = pl_scene_default();
    const double half[3] = {0.5, 0.4, 0.3}, middle[3] = {1, -2, 3};
    for (int i = 0; i < 60; ++i) {
        pl_shape mesh = pl_shape_of(box_mesh(&scene, half, middle, 1 + i % 4));
        pl_shape box = pl_shape_box(0.45, 0.6, 0.2);
        double angle = check_uniform(&random, 0, 6),
               depth = pow(10, check_uniform(&random, -9, -2));
        pl_placed_shape a = placed_at(&mesh, -1, 2, -3);
        double y = check_uniform(&random, -0.3, 0.3), x = check_uniform(&random, -0.3, 0.3);
        pl_placed_shape b = placed_at(&box, x, y, 0.5 - depth);
        b.orientation[0] = cos(angle / 2);
        b.orientation[3] = sin(angle / 2);
        assert_close(gap_of(&a, &b), -depth, 1e-14, 0);
        b.position[2] = 0.5 + depth;
        assert_close(gap_of(&a, &b), depth, 1e-14, 0);
    }
    pl_scene_free(&scene);
}

/* Two bars that cross, edge over edge: no vertex of either is in the other. */
static void test_crossing_bars_have_the_depth_between_edges(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    const double half[3] = {2, 0.1, 0.1}, middle[3] = {0, 0, 0};
    const double eighth[4] = {cos(pi / 8), sin(pi / 8), 0, 0};
    pl_shape bar = pl_shape_of(box_mesh(&scene, half, middle, 1));
    pl_placed_shape a = placed_at(&bar, 0, 0, 0), b = placed_at(&bar, 0, 0, 0);
    memcpy(a.orientation, eighth, sizeof eighth);
    /* The same, rotated by a quarter turn about the vertical. */
    const double r = sqrt(0.5);
    const double turned[4] = {r * eighth[0], r * eighth[1], r * eighth[1], r * eighth[0]};
    memcpy(b.orientation, turned, sizeof turned);
    for (int power = 1; power <= 10; ++power) {
        double depth = 0.5 * pow(10, -power);
        b.position[2] = 0.2 * sqrt(2) - depth;
        assert_close(gap_of(&a, &b), -depth, 1e-14, 0);
        b.position[2] = 0.2 * sqrt(2) + depth;
        assert_close(gap_of(&a, &b), depth, 1e-14, 0);
    }
    pl_scene_free(&scene);
}

/* A contained solid touches no surface; its depth is that of its deepest point. */
static void test_contained_solid_has_its_deepest_points_depth(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    const double large[3] = {1, 1, 1}, small[3] = {0.1, 0.1, 0.1}, middle[3] = {0, 0, 0};
    pl_shape outer = pl_shape_of(box_mesh(&scene, large, middle, 3));
    const pl_shape inner[] = {pl_shape_of(box_mesh(&scene, small, middle, 2)),
                              pl_shape_box(0.1, 0.1, 0.1), pl_shape_sphere(0.1),
                              pl_shape_cylinder(0.1, 0.1), pl_shape_capsule(0.05, 0.05)};
    const double depth[] = {0.6, 0.6, 0.6, 0.6, 0.5};
    for (int i = 0; i < 5; ++i) {
        pl_placed_shape a = placed_at(&outer, 0, 0, 0), b = placed_at(&inner[i], 0.5, 0, 0);
        assert_close(gap_of(&a, &b), -depth[i] - (i == 4 ? 0.05 : 0), 1e-14, 0);
    }
    pl_shape cylinder = pl_shape_cylinder(1, 1), mesh = inner[0];
    pl_placed_shape a = placed_at(&cylinder, 0, 0, 0), b = placed_at(&mesh, 0, 0, 0.5);
    assert_close(gap_of(&a, &b), -0.6, 1e-14, 0);
    pl_scene_free(&scene);
}

/* ---- Rings ---- */

/* Coaxial, with their corners in line: the sides of the polygons are nearer than their corners. */
static void test_ring_inside_a_ring_has_the_side_distance(void **state)
{
    (void)state;
    enum { AROUND = 24 };
    pl_scene scene = pl_scene_default();
    pl_shape outer = pl_shape_of(torus_mesh(&scene, 1, 0.25, AROUND, 12));
    pl_shape inner = pl_shape_of(torus_mesh(&scene, 0.4, 0.125, AROUND, 8));
    pl_placed_shape a = placed_at(&outer, 3, 4, 5), b = placed_at(&inner, 3, 4, 5);
    const double side = cos(pi / AROUND);
    assert_close(gap_of(&a, &b), (0.75 - 0.525) * side, 1e-14, 0);
    /* A little off the centre, towards the middle of a side. */
    b.position[0] += 0.1 * side;
    b.position[1] += 0.1 * sin(pi / AROUND);
    assert_close(gap_of(&a, &b), (0.75 - 0.525) * side - 0.1, 1e-14, 0);
    /* Pins through the hole. */
    const pl_shape pins[] = {pl_shape_capsule(0.5, 1), pl_shape_cylinder(0.5, 1),
                             pl_shape_sphere(0.5)};
    for (int i = 0; i < 3; ++i) {
        b = placed_at(&pins[i], 3, 4, 5);
        assert_close(gap_of(&a, &b), 0.75 * side - 0.5, 1e-9, 0);
    }
    pl_scene_free(&scene);
}

/* At the middle of a segment of the tube all its sides are normal to the plane of the cross
 * section, so the distance is that from the polygon in the plane. */
static void test_sphere_in_a_tube_has_its_centre_depth(void **state)
{
    (void)state;
    enum { AROUND = 20, SIDES = 10 };
    check_random random = {UINT64_C(5150)};
    pl_scene scene = pl_scene_default();
    pl_shape ring = pl_shape_of(torus_mesh(&scene, 1, 0.25, AROUND, SIDES));
    pl_shape ball = pl_shape_sphere(0.1);
    for (int i = 0; i < 500; ++i) {
        double u = check_uniform(&random, 0.75, 1.22), z = check_uniform(&random, -0.24, 0.24);
        double nearest = HUGE_VAL;
        bool inside = true;
        for (int j = 0; j < SIDES; ++j) {
            double from = 2 * pi * j / SIDES, to = 2 * pi * (j + 1) / SIDES, c = cos(pi / AROUND);
            double p[2] = {(1 + 0.25 * cos(from)) * c, 0.25 * sin(from)};
            double e[2] = {(1 + 0.25 * cos(to)) * c - p[0], 0.25 * sin(to) - p[1]};
            double d[2] = {u - p[0], z - p[1]}, square = e[0] * e[0] + e[1] * e[1];
            double t = fmin(fmax((d[0] * e[0] + d[1] * e[1]) / square, 0), 1);
            nearest = fmin(nearest, hypot(d[0] - t * e[0], d[1] - t * e[1]));
            inside = inside && e[0] * d[1] - e[1] * d[0] > 0;
        }
        pl_placed_shape a = placed_at(&ring, 0, 0, 0);
        pl_placed_shape b = placed_at(&ball, u * cos(pi / AROUND), u * sin(pi / AROUND), z);
        assert_close(gap_of(&a, &b), (inside ? -nearest : nearest) - 0.1, 1e-14, 0);
    }
    pl_scene_free(&scene);
}

/* Links of a chain, one upright and one lying: the tube of one, 1 from its centre, is in the hole
 * of the other. Exact to the size of the facets. */
static void test_linked_rings_are_apart_until_their_tubes_meet(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    pl_shape ring = pl_shape_of(torus_mesh(&scene, 1, 0.25, 32, 16));
    const double r = sqrt(0.5);
    pl_placed_shape a = placed_at(&ring, 0, 0, 0);
    for (double x = 0.6; x < 1.4; x += 0.05) {
        pl_placed_shape b = placed_at(&ring, x, 0, 0);
        const double quarter[4] = {r, r, 0, 0};
        memcpy(b.orientation, quarter, sizeof quarter);
        double gap = gap_of(&a, &b);
        assert_close(gap, 0.5 - fabs(x - 1), 0.02, 0);
    }
    pl_scene_free(&scene);
}

static void test_mesh_plane_gap_is_the_lowest_vertex(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    pl_shape ring = pl_shape_of(torus_mesh(&scene, 1, 0.25, 32, 16));
    pl_shape plane = pl_shape_plane(0, 0, 1, 0.5);
    pl_placed_shape a = placed_at(&ring, 3, 4, 0.7), b = placed_at(&plane, 0, 0, 0);
    assert_close(gap_of(&a, &b), 0.7 - 0.25 - 0.5, 1e-14, 0);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mesh_apart_has_the_distance_of_its_hull),
        cmocka_unit_test(test_shallow_mesh_has_the_depth_of_its_hull),
        cmocka_unit_test(test_mesh_gap_is_independent_of_order_and_bound),
        cmocka_unit_test(test_box_mesh_on_box_has_the_face_depth),
        cmocka_unit_test(test_crossing_bars_have_the_depth_between_edges),
        cmocka_unit_test(test_contained_solid_has_its_deepest_points_depth),
        cmocka_unit_test(test_ring_inside_a_ring_has_the_side_distance),
        cmocka_unit_test(test_sphere_in_a_tube_has_its_centre_depth),
        cmocka_unit_test(test_linked_rings_are_apart_until_their_tubes_meet),
        cmocka_unit_test(test_mesh_plane_gap_is_the_lowest_vertex),
    };
    return cmocka_run_group_tests_name("gap mesh", tests, NULL, NULL);
}
