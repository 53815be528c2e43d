/* Spheres, capsules, boxes and hulls against each other: separation, normal and points against
 * brute force. */
#include "check.h"
#include "collide_convex.h"
#include "polytope_truth.h"
#include "polytopes.h"

static double size_of(const placed_shape *a, const placed_shape *b)
{
    return pe_min(of(a).size, of(b).size);
}

/* Parallel edges that meet have one normal, though they may be 1e-4 of the size apart or aside. */
static bool is_line_end(const pe_pair_point *point)
{
    return point->feature >> 61 == 1;
}

static void check_points(const polytope_core *a, const polytope_core *b,
                         const pe_pair_manifold *manifold, double size)
{
    assert_in_range(manifold->count, 1, PE_MAX_POINTS);
    assert_close(pe_length(manifold->normal), 1, 1e-12, 0);
    for (int i = 0; i < manifold->count; ++i) {
        const pe_pair_point *point = &manifold->item[i];
        assert_true(pe_is_finite(point->position) && isfinite(point->separation));
        pe_vec3 on_a = pe_madd(point->position, -0.5 * point->separation, manifold->normal);
        pe_vec3 on_b = pe_madd(point->position, 0.5 * point->separation, manifold->normal);
        /* Sideways, nearest points far apart are only known to the root of rounding. */
        double sideways = 2e-8 * size + 2e-8 * pe_max(0, point->separation);
        sideways += is_line_end(point) ? 1e-4 * size : 0;
        assert_at_most(core_outside(a, on_a), sideways);
        assert_at_most(core_outside(b, on_b), sideways);
        for (int k = 0; k < i; ++k) {
            assert_true(point->feature != manifold->item[k].feature);
        }
    }
}

/* Checks all that must hold of a pair at every pose. Returns the separation. */
static double check_pair(const placed_shape *x, const placed_shape *y)
{
    static polytope_core a, b; /* large */
    polytope_core_of(x, &a);
    polytope_core_of(y, &b);
    double size = size_of(x, y), truth = core_gap(&a, &b);
    /* Rounding leaves a length uncertain by eps and the direction of the nearest points by its
     * root: many sizes apart, the distance sets the scale. */
    double within = 1e-9 * size + 2e-12 * pe_max(1, truth);
    double turned = within + 1e-8 * pe_max(0, truth);
    pe_pair_manifold manifold, swapped, none;
    collide_convex(of(x), of(y), 100, &manifold);
    check_points(&a, &b, &manifold, size);
    if (fabs(truth) < 1e-4 * size && is_line_end(&manifold.item[0])) {
        within = turned = 1e-4 * size;
    }
    assert_close(least_separation(&manifold), truth, within, 0);
    assert_close(core_gap_along(&a, &b, manifold.normal), truth, turned, 0);
    collide_convex(of(y), of(x), 100, &swapped);
    check_points(&b, &a, &swapped, size);
    assert_close(least_separation(&swapped), truth, within, 0);
    /* No point lies beyond the margin, and some within it. */
    collide_convex(of(x), of(y), truth - 2 * turned, &none);
    assert_int_equal(none.count, 0);
    collide_convex(of(x), of(y), truth + 2 * within, &none);
    check_points(&a, &b, &none, size);
    return truth;
}

static void test_separation_along_normal_equals_brute_force(void **state)
{
    (void)state;
    check_random random = {101};
    for (int i = 0; i < SOLID_KINDS; ++i) {
        for (int j = i; j < SOLID_KINDS; ++j) {
            int apart = 0, deep = 0;
            for (int pose = 0; pose < 200; ++pose) {
                placed_shape a = random_solid(&random, i), b = random_solid(&random, j);
                place_at_random(&a, &random);
                place_at_random(&b, &random);
                double gap = check_pair(&a, &b);
                /* Also where they just touch, overlap a little, and are a little apart. */
                pe_pair_manifold manifold;
                collide_convex(of(&a), of(&b), 100, &manifold);
                for (int k = 0; k < 3; ++k) {
                    double shift = gap + (k == 0 ? 0 : k == 1 ? 1e-3 : -1e-3) * size_of(&a, &b);
                    placed_shape moved = b;
                    moved.pose.position = pe_madd(b.pose.position, -shift, manifold.normal);
                    check_pair(&a, &moved);
                }
                apart += gap > 0;
                deep += gap < -0.1;
                release_hull(&a);
                release_hull(&b);
            }
            assert_true(apart > 10);
            assert_true(deep > 10);
        }
    }
}

