/* Manifold points of cylinders that stand, spin, roll and lie on other shapes. */
#include "check.h"
#include "collide_convex.h"
#include "polytopes.h"

static bool has_feature(const pe_pair_manifold *manifold, uint64_t feature)
{
    bool has = false;
    for (int i = 0; i < manifold->count; ++i) {
        has = has || manifold->item[i].feature == feature;
    }
    return has;
}

static void check_standing(placed_shape ground, double top)
{
    check_random random = {7};
    pe_pair_manifold first = {0}, manifold;
    for (int i = 0; i < 1000; ++i) {
        /* Sways by 1e-9 at any angle of spin. */
        placed_shape b = cylinder(0.5, 0.4);
        pe_quat sway = {.w = 1};
        sway.x = check_uniform(&random, -1e-10, 1e-10);
        sway.y = check_uniform(&random, -1e-10, 1e-10);
        place(&b, pe_v3(0.1, 0.2, top + 0.4 + check_uniform(&random, -1e-9, 1e-9)),
              pe_quat_product(sway, about(pe_v3(0, 0, 1), 0.01 * i)));
        collide_convex(of(&ground), of(&b), 1e-2, &manifold);
        first = i == 0 ? manifold : first;
        assert_int_equal(manifold.count, 4);
        for (int k = 0; k < 4; ++k) {
            pe_vec3 x = pe_sub(manifold.item[k].position, pe_v3(0.1, 0.2, top));
            assert_true(has_feature(&first, manifold.item[k].feature));
            assert_close(sqrt(x.x * x.x + x.y * x.y), 0.5, 1e-9, 0);
            assert_at_most(pe_length(pe_sub(manifold.item[k].position, first.item[k].position)),
                           2e-9);
        }
    }
}

static void test_spinning_upright_cylinder_keeps_its_points_in_place(void **state)
{
    (void)state;
    check_standing((placed_shape){.shape = {.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}}}, 0);
    check_standing(shape_of(PE_SHAPE_BOX, 0, 0, pe_v3(3, 2, 1)), 1);
    check_standing(cylinder(2, 1), 1);
}

static void test_tilted_cylinder_has_its_lowest_point(void **state)
{
    (void)state;
    for (double tilt = 1e-7; tilt < 0.7; tilt *= 3) {
        placed_shape b = cylinder(0.5, 0.4),
                     plane = {.shape = {.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}}};
        place(&b, pe_v3(0, 0, 1), about(pe_v3(0.6, 0.8, 0), tilt));
        pe_pair_manifold manifold;
        collide_convex(of(&plane), of(&b), 2, &manifold);
        pe_vec3 lowest = pe_v3(0, 0, 0);
        for (int i = 0; i < manifold.count; ++i) {
            bool is_lowest = manifold.item[i].separation == least_separation(&manifold);
            lowest = is_lowest ? manifold.item[i].position : lowest;
        }
        /* Down the slope of the cap: across the axis of the tilt. */
        assert_close(0.6 * lowest.x + 0.8 * lowest.y, 0, 1e-7, 0);
        assert_close(least_separation(&manifold), 1 - 0.4 * cos(tilt) - 0.5 * sin(tilt), 1e-14, 0);
    }
}

static void check_rolling(placed_shape ground, double top)
{
    pe_pair_manifold before = {0}, manifold;
    for (int i = 0; i < 1000; ++i) {
        placed_shape b = cylinder(0.5, 0.4);
        double angle = 1e-3 * i;
        pe_quat lying = about(pe_v3(1, 0, 0), 1.5707963267948966);
        place(&b, pe_v3(0.5 * angle, 0, top + 0.5),
              pe_quat_product(about(pe_v3(0, 1, 0), angle), lying));
        collide_convex(of(&ground), of(&b), 1e-2, &manifold);
        assert_int_equal(manifold.count, 2);
        assert_close(fabs(manifold.normal.z), 1, 1e-12, 0);
        for (int k = 0; k < 2; ++k) {
            assert_close(manifold.item[k].position.x, 0.5 * angle, 1e-9, 0);
            assert_close(fabs(manifold.item[k].position.y), 0.4, 1e-9, 0);
            assert_true(i == 0 || manifold.item[k].feature == before.item[k].feature);
        }
        before = manifold;
    }
}

static void test_rolling_cylinder_touches_at_ends_of_lowest_line(void **state)
{
    (void)state;
    check_rolling((placed_shape){.shape = {.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}}}, 0);
    check_rolling(shape_of(PE_SHAPE_BOX, 0, 0, pe_v3(3, 2, 1)), 1);
    check_rolling(cylinder(3, 1), 1);
}

/* Overlap of a cap with a face, whose corners all count. */
static void test_cap_wider_than_box_stands_on_corners(void **state)
{
    (void)state;
    placed_shape box = shape_of(PE_SHAPE_BOX, 0, 0, pe_v3(0.3, 0.2, 1)), b = cylinder(1, 0.5);
    place(&b, pe_v3(0, 0, 1.5), (pe_quat){.w = 1});
    pe_pair_manifold manifold;
    collide_convex(of(&box), of(&b), 1e-3, &manifold);
    assert_int_equal(manifold.count, 4);
    for (int i = 0; i < 4; ++i) {
        assert_close(fabs(manifold.item[i].position.x), 0.3, 1e-12, 0);
        assert_close(fabs(manifold.item[i].position.y), 0.2, 1e-12, 0);
    }
}

