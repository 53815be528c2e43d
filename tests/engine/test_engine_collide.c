/* Narrow phase of boxes and spheres, against references that use no separating axes. */
#include "check.h"
#include "collide_convex.h"
#include "direction_sweep.h"

static void test_box_box_depth_equals_dense_direction_sweep(void **state)
{
    (void)state;
    check_random random = {42};
    int touching = 0;
    for (int i = 0; i < 400; ++i) {
        placed_shape a = random_box(&random, 0.8), b = random_box(&random, 0.8);
        pe_pair_manifold manifold = {0};
        collide_convex(of(&a), of(&b), 0, &manifold);
        /* The sweep is an upper bound of the least overlap, and near it. */
        double least = -swept_distance(&a, &b);
        if (manifold.count == 0) {
            assert_at_most(least, 1e-3);
            continue;
        }
        assert_true(least > 0);
        touching += 1;
        /* The normal is the direction of least overlap. */
        double tie = 1e-9 * pe_min(pe_shape_size(&a.shape, NULL), pe_shape_size(&b.shape, NULL));
        double depth = -separation_along(&a, &b, manifold.normal);
        assert_at_most(depth, least + tie);
        assert_at_most(least, depth + 1e-2); /* the resolution of the sweep */
        double deepest = 0;
        for (int j = 0; j < manifold.count; ++j) {
            deepest = pe_max(deepest, -manifold.item[j].separation);
        }
        assert_close(deepest, depth, tie, 0);
    }
    assert_true(touching > 150);
}

/* How far outside the box a point is; 0 inside. */
static double outside(const placed_shape *box, pe_vec3 x)
{
    pe_vec3 local = pe_unrotate(&box->pose.rotation, pe_sub(x, box->pose.position));
    double worst = 0;
    for (int k = 0; k < 3; ++k) {
        worst =
            pe_max(worst, fabs(pe_component(local, k)) - pe_component(box->shape.half_extents, k));
    }
    return worst;
}

static void test_box_box_points_are_finite_unique_and_inside(void **state)
{
    (void)state;
    check_random random = {7};
    for (int i = 0; i < 100000; ++i) {
        placed_shape a = random_box(&random, 0.8), b = random_box(&random, 0.8);
        pe_pair_manifold manifold = {0};
        collide_convex(of(&a), of(&b), 0.01, &manifold);
        for (int j = 0; j < manifold.count; ++j) {
            const pe_pair_point *point = &manifold.item[j];
            assert_true(pe_is_finite(point->position) && isfinite(point->separation));
            double reach = 0.5 * fabs(point->separation) + 1e-8;
            assert_at_most(outside(&a, point->position), reach);
            assert_at_most(outside(&b, point->position), reach);
            for (int k = 0; k < j; ++k) {
                assert_true(point->feature != manifold.item[k].feature);
            }
        }
        if (manifold.count > 0) {
            assert_close(pe_length(manifold.normal), 1, 1e-12, 0);
        }
        assert_true(manifold.count <= PE_MAX_POINTS);
    }
}

static void test_box_box_is_symmetric_and_rotates_with_world(void **state)
{
    (void)state;
    check_random random = {11};
    for (int i = 0; i < 20000; ++i) {
        placed_shape a = random_box(&random, 0.8), b = random_box(&random, 0.8);
        pe_pair_manifold one = {0}, swapped = {0}, turned = {0};
        collide_convex(of(&a), of(&b), 0, &one);
        collide_convex(of(&b), of(&a), 0, &swapped);
        assert_int_equal(one.count > 0, swapped.count > 0);

        pe_quat turn = random_turn(&random);
        pe_mat3 m = pe_matrix_of(pe_quat_unit(turn));
        placed_shape c = a, d = b;
        place(&c, pe_rotate(&m, a.pose.position), pe_quat_product(turn, a.pose.orientation));
        place(&d, pe_rotate(&m, b.pose.position), pe_quat_product(turn, b.pose.orientation));
        collide_convex(of(&c), of(&d), 0, &turned);
        assert_int_equal(one.count, turned.count);
        if (one.count > 0) {
            double size = pe_min(pe_shape_size(&a.shape, NULL), pe_shape_size(&b.shape, NULL));
            assert_close(least_separation(&one), least_separation(&swapped), 1e-9 * size, 0);
            pe_vec3 back = pe_unrotate(&m, turned.normal);
            assert_at_most(pe_length(pe_sub(back, one.normal)), 1e-9);
            assert_close(least_separation(&one), least_separation(&turned), 1e-9, 0);
        }
    }
}

static void test_stacked_cubes_touch_at_four_corners(void **state)
{
    (void)state;
    placed_shape a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
    place(&a, pe_v3(0, 0, 0.5), (pe_quat){.w = 1});
    place(&b, pe_v3(0, 0, 1.5), (pe_quat){.w = 1});
    pe_pair_manifold manifold = {0};
    collide_convex(of(&a), of(&b), 1e-3, &manifold);
    assert_int_equal(manifold.count, 4);
    assert_close(manifold.normal.z, 1, 0, 0);
    for (int i = 0; i < 4; ++i) {
        assert_close(manifold.item[i].separation, 0, 0, 0);
        assert_close(fabs(manifold.item[i].position.x), 0.5, 1e-6, 0);
        assert_close(fabs(manifold.item[i].position.y), 0.5, 1e-6, 0);
        assert_close(manifold.item[i].position.z, 1, 1e-15, 0);
    }
}

