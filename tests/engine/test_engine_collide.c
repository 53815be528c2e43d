/* Narrow phase: contact points against truths that know no separating axes. */
#include "check.h"
#include "collide_convex.h"
#include "placed_shape.h"

/* Overlap of two boxes along the unit direction d, from a to b: negative when d separates them. */
static double overlap(const placed_shape *a, const placed_shape *b, pe_vec3 d)
{
    double sum = -pe_dot(d, pe_sub(b->pose.position, a->pose.position));
    for (int k = 0; k < 3; ++k) {
        sum +=
            fabs(pe_dot(d, pe_axis(&a->pose.rotation, k))) * pe_component(a->shape.half_extents, k);
        sum +=
            fabs(pe_dot(d, pe_axis(&b->pose.rotation, k))) * pe_component(b->shape.half_extents, k);
    }
    return sum;
}

/* The least overlap over all directions: a dense sweep, then a pattern search around its best. */
static double least_overlap(const placed_shape *a, const placed_shape *b)
{
    enum { SWEEP = 4000, STARTS = 6 };
    pe_vec3 start[STARTS];
    double value[STARTS];
    for (int i = 0; i < STARTS; ++i) {
        value[i] = HUGE_VAL;
    }
    for (int i = 0; i < SWEEP; ++i) {
        /* Fibonacci lattice on the sphere. */
        double z = 1 - (2 * i + 1.0) / SWEEP, angle = i * 2.399963229728653;
        double r = sqrt(1 - z * z);
        pe_vec3 d = pe_v3(r * cos(angle), r * sin(angle), z);
        double f = overlap(a, b, d);
        int j = STARTS - 1;
        if (f < value[j]) {
            for (; j > 0 && value[j - 1] > f; --j) {
                value[j] = value[j - 1];
                start[j] = start[j - 1];
            }
            value[j] = f;
            start[j] = d;
        }
    }
    double least = HUGE_VAL;
    for (int i = 0; i < STARTS; ++i) {
        pe_vec3 d = start[i];
        double f = value[i];
        for (double h = 0.05; h > 1e-10; h *= 0.5) {
            bool better = true;
            while (better) {
                better = false;
                pe_vec3 t1, t2;
                pe_tangents(d, &t1, &t2);
                for (int k = 0; k < 16; ++k) {
                    double c = cos(k * 0.39269908169872414), s = sin(k * 0.39269908169872414);
                    pe_vec3 e = pe_madd(pe_madd(d, h * c, t1), h * s, t2);
                    e = pe_scale(1 / pe_length(e), e);
                    if (overlap(a, b, e) < f - 1e-15) {
                        f = overlap(a, b, e);
                        d = e;
                        better = true;
                        break;
                    }
                }
            }
        }
        least = f < least ? f : least;
    }
    return least;
}

