/* Which points of many are kept. */
#include "check.h"
#include "collide_convex.h"
#include "contact/contact_points.h"
#include "placed_shape.h"

/* Twice the projected area of a quadrilateral of points: the largest over its three orders. */
static double quad_area(const pe_pair_manifold *manifold, const int q[4])
{
    double most = 0;
    static const int orders[3][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 1, 3, 2}};
    for (int o = 0; o < 3; ++o) {
        double area = 0;
        for (int k = 0; k < 4; ++k) {
            pe_vec3 x = manifold->item[q[orders[o][k]]].position;
            pe_vec3 y = manifold->item[q[orders[o][(k + 1) % 4]]].position;
            area += pe_dot(manifold->normal, pe_cross(x, y));
        }
        most = pe_max(most, fabs(area));
    }
    return most;
}

/* Faces that overlap in five to eight corners, tilted a little. */
static void many_points(check_random *random, pe_pair_manifold *manifold)
{
    do {
        placed_shape a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
        b.shape.half_extents = random_vector_in(random, 0.4, 0.6);
        place(&a, pe_v3(0, 0, 0), (pe_quat){.w = 1});
        double angle = check_uniform(random, 0.1, 0.7);
        pe_vec3 tilt = random_vector_in(random, -1e-3, 1e-3);
        place(&b, pe_v3(tilt.x, tilt.y, 0.5 + b.shape.half_extents.z),
              (pe_quat){cos(angle), tilt.x, tilt.y, sin(angle)});
        collide_convex(of(&a), of(&b), 0.1, manifold);
    } while (manifold->count < 5);
}

static void test_reduction_keeps_the_deepest_point_and_area(void **state)
{
    (void)state;
    check_random random = {37};
    for (int i = 0; i < 2000; ++i) {
        pe_pair_manifold manifold;
        many_points(&random, &manifold);
        pe_pair_manifold all = manifold;
        pe_pair_manifold_reduce(&manifold, 0.4);
        assert_int_equal(manifold.count, 4);
        assert_close(least_separation(&manifold), least_separation(&all), 1e-5 * 0.4, 0);
        static const int every[4] = {0, 1, 2, 3};
        double best = 0;
        for (unsigned set = 0; set < 1u << all.count; ++set) {
            int q[PE_MAX_POINTS], n = 0;
            for (int j = 0; j < all.count; ++j) {
                q[n] = j;
                n += (int)(set >> j & 1);
            }
            best = n == 4 ? pe_max(best, quad_area(&all, q)) : best;
        }
        assert_at_most(0.7 * best, quad_area(&manifold, every));
        for (int j = 0; j < 4; ++j) {
            assert_true(has_point_at(&all, &manifold.item[j], 0));
            assert_true(j == 0 || manifold.item[j - 1].feature < manifold.item[j].feature);
        }
    }
}

static void test_reduction_is_stable_under_resting_motion(void **state)
{
    (void)state;
    /* Regular polygons: depths tie, and in those of odd number the farthest points too. */
    check_random random = {41};
    for (int corners = 5; corners <= PE_MAX_POINTS; ++corners) {
        pe_pair_manifold first = {0};
        for (int i = 0; i < 500; ++i) {
            pe_pair_manifold manifold = {.normal = {0, 0, 1}, .count = corners};
            for (int j = 0; j < corners; ++j) {
                /* Found from another corner on each time. */
                int k = (i + j) % corners;
                double angle = 2 * 3.141592653589793 * k / corners;
                pe_vec3 corner = pe_v3(0.5 * cos(angle), 0.5 * sin(angle), 0);
                pe_pair_point *point = &manifold.item[j];
                *point = (pe_pair_point){.feature = (uint64_t)(7 * k % 11)};
                point->position = pe_add(corner, random_vector_in(&random, -1e-8, 1e-8));
                point->separation = check_uniform(&random, -1e-8, 1e-8);
            }
            pe_pair_manifold_reduce(&manifold, 0.5);
            assert_int_equal(manifold.count, 4);
            first = i == 0 ? manifold : first;
            for (int j = 0; j < 4; ++j) {
                assert_int_equal(manifold.item[j].feature, first.item[j].feature);
            }
        }
    }
}

static void test_reducing_points_on_one_line_keeps_the_ends(void **state)
{
    (void)state;
    pe_pair_manifold manifold = {.normal = {0, 0, 1}, .count = 6};
    static const double at[6] = {0.3, -1, 0, 1, 0.5, -0.2};
    for (uint32_t i = 0; i < 6; ++i) {
        manifold.item[i] = (pe_pair_point){
            .position = {at[i], 0, 0}, .separation = i == 3 ? -1e-3 : 0, .feature = 6 - i};
    }
    pe_pair_manifold_reduce(&manifold, 1);
    assert_int_equal(manifold.count, 2);
    assert_close(manifold.item[0].position.x, 1, 0, 0);
    assert_close(manifold.item[1].position.x, -1, 0, 0);
}

/* The eight corners of a cube over a plane, as a fast cube has them within its margin. */
static void test_reduction_prefers_corners_that_touch(void **state)
{
    (void)state;
    pe_pair_manifold manifold = {.normal = {0, 0, 1}, .count = 8};
    for (uint32_t i = 0; i < 8; ++i) {
        const pe_vec3 corner = pe_v3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 2 : 0);
        manifold.item[i] =
            (pe_pair_point){.position = corner, .separation = corner.z, .feature = 8 - i};
    }
    pe_pair_manifold_reduce(&manifold, 1);
    assert_int_equal(manifold.count, 4);
    for (int i = 0; i < 4; ++i) {
        assert_close(manifold.item[i].separation, 0, 0, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reduction_keeps_the_deepest_point_and_area),
        cmocka_unit_test(test_reduction_is_stable_under_resting_motion),
        cmocka_unit_test(test_reducing_points_on_one_line_keeps_the_ends),
        cmocka_unit_test(test_reduction_prefers_corners_that_touch),
    };
    return cmocka_run_group_tests_name("engine_contact_reduce", tests, NULL, NULL);
}