static void test_faces_turned_by_45_degrees_have_eight_points(void **state)
{
    (void)state;
    placed_shape a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
    place(&a, pe_v3(0, 0, 0.5), (pe_quat){.w = 1});
    place(&b, pe_v3(0, 0, 1.5),
          (pe_quat){.w = cos(0.39269908169872414), .z = sin(0.39269908169872414)});
    pe_pair_manifold manifold = {0};
    collide_convex(of(&a), of(&b), 1e-3, &manifold);
    assert_int_equal(manifold.count, 8);
    /* The octagon common to a square and the same turned by 45 degrees has inradius 1/2. */
    for (int i = 0; i < 8; ++i) {
        pe_vec3 x = manifold.item[i].position;
        assert_close(sqrt(x.x * x.x + x.y * x.y), 0.5 / cos(0.39269908169872414), 1e-5, 0);
    }
}

static void test_feature_ids_stay_under_small_motion(void **state)
{
    (void)state;
    check_random random = {5};
    placed_shape a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
    place(&a, pe_v3(0, 0, 0.5), (pe_quat){.w = 1});
    for (int i = 0; i < 1000; ++i) {
        pe_quat turn = {1, 0, 0, 0.01};
        turn.x = 1e-6 * check_uniform(&random, -1, 1);
        turn.y = 1e-6 * check_uniform(&random, -1, 1);
        place(&b, pe_v3(0.1 + check_uniform(&random, -1e-4, 1e-4), 0.2, 1.5), turn);
        pe_pair_manifold manifold = {0};
        collide_convex(of(&a), of(&b), 1e-2, &manifold);
        static uint64_t first[PE_MAX_POINTS];
        if (i == 0) {
            for (int j = 0; j < manifold.count; ++j) {
                first[j] = manifold.item[j].feature;
            }
        }
        assert_int_equal(manifold.count, 4);
        for (int j = 0; j < manifold.count; ++j) {
            bool known = false;
            for (int k = 0; k < 4; ++k) {
                known = known || first[k] == manifold.item[j].feature;
            }
            assert_true(known);
        }
    }
}

static void test_sphere_against_box_equals_nearest_surface_point(void **state)
{
    (void)state;
    check_random random = {3};
    int inside = 0;
    for (int i = 0; i < 2000; ++i) {
        placed_shape box = random_box(&random, 0.5);
        placed_shape ball = {.shape = {.kind = PE_SHAPE_SPHERE, .radius = 0.3}};
        pe_quat turn = random_turn(&random);
        place(&ball, random_vector_in(&random, -1.5, 1.5), turn);
        pe_pair_manifold manifold = {0};
        collide_convex(of(&ball), of(&box), 100, &manifold);
        assert_int_equal(manifold.count, 1);

        /* The signed distance of the centre, face by face. */
        pe_vec3 local =
            pe_unrotate(&box.pose.rotation, pe_sub(ball.pose.position, box.pose.position));
        pe_vec3 e = box.shape.half_extents;
        double q[3] = {fabs(local.x) - e.x, fabs(local.y) - e.y, fabs(local.z) - e.z};
        double out = 0, in = -HUGE_VAL;
        for (int k = 0; k < 3; ++k) {
            out += q[k] > 0 ? q[k] * q[k] : 0;
            in = pe_max(in, q[k]);
        }
        double distance = out > 0 ? sqrt(out) : in;
        inside += out == 0;
        assert_close(manifold.item[0].separation, distance - 0.3, 1e-12, 0);
        /* Moving the ball along the normal, from ball to box, by the separation makes it touch. */
        placed_shape moved = ball;
        moved.pose.position =
            pe_madd(ball.pose.position, manifold.item[0].separation, manifold.normal);
        collide_convex(of(&moved), of(&box), 100, &manifold);
        assert_close(manifold.item[0].separation, 0, 1e-9, 0);
    }
    assert_true(inside > 50);
}

static void test_plane_contacts_are_heights_over_it(void **state)
{
    (void)state;
    check_random random = {9};
    for (int i = 0; i < 2000; ++i) {
        pe_vec3 n = random_vector_in(&random, -1, 1);
        placed_shape plane = {.shape = {.kind = PE_SHAPE_PLANE,
                                        .normal = pe_scale(1 / pe_length(n), n),
                                        .offset = check_uniform(&random, -1, 1)}};
        placed_shape box = random_box(&random, 1);
        pe_pair_manifold manifold = {0}, swapped = {0};
        collide_convex(of(&plane), of(&box), 100, &manifold);
        collide_convex(of(&box), of(&plane), 100, &swapped);
        assert_int_equal(manifold.count, 8);
        double least = pe_dot(plane.shape.normal, box.pose.position) - plane.shape.offset;
        for (int k = 0; k < 3; ++k) {
            least -= fabs(pe_dot(plane.shape.normal, pe_axis(&box.pose.rotation, k))) *
                     pe_component(box.shape.half_extents, k);
        }
        assert_close(least_separation(&manifold), least, 1e-12, 0);
        assert_close(pe_dot(manifold.normal, swapped.normal), -1, 1e-12, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_box_depth_equals_dense_direction_sweep),
        cmocka_unit_test(test_box_box_points_are_finite_unique_and_inside),
        cmocka_unit_test(test_box_box_is_symmetric_and_rotates_with_world),
        cmocka_unit_test(test_stacked_cubes_touch_at_four_corners),
        cmocka_unit_test(test_faces_turned_by_45_degrees_have_eight_points),
        cmocka_unit_test(test_feature_ids_stay_under_small_motion),
        cmocka_unit_test(test_sphere_against_box_equals_nearest_surface_point),
        cmocka_unit_test(test_plane_contacts_are_heights_over_it),
    };
    return cmocka_run_group_tests_name("engine_collide", tests, NULL, NULL);
}
