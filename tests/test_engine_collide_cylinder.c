/* Narrow phase of cylinders: signed distances against directions swept densely, and the points of
 * cylinders that stand, spin, roll and lie on each other. */
#include "check.h"
#include "collide_convex.h"
#include "shape.h"

typedef struct body {
    pe_shape shape;
    pe_pose pose;
} body;

static pe_placed of(const body *b)
{
    return (pe_placed){&b->shape, NULL, &b->pose, pe_shape_size(&b->shape, NULL)};
}

static void place(body *b, pe_vec3 position, pe_quat q)
{
    q = pe_quat_unit(q);
    b->pose = (pe_pose){position, q, pe_matrix_of(q)};
}

static body make(pe_shape_kind kind, double radius, double half_height, pe_vec3 half_extents)
{
    body b = {.shape = {.kind = kind,
                        .radius = radius,
                        .half_height = half_height,
                        .half_extents = half_extents}};
    place(&b, pe_v3(0, 0, 0), (pe_quat){.w = 1});
    return b;
}

static body cylinder(double radius, double half_height)
{
    return make(PE_SHAPE_CYLINDER, radius, half_height, pe_v3(0, 0, 0));
}

static pe_quat about(pe_vec3 axis, double angle)
{
    double s = sin(0.5 * angle);
    return (pe_quat){cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

static pe_vec3 random_vector(check_random *random, double bound)
{
    double x = check_uniform(random, -bound, bound), y = check_uniform(random, -bound, bound);
    return pe_v3(x, y, check_uniform(random, -bound, bound));
}

static body random_body(check_random *random, pe_shape_kind kind, double spread)
{
    double r = check_uniform(random, 0.1, 1), h = check_uniform(random, 0.1, 1), q[4];
    body b = make(kind, r, h, pe_v3(r, h, check_uniform(random, 0.1, 1)));
    check_quaternion(random, q);
    place(&b, random_vector(random, spread), (pe_quat){q[0], q[1], q[2], q[3]});
    return b;
}

/* How far the body reaches from its centre along the unit direction d. */
static double reach(const body *b, pe_vec3 d)
{
    pe_vec3 local = pe_unrotate(&b->pose.rotation, d), e = b->shape.half_extents;
    double across = sqrt(local.x * local.x + local.y * local.y);
    switch (b->shape.kind) {
    case PE_SHAPE_SPHERE:
        return b->shape.radius;
    case PE_SHAPE_BOX:
        return fabs(local.x) * e.x + fabs(local.y) * e.y + fabs(local.z) * e.z;
    case PE_SHAPE_CAPSULE:
        return fabs(local.z) * b->shape.half_height + b->shape.radius;
    default:
        return fabs(local.z) * b->shape.half_height + across * b->shape.radius;
    }
}

static double separation_along(const body *a, const body *b, pe_vec3 d)
{
    return pe_dot(d, pe_sub(b->pose.position, a->pose.position)) - reach(a, d) - reach(b, d);
}

/* Climbs from d by a pattern of steps that shrink. */
static double refined(const body *a, const body *b, pe_vec3 d, double value)
{
    for (double h = 0.05; h > 1e-9; h *= 0.6) {
        for (bool better = true; better;) {
            better = false;
            pe_vec3 t1, t2;
            pe_tangents(d, &t1, &t2);
            for (int k = 0; k < 12 && !better; ++k) {
                double angle = k * 0.5235987755982988;
                pe_vec3 e = pe_madd(pe_madd(d, h * cos(angle), t1), h * sin(angle), t2);
                e = pe_scale(1 / pe_length(e), e);
                double there = separation_along(a, b, e);
                better = there > value + 1e-15;
                d = better ? e : d;
                value = better ? there : value;
            }
        }
    }
    return value;
}

/* The largest separation over all directions: a dense sweep, then refinement of its best ones. */
static double signed_distance(const body *a, const body *b)
{
    enum { SWEEP = 2000, STARTS = 4 };
    pe_vec3 start[STARTS + 1];
    double value[STARTS + 1];
    int count = 0;
    for (int i = 0; i < SWEEP; ++i) {
        double z = 1 - (2 * i + 1.0) / SWEEP, angle = i * 2.399963229728653, r = sqrt(1 - z * z);
        pe_vec3 d = pe_v3(r * cos(angle), r * sin(angle), z);
        double there = separation_along(a, b, d);
        int j = count;
        for (; j > 0 && value[j - 1] < there; --j) {
            value[j] = value[j - 1];
            start[j] = start[j - 1];
        }
        value[j] = there;
        start[j] = d;
        count = count < STARTS ? count + 1 : STARTS;
    }
    double best = -HUGE_VAL;
    for (int i = 0; i < STARTS; ++i) {
        best = pe_max(best, refined(a, b, start[i], value[i]));
    }
    return best;
}

static double least_separation(const pe_hits *hits)
{
    double least = HUGE_VAL;
    for (int i = 0; i < hits->count; ++i) {
        least = pe_min(least, hits->item[i].separation);
    }
    return least;
}

static void check_against_sweep(pe_shape_kind kind, uint64_t seed)
{
    check_random random = {seed};
    int deep = 0, apart = 0;
    for (int i = 0; i < 120; ++i) {
        body a = random_body(&random, kind, i % 3 == 0 ? 0.2 : 1);
        body b = random_body(&random, PE_SHAPE_CYLINDER, i % 3 == 0 ? 0.2 : 1);
        pe_hits hits;
        collide_convex(of(&a), of(&b), 100, &hits);
        double found = least_separation(&hits), swept = signed_distance(&a, &b);
        /* The answer's own direction proves that it is not too deep; the sweep, which may only fall
         * short, that it is deep enough. */
        assert_close(separation_along(&a, &b, hits.normal), found, 1e-10, 0);
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

static void test_plane_cylinder_separation_is_the_height_of_the_lowest_point(void **state)
{
    (void)state;
    check_random random = {5};
    for (int i = 0; i < 1000; ++i) {
        body plane = {.shape = {.kind = PE_SHAPE_PLANE, .normal = {0.6, 0, 0.8}, .offset = 0.3}};
        body b = random_body(&random, PE_SHAPE_CYLINDER, 1);
        pe_hits hits;
        collide_convex(of(&plane), of(&b), 100, &hits);
        pe_vec3 n = plane.shape.normal;
        double lowest = pe_dot(n, b.pose.position) - 0.3 - reach(&b, n);
        assert_close(least_separation(&hits), lowest, 1e-14, 0);
    }
}

/* A hull with the vertices of a box is no more than the box. */
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
        body box = random_body(&random, PE_SHAPE_BOX, 0.6), hull = box;
        box.shape.half_extents = e;
        hull.shape.kind = PE_SHAPE_HULL;
        /* The hull's own axes are its principal ones. */
        place(&hull,
              pe_add(box.pose.position, pe_rotate(&box.pose.rotation, geometry->frame.centre)),
              pe_quat_product(box.pose.orientation, geometry->frame.orientation));
        body b = random_body(&random, PE_SHAPE_CYLINDER, 0.6);
        pe_hits by_box, by_hull;
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
    body a, b;
    double separation;
} known;

static body at(body b, double x, double y, double z, pe_quat q)
{
    place(&b, pe_v3(x, y, z), q);
    return b;
}

static void test_degenerate_poses_have_their_closed_form(void **state)
{
    (void)state;
    const pe_quat up = {.w = 1}, lying = about(pe_v3(0, 1, 0), 1.5707963267948966);
    const pe_vec3 none = {0, 0, 0};
    body unit = cylinder(1, 1), rod = cylinder(1e-3, 1), disc = cylinder(1, 1e-3);
    body box = make(PE_SHAPE_BOX, 0, 0, pe_v3(1, 1, 1));
    body capsule = make(PE_SHAPE_CAPSULE, 0.5, 1, none);
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
        {"capsule beside", at(capsule, 1.5, 0, 0, up), unit, 0},
    };
    for (size_t i = 0; i < sizeof poses / sizeof *poses; ++i) {
        pe_hits hits;
        collide_convex(of(&poses[i].a), of(&poses[i].b), 10, &hits);
        if (!(fabs(least_separation(&hits) - poses[i].separation) < 1e-12)) {
            print_error("%s\n", poses[i].what);
        }
        assert_close(least_separation(&hits), poses[i].separation, 1e-12, 0);
        assert_close(pe_length(hits.normal), 1, 1e-14, 0);
        for (int k = 0; k < hits.count; ++k) {
            assert_true(pe_is_finite(hits.item[k].position));
        }
    }
}

static bool has_feature(const pe_hits *hits, uint64_t feature)
{
    bool has = false;
    for (int i = 0; i < hits->count; ++i) {
        has = has || hits->item[i].feature == feature;
    }
    return has;
}

static void check_standing(body ground, double top)
{
    check_random random = {7};
    pe_hits first = {0}, hits;
    for (int i = 0; i < 1000; ++i) {
        /* Sways by 1e-9 while it spins as it likes. */
        body b = cylinder(0.5, 0.4);
        pe_quat sway = {1, check_uniform(&random, -1e-10, 1e-10),
                        check_uniform(&random, -1e-10, 1e-10), 0};
        place(&b, pe_v3(0.1, 0.2, top + 0.4 + check_uniform(&random, -1e-9, 1e-9)),
              pe_quat_product(sway, about(pe_v3(0, 0, 1), 0.01 * i)));
        collide_convex(of(&ground), of(&b), 1e-2, &hits);
        first = i == 0 ? hits : first;
        assert_int_equal(hits.count, 4);
        for (int k = 0; k < 4; ++k) {
            pe_vec3 x = pe_sub(hits.item[k].position, pe_v3(0.1, 0.2, top));
            assert_true(has_feature(&first, hits.item[k].feature));
            assert_close(sqrt(x.x * x.x + x.y * x.y), 0.5, 1e-9, 0);
            assert_at_most(pe_length(pe_sub(hits.item[k].position, first.item[k].position)), 2e-9);
        }
    }
}

static void test_cylinder_that_spins_upright_keeps_its_points_in_place(void **state)
{
    (void)state;
    check_standing((body){.shape = {.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}}}, 0);
    check_standing(make(PE_SHAPE_BOX, 0, 0, pe_v3(3, 2, 1)), 1);
    check_standing(cylinder(2, 1), 1);
}

static void test_tilted_cylinder_has_its_lowest_point(void **state)
{
    (void)state;
    for (double tilt = 1e-7; tilt < 0.7; tilt *= 3) {
        body b = cylinder(0.5, 0.4),
             plane = {.shape = {.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}}};
        place(&b, pe_v3(0, 0, 1), about(pe_v3(0.6, 0.8, 0), tilt));
        pe_hits hits;
        collide_convex(of(&plane), of(&b), 2, &hits);
        pe_vec3 lowest = pe_v3(0, 0, 0);
        for (int i = 0; i < hits.count; ++i) {
            bool is_lowest = hits.item[i].separation == least_separation(&hits);
            lowest = is_lowest ? hits.item[i].position : lowest;
        }
        /* Down the slope of the cap: across the axis of the tilt. */
        assert_close(0.6 * lowest.x + 0.8 * lowest.y, 0, 1e-7, 0);
        assert_close(least_separation(&hits), 1 - 0.4 * cos(tilt) - 0.5 * sin(tilt), 1e-14, 0);
    }
}