static void test_hull_of_a_box_separates_like_the_box(void **state)
{
    (void)state;
    check_random random = {103};
    for (int i = 0; i < 500; ++i) {
        pe_vec3 e = random_vector_in(&random, 0.1, 1);
        placed_shape a = box_of(e.x, e.y, e.z), hull = hull_box(e.x, e.y, e.z);
        placed_shape b = random_solid(&random, i % SOLID_KINDS);
        place_at_random(&a, &random);
        place_at_random(&b, &random);
        place(&hull, a.pose.position,
              pe_quat_product(a.pose.orientation, hull.geometry->frame.orientation));
        pe_pair_manifold one, two;
        collide_convex(of(&a), of(&b), 100, &one);
        collide_convex(of(&hull), of(&b), 100, &two);
        assert_close(least_separation(&one), least_separation(&two), 1e-9 * size_of(&a, &b), 0);
        release_hull(&b);
        release_hull(&hull);
    }
}

/* Faces in one plane, edges in line, corners on corners, centres on centres; exactly, and turned by
 * as little as rounding. */
static void test_degenerate_poses_keep_every_law(void **state)
{
    (void)state;
    check_random random = {107};
    const double turns[] = {0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3};
    const pe_vec3 offsets[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}, {1, 1, 1}, {0.5, 0, 1}, {0, 0, 3}};
    placed_shape shapes[] = {box_of(0.5, 0.5, 0.5),          hull_box(0.5, 0.5, 0.5),
                             hull_prism(6, 0.5, 0.5, 0),     capsule_of(0.3, 0.5),
                             box_of(0.5, 1e-3, 0.5),         box_of(5e-4, 5e-4, 0.5),
                             hull_prism(3, 5e-3, 2.5, 1e-3), capsule_of(1e-3, 0.5)};
    const int count = (int)(sizeof shapes / sizeof *shapes);
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
            for (int t = 0; t < 7; ++t) {
                for (int k = 0; k < 6; ++k) {
                    placed_shape a = shapes[i], b = shapes[j];
                    pe_vec3 d = random_vector_in(&random, -turns[t], turns[t]);
                    place(&a, pe_v3(0, 0, 0), unturned);
                    place(&b, offsets[k], (pe_quat){1, d.x, d.y, d.z});
                    check_pair(&a, &b);
                }
            }
        }
    }
    for (int i = 0; i < count; ++i) {
        release_hull(&shapes[i]);
    }
}

static void test_results_do_not_depend_on_size_or_position(void **state)
{
    (void)state;
    check_random random = {109};
    for (int i = 0; i < 300; ++i) {
        for (double scale = 1e-3; scale < 2e3; scale *= 1e6) {
            pe_vec3 e = random_vector_in(&random, 0.1, 1), c = pe_scale(scale, e);
            placed_shape a = box_of(c.x, c.y, c.z),
                         b = hull_prism(5, 0.7 * scale, 0.4 * scale, 0.1 * scale);
            placed_shape one = box_of(e.x, e.y, e.z), two = hull_prism(5, 0.7, 0.4, 0.1);
            pe_vec3 x = random_vector_in(&random, -1, 1);
            pe_quat q = random_turn(&random), r = random_turn(&random);
            place(&one, pe_v3(0, 0, 0), q);
            place(&two, x, r);
            place(&a, pe_v3(0, 0, 0), q);
            place(&b, pe_scale(scale, x), r);
            pe_pair_manifold here, large, there;
            collide_convex(of(&one), of(&two), 100, &here);
            collide_convex(of(&a), of(&b), 100 * scale, &large);
            assert_int_equal(here.count, large.count);
            assert_close(least_separation(&large), scale * least_separation(&here), 1e-9 * scale,
                         0);
            one.pose.position = pe_v3(1e4, -1e4, 1e4);
            two.pose.position = pe_add(x, one.pose.position);
            collide_convex(of(&one), of(&two), 100, &there);
            assert_close(least_separation(&there), least_separation(&here), 1e-11, 0);
            release_hull(&b);
            release_hull(&two);
        }
    }
}

