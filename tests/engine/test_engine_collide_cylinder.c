/* Narrow phase of cylinders: signed distances against a dense sweep over directions, closed forms
 * and a proven interval. */
#include "check.h"
#include "collide_convex.h"
#include "convex_truth.h"
#include "direction_sweep.h"

static placed_shape random_shape(check_random *random, pe_shape_kind kind, double spread)
{
    double r = check_uniform(random, 0.1, 1), h = check_uniform(random, 0.1, 1), q[4];
    placed_shape b = shape_of(kind, r, h, pe_v3(r, h, check_uniform(random, 0.1, 1)));
    check_quaternion(random, q);
    place(&b, random_vector(random, spread), (pe_quat){q[0], q[1], q[2], q[3]});
    return b;
}

static void check_against_sweep(pe_shape_kind kind, uint64_t seed)
{
    check_random random = {seed};
    int deep = 0, apart = 0;
    for (int i = 0; i < 120; ++i) {
        placed_shape a = random_shape(&random, kind, i % 3 == 0 ? 0.2 : 1);
        placed_shape b = random_shape(&random, PE_SHAPE_CYLINDER, i % 3 == 0 ? 0.2 : 1);
        pe_pair_manifold manifold;
        collide_convex(of(&a), of(&b), 100, &manifold);
        double found = least_separation(&manifold), swept = swept_distance(&a, &b);
        /* The reported direction proves that the distance is not too small; the sweep, which is a
         * lower bound, that it is not too large. */
        assert_close(separation_along(&a, &b, manifold.normal), found, 1e-10, 0);
        assert_at_most(swept, found + 1e-10);
        deep += found < 0;
        apart += found > 0;
    }
    assert_true(deep > 25 && apart > 10);
}

static void test_sphere_cylinder_separation_equals_dense_direction_sweep(void **state)
{
    (void)state;
    check_against_sweep(PE_SHAPE_SPHERE, 1);
}

static void test_box_cylinder_separation_equals_dense_direction_sweep(void **state)
{
    (void)state;
    check_against_sweep(PE_SHAPE_BOX, 2);
}

static void test_capsule_cylinder_separation_equals_dense_direction_sweep(void **state)
{
    (void)state;
    check_against_sweep(PE_SHAPE_CAPSULE, 3);
}

static void test_cylinder_cylinder_separation_equals_dense_direction_sweep(void **state)
{
    (void)state;
    check_against_sweep(PE_SHAPE_CYLINDER, 4);
}

static void test_plane_cylinder_separation_is_lowest_height(void **state)
{
    (void)state;
    check_random random = {5};
    for (int i = 0; i < 1000; ++i) {
        placed_shape plane = {
            .shape = {.kind = PE_SHAPE_PLANE, .normal = {0.6, 0, 0.8}, .offset = 0.3}};
        placed_shape b = random_shape(&random, PE_SHAPE_CYLINDER, 1);
        pe_pair_manifold manifold;
        collide_convex(of(&plane), of(&b), 100, &manifold);
        pe_vec3 n = plane.shape.normal;
        double lowest = pe_dot(n, b.pose.position) - 0.3 - reach_along(&b, n);
        assert_close(least_separation(&manifold), lowest, 1e-14, 0);
    }
}