static void check_rolling(body ground, double top)
{
    pe_hits before = {0}, hits;
    for (int i = 0; i < 1000; ++i) {
        body b = cylinder(0.5, 0.4);
        double angle = 1e-3 * i;
        pe_quat lying = about(pe_v3(1, 0, 0), 1.5707963267948966);
        place(&b, pe_v3(0.5 * angle, 0, top + 0.5),
              pe_quat_product(about(pe_v3(0, 1, 0), angle), lying));
        collide_convex(of(&ground), of(&b), 1e-2, &hits);
        assert_int_equal(hits.count, 2);
        assert_close(fabs(hits.normal.z), 1, 1e-12, 0);
        for (int k = 0; k < 2; ++k) {
            assert_close(hits.item[k].position.x, 0.5 * angle, 1e-9, 0);
            assert_close(fabs(hits.item[k].position.y), 0.4, 1e-9, 0);
            assert_true(i == 0 || hits.item[k].feature == before.item[k].feature);
        }
        before = hits;
    }
}

static void test_rolling_cylinder_touches_at_the_ends_of_the_line_below_its_axis(void **state)
{
    (void)state;
    check_rolling((body){.shape = {.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}}}, 0);
    check_rolling(make(PE_SHAPE_BOX, 0, 0, pe_v3(3, 2, 1)), 1);
    check_rolling(cylinder(3, 1), 1);
}