static void test_box_box_depth_equals_dense_direction_sweep(void **state)
{
    (void)state;
    check_random random = {42};
    int touching = 0;
    for (int i = 0; i < 400; ++i) {
        placed_shape a = random_box(&random, 0.8), b = random_box(&random, 0.8);
        pe_pair_manifold hits = {0};
        collide_convex(of(&a), of(&b), 0, &hits);
        /* The sweep is an upper bound of the least overlap, and near it. */
        double least = least_overlap(&a, &b);
        if (hits.count == 0) {
            assert_at_most(least, 1e-3);
            continue;
        }
        assert_true(least > 0);
        touching += 1;
        /* The normal is the direction of least overlap. */
        double tie = 1e-9 * pe_min(pe_shape_size(&a.shape, NULL), pe_shape_size(&b.shape, NULL));
        double depth = overlap(&a, &b, hits.normal);
        assert_at_most(depth, least + tie);
        assert_at_most(least, depth + 1e-2); /* the resolution of the sweep */
        double deepest = 0;
        for (int j = 0; j < hits.count; ++j) {
            deepest = pe_max(deepest, -hits.item[j].separation);
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

static void test_box_box_points_are_finite_unit_named_once_and_inside_within_depth(void **state)
{
    (void)state;
    check_random random = {7};
    for (int i = 0; i < 100000; ++i) {
        placed_shape a = random_box(&random, 0.8), b = random_box(&random, 0.8);
        pe_pair_manifold hits = {0};
        collide_convex(of(&a), of(&b), 0.01, &hits);
        for (int j = 0; j < hits.count; ++j) {
            const pe_pair_point *hit = &hits.item[j];
            assert_true(pe_is_finite(hit->position) && isfinite(hit->separation));
            double reach = 0.5 * fabs(hit->separation) + 1e-8;
            assert_at_most(outside(&a, hit->position), reach);
            assert_at_most(outside(&b, hit->position), reach);
            for (int k = 0; k < j; ++k) {
                assert_true(hit->feature != hits.item[k].feature);
            }
        }
        if (hits.count > 0) {
            assert_close(pe_length(hits.normal), 1, 1e-12, 0);
        }
        assert_true(hits.count <= PE_MAX_POINTS);
    }
}

static void test_box_box_is_symmetric_and_turns_with_the_world(void **state)
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
    pe_pair_manifold hits = {0};
    collide_convex(of(&a), of(&b), 1e-3, &hits);
    assert_int_equal(hits.count, 4);
    assert_close(hits.normal.z, 1, 0, 0);
    for (int i = 0; i < 4; ++i) {
        assert_close(hits.item[i].separation, 0, 0, 0);
        assert_close(fabs(hits.item[i].position.x), 0.5, 1e-6, 0);
        assert_close(fabs(hits.item[i].position.y), 0.5, 1e-6, 0);
        assert_close(hits.item[i].position.z, 1, 1e-15, 0);
    }
}

static void test_faces_turned_by_an_eighth_touch_at_eight_points(void **state)
{
    (void)state;
    placed_shape a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
    place(&a, pe_v3(0, 0, 0.5), (pe_quat){.w = 1});
    place(&b, pe_v3(0, 0, 1.5),
          (pe_quat){.w = cos(0.39269908169872414), .z = sin(0.39269908169872414)});
    pe_pair_manifold hits = {0};
    collide_convex(of(&a), of(&b), 1e-3, &hits);
    assert_int_equal(hits.count, 8);
    /* The octagon common to a square and the same turned by 45 degrees has inradius 1/2. */
    for (int i = 0; i < 8; ++i) {
        pe_vec3 x = hits.item[i].position;
        assert_close(sqrt(x.x * x.x + x.y * x.y), 0.5 / cos(0.39269908169872414), 1e-5, 0);
    }
}

static void test_features_keep_their_names_under_small_motion(void **state)
{
    (void)state;
    check_random random = {5};
    placed_shape a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
    place(&a, pe_v3(0, 0, 0.5), (pe_quat){.w = 1});
    for (int i = 0; i < 1000; ++i) {
        place(&b, pe_v3(0.1 + check_uniform(&random, -1e-4, 1e-4), 0.2, 1.5),
              (pe_quat){1, 1e-6 * check_uniform(&random, -1, 1),
                        1e-6 * check_uniform(&random, -1, 1), 0.01});
        pe_pair_manifold hits = {0};
        collide_convex(of(&a), of(&b), 1e-2, &hits);
        static uint64_t first[PE_MAX_POINTS];
        if (i == 0) {
            for (int j = 0; j < hits.count; ++j) {
                first[j] = hits.item[j].feature;
            }
        }
        assert_int_equal(hits.count, 4);
        for (int j = 0; j < hits.count; ++j) {
            bool known = false;
            for (int k = 0; k < 4; ++k) {
                known = known || first[k] == hits.item[j].feature;
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
        place(&ball, random_vector_in(&random, -1.5, 1.5), random_turn(&random));
        pe_pair_manifold hits = {0};
        collide_convex(of(&ball), of(&box), 100, &hits);
        assert_int_equal(hits.count, 1);

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
        assert_close(hits.item[0].separation, distance - 0.3, 1e-12, 0);
        /* Moving the ball along the normal, from ball to box, by the separation makes it touch. */
        placed_shape moved = ball;
        moved.pose.position = pe_madd(ball.pose.position, hits.item[0].separation, hits.normal);
        collide_convex(of(&moved), of(&box), 100, &hits);
        assert_close(hits.item[0].separation, 0, 1e-9, 0);
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
        pe_pair_manifold hits = {0}, swapped = {0};
        collide_convex(of(&plane), of(&box), 100, &hits);
        collide_convex(of(&box), of(&plane), 100, &swapped);
        assert_int_equal(hits.count, 8);
        double least = pe_dot(plane.shape.normal, box.pose.position) - plane.shape.offset;
        for (int k = 0; k < 3; ++k) {
            least -= fabs(pe_dot(plane.shape.normal, pe_axis(&box.pose.rotation, k))) *
                     pe_component(box.shape.half_extents, k);
        }
        assert_close(least_separation(&hits), least, 1e-12, 0);
        assert_close(pe_dot(hits.normal, swapped.normal), -1, 1e-12, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_box_depth_equals_dense_direction_sweep),
        cmocka_unit_test(test_box_box_points_are_finite_unit_named_once_and_inside_within_depth),
        cmocka_unit_test(test_box_box_is_symmetric_and_turns_with_the_world),
        cmocka_unit_test(test_stacked_cubes_touch_at_four_corners),
        cmocka_unit_test(test_faces_turned_by_an_eighth_touch_at_eight_points),
        cmocka_unit_test(test_features_keep_their_names_under_small_motion),
        cmocka_unit_test(test_sphere_against_box_equals_nearest_surface_point),
        cmocka_unit_test(test_plane_contacts_are_heights_over_it),
    };
    return cmocka_run_group_tests_name("engine_collide", tests, NULL, NULL);
}