/* A hull with the vertices of a box is the box. */
static void test_cube_as_hull_gives_the_same_as_box(void **state)
{
    (void)state;
    static const uint32_t triangles[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                              {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                              {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    pe_vec3 e = pe_v3(0.7, 0.5, 0.3), vertices[8];
    for (int i = 0; i < 8; ++i) {
        vertices[i] = pe_v3(i & 1 ? e.x : -e.x, i & 2 ? e.y : -e.y, i & 4 ? e.z : -e.z);
    }
    const pe_geometry_def def = {vertices, triangles, 8, 12, true};
    pe_allocator allocator = pe_allocator_default();
    pe_geometry *geometry;
    assert_int_equal(pe_geometry_make(&def, &allocator, &geometry, NULL), PE_OK);
    check_random random = {6};
    for (int i = 0; i < 2000; ++i) {
        placed_shape box = random_shape(&random, PE_SHAPE_BOX, 0.6), hull = box;
        box.shape.half_extents = e;
        hull.shape.kind = PE_SHAPE_HULL;
        /* The hull's own axes are its principal ones. */
        place(&hull,
              pe_add(box.pose.position, pe_rotate(&box.pose.rotation, geometry->frame.centre)),
              pe_quat_product(box.pose.orientation, geometry->frame.orientation));
        placed_shape b = random_shape(&random, PE_SHAPE_CYLINDER, 0.6);
        pe_pair_manifold by_box, by_hull;
        collide_convex(of(&box), of(&b), 10, &by_box);
        collide_convex((pe_placed){&hull.shape, geometry, &hull.pose, geometry->size}, of(&b), 10,
                       &by_hull);
        assert_close(least_separation(&by_hull), least_separation(&by_box), 1e-9, 0);
        assert_close(separation_along(&box, &b, by_hull.normal), least_separation(&by_box), 1e-9,
                     0);
    }
    pe_geometry_free(geometry, &allocator);
}

typedef struct known {
    const char *what;
    placed_shape a, b;
    double separation;
} known;

static placed_shape at(placed_shape b, double x, double y, double z, pe_quat q)
{
    place(&b, pe_v3(x, y, z), q);
    return b;
}

static void test_degenerate_poses_have_their_closed_form(void **state)
{
    (void)state;
    const pe_quat up = {.w = 1}, lying = about(pe_v3(0, 1, 0), 1.5707963267948966);
    const pe_vec3 none = {0, 0, 0};
    placed_shape unit = cylinder(1, 1), rod = cylinder(1e-3, 1), disc = cylinder(1, 1e-3);
    placed_shape box = shape_of(PE_SHAPE_BOX, 0, 0, pe_v3(1, 1, 1));
    placed_shape capsule = shape_of(PE_SHAPE_CAPSULE, 0.5, 1, none);
    const known poses[] = {
        {"concentric", unit, unit, -2},
        {"concentric, axes crossed", unit, at(unit, 0, 0, 0, lying), -2},
        {"coaxial, caps touch", unit, at(unit, 0, 0, 2, up), 0},
        {"coaxial, apart", unit, at(unit, 0, 0, 2.5, up), 0.5},
        {"side by side", unit, at(unit, 2, 0, 0, up), 0},
        {"side by side, one end beyond the other", unit, at(unit, 2.25, 0, 1.5, up), 0.25},
        {"rims apart", unit, at(unit, 2.3, 0, 2.4, up), 0.5},
        {"sides crossed", unit, at(unit, 0, 2.125, 0, lying), 0.125},
        {"lying on a cap", unit, at(unit, 0, 0, 2, lying), 0},
        {"rod through disc", disc, rod, -1.001},
        {"rod along rod", rod, at(rod, 3e-3, 0, 0, up), 1e-3},
        {"disc on disc", disc, at(disc, 0.5, 0, 2e-3, up), 0},
        {"discs edge to edge", disc, at(disc, 2.5, 0, 0, up), 0.5},
        {"on a box", box, at(unit, 0, 0, 2, up), 0},
        {"lying on a box", box, at(unit, 0, 0, 2, lying), 0},
        {"inside a box", box, at(unit, 0, 0, 0, up), -2},
        {"along a box's edge", box, at(unit, 1.6, 1.8, 0, up), 0},
        {"capsule along the axis", capsule, unit, -1.5},
        {"capsule across the axis", at(capsule, 0, 0, 0, lying), unit, -1.5},
        {"capsule on a cap", at(capsule, 0, 0, 1.5, lying), unit, 0},
        {"capsule next to", at(capsule, 1.5, 0, 0, up), unit, 0},
    };
    for (size_t i = 0; i < sizeof poses / sizeof *poses; ++i) {
        pe_pair_manifold manifold;
        collide_convex(of(&poses[i].a), of(&poses[i].b), 10, &manifold);
        if (!(fabs(least_separation(&manifold) - poses[i].separation) < 1e-12)) {
            print_error("%s\n", poses[i].what);
        }
        assert_close(least_separation(&manifold), poses[i].separation, 1e-12, 0);
        assert_close(pe_length(manifold.normal), 1, 1e-14, 0);
        for (int k = 0; k < manifold.count; ++k) {
            assert_true(pe_is_finite(manifold.item[k].position));
        }
    }
}

/* The distance of a point outside a cylinder or a box. */
static double outside(const placed_shape *b, pe_vec3 x)
{
    pe_vec3 p = pe_unrotate(&b->pose.rotation, pe_sub(x, b->pose.position));
    const pe_shape *s = &b->shape;
    if (s->kind == PE_SHAPE_BOX) {
        pe_vec3 e = s->half_extents;
        return pe_max(0, pe_max(fabs(p.x) - e.x, pe_max(fabs(p.y) - e.y, fabs(p.z) - e.z)));
    }
    double past = sqrt(p.x * p.x + p.y * p.y) - s->radius, over = fabs(p.z) - s->half_height;
    return pe_max(0, pe_max(past, over));
}

/* Each point, moved by half the separation along the normal, lies in either shape. */
static void check_points_are_in_both(const placed_shape *a, const placed_shape *b,
                                     const pe_pair_manifold *manifold)
{
    double size = pe_min(of(a).size, of(b).size);
    assert_true(manifold->count > 0);
    for (int i = 0; i < manifold->count; ++i) {
        double half = 0.5 * manifold->item[i].separation;
        assert_at_most(outside(a, pe_madd(manifold->item[i].position, -half, manifold->normal)),
                       1e-8 * size);
        assert_at_most(outside(b, pe_madd(manifold->item[i].position, half, manifold->normal)),
                       1e-8 * size);
    }
}

/* Turns both about the origin. */
static void turn_both(placed_shape *a, placed_shape *b, check_random *random)
{
    double q[4];
    check_quaternion(random, q);
    pe_quat turn = pe_quat_unit((pe_quat){q[0], q[1], q[2], q[3]});
    pe_mat3 matrix = pe_matrix_of(turn);
    placed_shape *both[2] = {a, b};
    for (int i = 0; i < 2; ++i) {
        place(both[i], pe_rotate(&matrix, both[i]->pose.position),
              pe_quat_product(turn, both[i]->pose.orientation));
    }
}

/* A number from 1e-10 to 1 with a uniform logarithm. */
static double of_any_order(check_random *random)
{
    return pow(10, check_uniform(random, -10, 0));
}

/* Cylinders end to end, with axes that are parallel except for a tilt of 1e-1 down to 1e-10, whose
 * rims, seen along them, touch or nearly do: there are the maxima of two rims within the tilt of an
 * axis, and ridges along which the separation hardly changes. */
static void test_nearly_tangent_rims_equal_proven_distance(void **state)
{
    (void)state;
    enum { POSES = 600 };
    check_random random = {11};
    int proven = 0;
    for (int i = 0; i < POSES; ++i) {
        placed_shape a = random_cylinder(&random, 0.1, 1);
        placed_shape b = random_cylinder(&random, 0.01, 1);
        double size = pe_min(of(&a).size, of(&b).size), ra = a.shape.radius, rb = b.shape.radius;
        double sideways = i % 2 == 0 ? ra + rb : fabs(ra - rb);
        sideways += of_any_order(&random) * size * (i % 3 - 1);
        double gap = of_any_order(&random) * size * (i % 5 - 2);
        double tilt = of_any_order(&random), way = check_uniform(&random, 0, 6.28);
        place(&b, pe_v3(sideways, 0, a.shape.half_height + b.shape.half_height + gap),
              about(pe_v3(cos(way), sin(way), 0), tilt));
        turn_both(&a, &b, &random);
        pe_pair_manifold manifold;
        collide_convex(of(&a), of(&b), 10, &manifold);
        truth_difference difference =
            truth_subtract((truth_solid){.shape = &a.shape, .pose = &a.pose},
                           (truth_solid){.shape = &b.shape, .pose = &b.pose});
        truth_distance truth = truth_signed_distance(&difference, 1e-10 * size);
        assert_at_most(truth.low - 1e-9 * size, least_separation(&manifold));
        assert_at_most(least_separation(&manifold), truth.high + 1e-9 * size);
        assert_close(separation_along(&a, &b, manifold.normal), least_separation(&manifold),
                     1e-9 * size, 0);
        check_points_are_in_both(&a, &b, &manifold);
        proven += truth.high - truth.low < 1e-9 * size;
    }
    assert_true(proven > POSES / 2);
}

/* A cap whose rim meets the edge of another cylinder at one point, so that all of the cap is
 * equally far along the normal. */
static void test_side_touching_cap_at_rim_has_that_point(void **state)
{
    (void)state;
    check_random random = {12};
    for (int i = 0; i < 1000; ++i) {
        placed_shape a = random_cylinder(&random, 0.1, 1);
        placed_shape b = random_cylinder(&random, 0.1, 1);
        pe_quat lying = about(pe_v3(1, 0, 0), 1.5707963267948966);
        place(&b,
              pe_v3(0, a.shape.radius + b.shape.half_height, a.shape.half_height + b.shape.radius),
              lying);
        turn_both(&a, &b, &random);
        pe_pair_manifold manifold;
        collide_convex(of(&a), of(&b), 1e-2, &manifold);
        assert_close(least_separation(&manifold), 0, 1e-14, 0);
        check_points_are_in_both(&a, &b, &manifold);
    }
}

/* Axes parallel to 2e-12, the rims 1.74e-7 m beside each other and 3.5e-8 m apart in height. The distance is
 * that of the rims, as the reference search of the pair tests finds it. */
static void test_distance_of_rims_of_nearly_parallel_cylinders(void **state)
{
    (void)state;
    placed_shape a = cylinder(0.018958415760785243, 0.35986334085133875), b = a;
    place(&a, pe_v3(0, 0, 0), (pe_quat){.w = 1});
    place(&b, pe_v3(-0.037883744399432193, 0.0015878263023025019, 0.7197267163462252),
          (pe_quat){0.76604681474960545, -3.0004360122070402e-13, -9.5486258749437605e-13,
                    -0.64278478327662991});
    pe_pair_manifold manifold;
    collide_convex(of(&a), of(&b), 1e-3, &manifold);
    assert_close(least_separation(&manifold), 1.7708334059797775e-07, 1e-12, 0);
}

/* The distance (m) of x from the cylinder. */
static double off_cylinder(const placed_shape *c, pe_vec3 x)
{
    pe_vec3 y = pe_unrotate(&c->pose.rotation, pe_sub(x, c->pose.position));
    return hypot(pe_max(0, hypot(y.x, y.y) - c->shape.radius),
                 pe_max(0, fabs(y.z) - c->shape.half_height));
}

/* Caps tilted by 5e-5, which overlap in a narrow lens: the rims do not cross as circles in one plane. */
static void test_points_of_tilted_caps_lie_on_both(void **state)
{
    (void)state;
    placed_shape a = cylinder(0.35645697253112651, 2.9161521320993193),
                 b = cylinder(0.11458524235050681, 0.016518732863353782);
    place(&a, pe_v3(0, 0, 0), (pe_quat){1, 0, 0, 0});
    place(&b, pe_v3(0.47076758300501936, 4.5419069968300222e-07, 2.9326709043535213),
          (pe_quat){0.7365199622587002, -2.3069398933480806e-05, -4.7948708780319349e-06,
                    0.67641580750249686});
    pe_pair_manifold manifold;
    collide_convex(of(&a), of(&b), 1, &manifold);
    assert_true(manifold.count > 1);
    for (int i = 0; i < manifold.count; ++i) {
        const pe_pair_point *p = &manifold.item[i];
        double half = 0.5 * p->separation;
        assert_at_most(off_cylinder(&a, pe_madd(p->position, -half, manifold.normal)), 1e-9);
        assert_at_most(off_cylinder(&b, pe_madd(p->position, half, manifold.normal)), 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_distance_of_rims_of_nearly_parallel_cylinders),
        cmocka_unit_test(test_points_of_tilted_caps_lie_on_both),
        cmocka_unit_test(test_sphere_cylinder_separation_equals_dense_direction_sweep),
        cmocka_unit_test(test_box_cylinder_separation_equals_dense_direction_sweep),
        cmocka_unit_test(test_capsule_cylinder_separation_equals_dense_direction_sweep),
        cmocka_unit_test(test_cylinder_cylinder_separation_equals_dense_direction_sweep),
        cmocka_unit_test(test_plane_cylinder_separation_is_lowest_height),
        cmocka_unit_test(test_cube_as_hull_gives_the_same_as_box),
        cmocka_unit_test(test_degenerate_poses_have_their_closed_form),
        cmocka_unit_test(test_nearly_tangent_rims_equal_proven_distance),
        cmocka_unit_test(test_side_touching_cap_at_rim_has_that_point),
    };
    return cmocka_run_group_tests_name("engine_collide_cylinder", tests, NULL, NULL);
}