/* Overlap of a cap with a face, whose corners all count. */
static void test_cap_wider_than_a_box_stands_on_the_corners(void **state)
{
    (void)state;
    body box = make(PE_SHAPE_BOX, 0, 0, pe_v3(0.3, 0.2, 1)), b = cylinder(1, 0.5);
    place(&b, pe_v3(0, 0, 1.5), (pe_quat){.w = 1});
    pe_hits hits;
    collide_convex(of(&box), of(&b), 1e-3, &hits);
    assert_int_equal(hits.count, 4);
    for (int i = 0; i < 4; ++i) {
        assert_close(fabs(hits.item[i].position.x), 0.3, 1e-12, 0);
        assert_close(fabs(hits.item[i].position.y), 0.2, 1e-12, 0);
    }
}

static void test_overhanging_cap_has_the_crossings_of_rim_and_edge(void **state)
{
    (void)state;
    body box = make(PE_SHAPE_BOX, 0, 0, pe_v3(1, 1, 1)), b = cylinder(0.5, 0.5);
    place(&b, pe_v3(1.1, 0, 1.5), (pe_quat){.w = 1});
    pe_hits hits;
    collide_convex(of(&box), of(&b), 1e-3, &hits);
    int crossings = 0;
    double across = sqrt(0.25 - 0.01);
    for (int i = 0; i < hits.count; ++i) {
        pe_vec3 x = hits.item[i].position;
        crossings += fabs(x.x - 1) < 1e-12 && fabs(fabs(x.y) - across) < 1e-12;
        assert_at_most(x.x, 1 + 1e-12);
    }
    assert_int_equal(crossings, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere_cylinder_separation_equals_dense_direction_sweep),
        cmocka_unit_test(test_box_cylinder_separation_equals_dense_direction_sweep),
        cmocka_unit_test(test_capsule_cylinder_separation_equals_dense_direction_sweep),
        cmocka_unit_test(test_cylinder_cylinder_separation_equals_dense_direction_sweep),
        cmocka_unit_test(test_plane_cylinder_separation_is_the_height_of_the_lowest_point),
        cmocka_unit_test(test_cube_as_hull_gives_the_same_as_box),
        cmocka_unit_test(test_degenerate_poses_have_their_closed_form),
        cmocka_unit_test(test_cylinder_that_spins_upright_keeps_its_points_in_place),
        cmocka_unit_test(test_tilted_cylinder_has_its_lowest_point),
        cmocka_unit_test(test_rolling_cylinder_touches_at_the_ends_of_the_line_below_its_axis),
        cmocka_unit_test(test_cap_wider_than_a_box_stands_on_the_corners),
        cmocka_unit_test(test_overhanging_cap_has_the_crossings_of_rim_and_edge),
    };
    return cmocka_run_group_tests_name("engine_collide_cylinder", tests, NULL, NULL);
}