static void test_stacked_hulls_keep_their_points_while_they_sway(void **state)
{
    (void)state;
    check_random random = {113};
    const int sides[] = {3, 4, 8, 64, 75};
    for (int n = 0; n < 5; ++n) {
        placed_shape a = hull_prism(sides[n], 0.5, 0.5, 0), b = hull_prism(sides[n], 0.5, 0.5, 0);
        place(&a, pe_v3(0, 0, 0), unturned);
        pe_pair_manifold first, now;
        pe_vec3 up = pe_v3(0, 0, 0);
        for (int i = 0; i < a.geometry->face_count; ++i) {
            bool cap = fabs(2 * a.geometry->faces[i].offset - 1) < 1e-9;
            up = cap ? a.geometry->faces[i].normal : up;
        }
        assert_close(pe_length(up), 1, 1e-12, 0);
        place(&b, up, unturned);
        collide_convex(of(&a), of(&b), 1e-3, &first);
        assert_int_equal(first.count, sides[n] < 8 ? sides[n] : 8);
        for (int i = 0; i < 200; ++i) {
            pe_vec3 d = random_vector_in(&random, -1e-9, 1e-9),
                    v = random_vector_in(&random, -1e-9, 1e-9);
            place(&b, pe_add(up, d), (pe_quat){1, v.x, v.y, v.z});
            collide_convex(of(&a), of(&b), 1e-3, &now);
            assert_int_equal(now.count, first.count);
            int known = 0;
            for (int j = 0; j < now.count; ++j) {
                for (int k = 0; k < first.count; ++k) {
                    known += now.item[j].feature == first.item[k].feature;
                }
            }
            /* Of many corners of equal depth, the deepest one may replace the last. */
            assert_true(known >= (sides[n] > 8 ? first.count - 1 : first.count));
        }
        release_hull(&a);
        release_hull(&b);
    }
}

static void test_capsules_lie_on_two_points(void **state)
{
    (void)state;
    placed_shape long_one = capsule_of(0.1, 1), short_one = capsule_of(0.2, 0.5),
                 box = box_of(2, 2, 0.5);
    pe_pair_manifold manifold;
    place(&long_one, pe_v3(0, 0, 0), unturned);
    place(&short_one, pe_v3(0.3, 0, 0.8), unturned);
    collide_convex(of(&long_one), of(&short_one), 1e-3, &manifold);
    assert_int_equal(manifold.count, 2);
    for (int i = 0; i < 2; ++i) { /* the common part: z from 0.3 to 1 */
        assert_close(manifold.item[i].separation, 0, 1e-15, 0);
        assert_close(manifold.item[i].position.x, 0.1, 1e-15, 0);
        assert_close(manifold.item[i].position.z, i == 0 ? 0.3 : 1, 1e-15, 0);
    }
    /* Over the edge of a box, which supports the part on it. */
    place(&box, pe_v3(0, 0, -0.5), unturned);
    place(&long_one, pe_v3(1.5, 0, 0.1), (pe_quat){.w = 1, .y = 1});
    collide_convex(of(&box), of(&long_one), 1e-3, &manifold);
    assert_int_equal(manifold.count, 2);
    assert_close(manifold.normal.z, 1, 1e-15, 0);
    assert_close(pe_min(manifold.item[0].position.x, manifold.item[1].position.x), 0.5, 1e-12, 0);
    assert_close(pe_max(manifold.item[0].position.x, manifold.item[1].position.x), 2, 1e-12, 0);
}

