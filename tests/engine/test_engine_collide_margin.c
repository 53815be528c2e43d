/* Narrow phase of boxes: rejection by the margin, order of the shapes, and ranges of margins. */
#include "check.h"
#include "collide_convex.h"
#include "placed_shape.h"

/* The largest separation of two boxes over the 15 axes, from their corners. *second is the largest
 * over the axes that are not nearly parallel to the best one. */
static double separation_by_corners(const placed_shape *a, const placed_shape *b, double *second)
{
    pe_vec3 axis[15];
    double value[15];
    int count = 0, best = 0;
    for (int i = 0; i < 3; ++i) {
        axis[count++] = pe_axis(&a->pose.rotation, i);
        axis[count++] = pe_axis(&b->pose.rotation, i);
        for (int j = 0; j < 3; ++j) {
            pe_vec3 n = pe_cross(pe_axis(&a->pose.rotation, i), pe_axis(&b->pose.rotation, j));
            if (pe_length(n) > 1e-3) {
                axis[count++] = pe_scale(1 / pe_length(n), n);
            }
        }
    }
    for (int i = 0; i < count; ++i) {
        double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        for (int k = 0; k < 16; ++k) {
            const placed_shape *box = k < 8 ? a : b;
            pe_vec3 e = box->shape.half_extents;
            pe_vec3 c = pe_v3(k & 1 ? e.x : -e.x, k & 2 ? e.y : -e.y, k & 4 ? e.z : -e.z);
            double x =
                pe_dot(axis[i], pe_add(box->pose.position, pe_rotate(&box->pose.rotation, c)));
            low[k / 8] = pe_min(low[k / 8], x);
            high[k / 8] = pe_max(high[k / 8], x);
        }
        value[i] = pe_max(low[0] - high[1], low[1] - high[0]);
        best = value[i] > value[best] ? i : best;
    }
    *second = -HUGE_VAL;
    for (int i = 0; i < count; ++i) {
        if (fabs(pe_dot(axis[i], axis[best])) < 0.99) {
            *second = pe_max(*second, value[i]);
        }
    }
    return value[best];
}

/* Two boxes at random, or nearly aligned like bricks. */
static void random_pair(check_random *random, bool aligned, placed_shape *a, placed_shape *b)
{
    *a = random_box(random, 1.2);
    *b = random_box(random, 1.2);
    if (aligned) {
        pe_quat q = a->pose.orientation;
        pe_vec3 d = random_vector_in(random, -0.02, 0.02);
        place(b, b->pose.position,
              pe_quat_product((pe_quat){1, 0.5 * d.x, 0.5 * d.y, 0.5 * d.z}, q));
    }
}

static void test_pair_is_rejected_exactly_beyond_the_margin(void **state)
{
    (void)state;
    check_random random = {17};
    int apart = 0, near = 0;
    for (int i = 0; i < 40000; ++i) {
        placed_shape a, b;
        random_pair(&random, i % 2 == 0, &a, &b);
        double second, margin = i % 3 == 0 ? 0 : check_uniform(&random, 0, 0.3);
        double truth = separation_by_corners(&a, &b, &second);
        pe_pair_manifold manifold = {0};
        collide_convex(of(&a), of(&b), margin, &manifold);
        if (truth > margin + 1e-12) {
            assert_int_equal(manifold.count, 0);
            apart += 1;
        } else if (truth < margin - 1e-12 && truth < 0) {
            /* The gap may be between a face and a side of the other box: no point faces it. */
            assert_true(manifold.count > 0);
            near += 1;
        }
    }
    assert_true(apart > 5000);
    assert_true(near > 5000);
}

static void test_swapping_the_shapes_mirrors_the_points(void **state)
{
    (void)state;
    check_random random = {23};
    int compared = 0;
    for (int i = 0; i < 20000; ++i) {
        placed_shape a, b;
        random_pair(&random, i % 2 == 0, &a, &b);
        if (i % 5 == 0) {
            b.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0.5};
        }
        double size = pe_min(pe_shape_size(&a.shape, NULL), pe_shape_size(&b.shape, NULL)),
               second = -HUGE_VAL;
        double best = i % 5 == 0 ? 0 : separation_by_corners(&a, &b, &second);
        pe_pair_manifold one = {0}, two = {0};
        collide_convex(of(&a), of(&b), 0.05, &one);
        collide_convex(of(&b), of(&a), 0.05, &two);
        assert_int_equal(one.count > 0, two.count > 0);
        double same = pe_dot(one.normal, two.normal);
        /* The bias decides between axes that nearly tie, and the order between nearly parallel
         * faces. */
        if (one.count == 0 || best - second < 2e-5 * size || same > -1 + 1e-12) {
            assert_true(one.count == 0 || best - second < 2e-5 * size || same < -0.98);
            continue;
        }
        compared += 1;
        assert_int_equal(one.count, two.count);
        assert_close(one.least_margin, two.least_margin, 1e-12, 0);
        if (one.end_margin < HUGE_VAL || two.end_margin < HUGE_VAL) {
            assert_close(one.end_margin, two.end_margin, 1e-9, 0);
        }
        for (int j = 0; j < one.count; ++j) {
            assert_true(has_point_at(&two, &one.item[j], 1e-9));
        }
    }
    assert_true(compared > 3000);
}

static void test_points_are_same_exactly_over_margin_range(void **state)
{
    (void)state;
    check_random random = {29};
    int ended = 0, begun = 0;
    for (int i = 0; i < 20000; ++i) {
        placed_shape a, b;
        random_pair(&random, i % 2 == 0, &a, &b);
        if (i % 4 == 0) {
            a.shape = (pe_shape){
                .kind = PE_SHAPE_PLANE, .normal = {0, 0.6, 0.8}, .offset = a.pose.position.x};
        } else if (i % 4 == 1) {
            a.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0.4};
        }
        pe_pair_manifold manifold, other;
        collide_convex(of(&a), of(&b), check_uniform(&random, 0, 0.3), &manifold);
        if (manifold.count == 0) {
            continue;
        }
        assert_true(manifold.least_margin < manifold.end_margin);
        double low = manifold.least_margin, end = pe_min(manifold.end_margin, 10);
        for (int k = 0; k < 4; ++k) {
            double margin = k == 0 ? low : low + check_uniform(&random, 0, 1) * (end - low);
            if (margin < end) {
                collide_convex(of(&a), of(&b), margin, &other);
                assert_int_equal(other.count, manifold.count);
                for (int j = 0; j < manifold.count; ++j) {
                    assert_memory_equal(&other.item[j].position, &manifold.item[j].position,
                                        sizeof manifold.item[j].position);
                    assert_int_equal(other.item[j].feature, manifold.item[j].feature);
                }
            }
        }
        collide_convex(of(&a), of(&b), nextafter(low, -HUGE_VAL), &other);
        assert_true(other.count < manifold.count);
        begun += 1;
        if (manifold.end_margin < HUGE_VAL) {
            collide_convex(of(&a), of(&b), manifold.end_margin, &other);
            assert_true(other.count > manifold.count);
            ended += 1;
        }
    }
    assert_true(begun > 5000);
    assert_true(ended > 500);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pair_is_rejected_exactly_beyond_the_margin),
        cmocka_unit_test(test_swapping_the_shapes_mirrors_the_points),
        cmocka_unit_test(test_points_are_same_exactly_over_margin_range),
    };
    return cmocka_run_group_tests_name("engine_collide_margin", tests, NULL, NULL);
}