static void test_overhanging_cap_touches_where_rim_crosses_edge(void **state)
{
    (void)state;
    placed_shape box = shape_of(PE_SHAPE_BOX, 0, 0, pe_v3(1, 1, 1)), b = cylinder(0.5, 0.5);
    place(&b, pe_v3(1.1, 0, 1.5), (pe_quat){.w = 1});
    pe_pair_manifold manifold;
    collide_convex(of(&box), of(&b), 1e-3, &manifold);
    int crossings = 0;
    double across = sqrt(0.25 - 0.01);
    for (int i = 0; i < manifold.count; ++i) {
        pe_vec3 x = manifold.item[i].position;
        crossings += fabs(x.x - 1) < 1e-12 && fabs(fabs(x.y) - across) < 1e-12;
        assert_at_most(x.x, 1 + 1e-12);
    }
    assert_int_equal(crossings, 2);
}

/* The edge and the line on the side meet at their ends only. The other end of the edge is equally
 * near to the axis. */
static void test_edge_in_line_with_side_touches_at_end(void **state)
{
    (void)state;
    static const double hexagon[6][2] = {{1, 0},  {0.5, 0.4},   {-0.5, 0.4},
                                         {-1, 0}, {-0.5, -0.4}, {0.5, -0.4}};
    form prism = form_prism(hexagon, 6, -0.2, 0.2);
    placed_shape hull = hull_of_form(&prism);
    check_random random = {13};
    for (int i = 0; i < 1000; ++i) {
        placed_shape b = random_cylinder(&random, 0.1, 0.3);
        double side = i % 2 == 0 ? 1 : -1, offset = b.shape.radius * sqrt(0.5);
        pe_vec3 end = pe_v3(side * 0.5, 0.4, 0.2);
        pe_vec3 centre = pe_add(end, pe_v3(side * b.shape.half_height, offset, offset));
        place(&b, pe_add(centre, random_vector(&random, 4e-16)),
              about(pe_v3(0, 1, 0), 1.5707963267948966));
        pe_pair_manifold manifold;
        collide_convex(of(&hull), of(&b), 1e-2, &manifold);
        assert_true(manifold.count > 0);
        for (int k = 0; k < manifold.count; ++k) {
            assert_close(manifold.item[k].separation, 0, 1e-14, 0);
            assert_at_most(pe_length(pe_sub(manifold.item[k].position, end)), 1e-8);
        }
    }
    release_hull(&hull);
}

/* A point of the rim falls on a sharp corner of the face. */
static void test_cap_with_corner_on_rim_keeps_features(void **state)
{
    (void)state;
    static const double wedge[3][2] = {{0.6, 0}, {-0.3, 0.2}, {-0.3, -0.2}};
    form prism = form_prism(wedge, 3, -0.2, 0.2);
    placed_shape hull = hull_of_form(&prism);
    check_random random = {14};
    pe_vec3 across[2];
    pe_tangents(pe_unrotate(&hull.pose.rotation, pe_v3(0, 0, 1)), &across[0], &across[1]);
    for (int point = 0; point < 4; ++point) {
        pe_vec3 arm =
            pe_scale(point < 2 ? 0.5 : -0.5, pe_rotate(&hull.pose.rotation, across[point % 2]));
        if (arm.x < -0.4) {
            continue; /* the cap is next to the face */
        }
        pe_pair_manifold first = {0}, manifold;
        for (int i = 0; i < 300; ++i) {
            placed_shape b = cylinder(0.5, 0.4);
            pe_vec3 sway = i == 0 ? pe_v3(0, 0, 0) : random_vector(&random, 2e-10);
            place(&b, pe_add(pe_sub(pe_v3(0.6, 0, 0.6), arm), sway),
                  (pe_quat){1, 0.2 * sway.y, 0.2 * sway.z, 0});
            collide_convex(of(&hull), of(&b), 1e-2, &manifold);
            first = i == 0 ? manifold : first;
            assert_int_equal(manifold.count, first.count);
            for (int k = 0; k < manifold.count; ++k) {
                assert_true(has_feature(&first, manifold.item[k].feature));
            }
        }
    }
    release_hull(&hull);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spinning_upright_cylinder_keeps_its_points_in_place),
        cmocka_unit_test(test_tilted_cylinder_has_its_lowest_point),
        cmocka_unit_test(test_rolling_cylinder_touches_at_ends_of_lowest_line),
        cmocka_unit_test(test_cap_wider_than_box_stands_on_corners),
        cmocka_unit_test(test_overhanging_cap_touches_where_rim_crosses_edge),
        cmocka_unit_test(test_edge_in_line_with_side_touches_at_end),
        cmocka_unit_test(test_cap_with_corner_on_rim_keeps_features),
    };
    return cmocka_run_group_tests_name("engine_cylinder_points", tests, NULL, NULL);
}