static void test_cores_that_meet_are_parted_across(void **state)
{
    (void)state;
    placed_shape a = capsule_of(0.1, 1), b = capsule_of(0.2, 1),
                 ball = {.shape = {.kind = PE_SHAPE_SPHERE}};
    ball.shape.radius = 0.2;
    const pe_quat turns[] = {{1, 0, 0, 0}, {1, 1, 0, 0}, {1, 1e-3, 0, 0}, {1, 1e-13, 0, 0}};
    for (int t = 0; t < 4; ++t) {
        place(&a, pe_v3(0, 0, 0), unturned);
        place(&b, pe_v3(0, 0, 0.1 * t), turns[t]);
        place(&ball, pe_v3(0, 0, 0.1 * t), unturned);
        pe_pair_manifold manifold;
        collide_convex(of(&a), of(&b), 0, &manifold);
        assert_close(least_separation(&manifold), -0.3, 1e-12, 0);
        assert_close(manifold.normal.z, 0, 1e-12, 0);
        collide_convex(of(&ball), of(&a), 0, &manifold);
        assert_close(least_separation(&manifold), -0.3, 1e-12, 0);
        assert_close(manifold.normal.z, 0, 1e-12, 0);
    }
}

static void test_plane_separations_are_heights_of_the_vertices(void **state)
{
    (void)state;
    check_random random = {127};
    for (int i = 0; i < 1000; ++i) {
        pe_vec3 n = random_vector_in(&random, -1, 1);
        placed_shape plane = {.shape = {.kind = PE_SHAPE_PLANE,
                                        .normal = pe_scale(1 / pe_length(n), n),
                                        .offset = check_uniform(&random, -1, 1)}};
        placed_shape b =
            i % 5 == 0 ? hull_prism(75, 1, 0.1, 0.2) : random_solid(&random, i % SOLID_KINDS);
        place_at_random(&b, &random);
        if (i % 4 == 1) { /* standing, with many corners at nearly the same depth */
            release_hull(&b);
            b = hull_prism(64, 1, 0.1, 0);
            plane.shape.normal = pe_v3(0, 0, 1);
            pe_vec3 d = random_vector_in(&random, -4e-7, 4e-7);
            pe_quat tilt = {1, d.x, d.y, d.z};
            place(&b, b.pose.position, pe_quat_product(tilt, b.geometry->frame.orientation));
        }
        static polytope_core c;
        polytope_core_of(&b, &c);
        double truth =
            -core_farthest(&c, pe_scale(-1, plane.shape.normal)) - plane.shape.offset - c.radius;
        pe_pair_manifold manifold;
        collide_convex(of(&plane), of(&b), 100, &manifold);
        assert_in_range(manifold.count, 1, PE_MAX_POINTS);
        assert_close(least_separation(&manifold), truth, 1e-9 * of(&b).size, 0);
        for (int j = 0; j < manifold.count; ++j) {
            const pe_pair_point *point = &manifold.item[j];
            pe_vec3 on_b = pe_madd(point->position, 0.5 * point->separation, manifold.normal);
            assert_at_most(core_outside(&c, on_b), 1e-12);
            assert_close(pe_dot(plane.shape.normal, on_b) - plane.shape.offset, point->separation,
                         1e-12, 0);
        }
        collide_convex(of(&plane), of(&b), truth - 1e-8, &manifold);
        assert_int_equal(manifold.count, 0);
        release_hull(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_separation_along_normal_equals_brute_force),
        cmocka_unit_test(test_hull_of_a_box_separates_like_the_box),
        cmocka_unit_test(test_degenerate_poses_keep_every_law),
        cmocka_unit_test(test_results_do_not_depend_on_size_or_position),
        cmocka_unit_test(test_stacked_hulls_keep_their_points_while_they_sway),
        cmocka_unit_test(test_capsules_lie_on_two_points),
        cmocka_unit_test(test_cores_that_meet_are_parted_across),
        cmocka_unit_test(test_plane_separations_are_heights_of_the_vertices),
    };
    return cmocka_run_group_tests_name("engine_collide_polytopes", tests, NULL, NULL);
}
