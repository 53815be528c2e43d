/* Narrow phase: contact points against truths that know no separating axes. */
#include "check.h"
#include "collide_convex.h"
#include "contact/contact_reduce.h"
#include "geometry/shape.h"

typedef struct placed_box {
    pe_shape shape;
    pe_pose pose;
} placed_box;

static pe_vec3 random_vector(check_random *random, double low, double high)
{
    double x = check_uniform(random, low, high), y = check_uniform(random, low, high);
    return pe_v3(x, y, check_uniform(random, low, high));
}

static void place(placed_box *box, pe_vec3 position, pe_quat q)
{
    q = pe_quat_unit(q);
    box->pose = (pe_pose){position, q, pe_matrix_of(q)};
}

static pe_quat random_turn(check_random *random)
{
    double q[4];
    check_quaternion(random, q);
    return (pe_quat){q[0], q[1], q[2], q[3]};
}

static placed_box random_box(check_random *random, double spread)
{
    placed_box box = {.shape = {.kind = PE_SHAPE_BOX}};
    box.shape.half_extents = random_vector(random, 0.2, 1.5);
    place(&box, random_vector(random, -spread, spread), random_turn(random));
    return box;
}

static pe_placed of(const placed_box *box)
{
    return (pe_placed){&box->shape, NULL, &box->pose, pe_shape_size(&box->shape, NULL)};
}

/* Overlap of two boxes along the unit direction d, from a to b: negative when d separates them. */
static double overlap(const placed_box *a, const placed_box *b, pe_vec3 d)
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
static double least_overlap(const placed_box *a, const placed_box *b)
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
        placed_box a = random_box(&random, 0.8), b = random_box(&random, 0.8);
        pe_hits hits = {0};
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
static double outside(const placed_box *box, pe_vec3 x)
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
        placed_box a = random_box(&random, 0.8), b = random_box(&random, 0.8);
        pe_hits hits = {0};
        collide_convex(of(&a), of(&b), 0.01, &hits);
        for (int j = 0; j < hits.count; ++j) {
            const pe_hit *hit = &hits.item[j];
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

static double least_separation(const pe_hits *hits)
{
    double least = HUGE_VAL;
    for (int i = 0; i < hits->count; ++i) {
        least = pe_min(least, hits->item[i].separation);
    }
    return least;
}

static void test_box_box_is_symmetric_and_turns_with_the_world(void **state)
{
    (void)state;
    check_random random = {11};
    for (int i = 0; i < 20000; ++i) {
        placed_box a = random_box(&random, 0.8), b = random_box(&random, 0.8);
        pe_hits one = {0}, swapped = {0}, turned = {0};
        collide_convex(of(&a), of(&b), 0, &one);
        collide_convex(of(&b), of(&a), 0, &swapped);
        assert_int_equal(one.count > 0, swapped.count > 0);

        pe_quat turn = random_turn(&random);
        pe_mat3 m = pe_matrix_of(pe_quat_unit(turn));
        placed_box c = a, d = b;
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
    placed_box a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
    place(&a, pe_v3(0, 0, 0.5), (pe_quat){.w = 1});
    place(&b, pe_v3(0, 0, 1.5), (pe_quat){.w = 1});
    pe_hits hits = {0};
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
    placed_box a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
    place(&a, pe_v3(0, 0, 0.5), (pe_quat){.w = 1});
    place(&b, pe_v3(0, 0, 1.5),
          (pe_quat){.w = cos(0.39269908169872414), .z = sin(0.39269908169872414)});
    pe_hits hits = {0};
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
    placed_box a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
    place(&a, pe_v3(0, 0, 0.5), (pe_quat){.w = 1});
    for (int i = 0; i < 1000; ++i) {
        place(&b, pe_v3(0.1 + check_uniform(&random, -1e-4, 1e-4), 0.2, 1.5),
              (pe_quat){1, 1e-6 * check_uniform(&random, -1, 1),
                        1e-6 * check_uniform(&random, -1, 1), 0.01});
        pe_hits hits = {0};
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
        placed_box box = random_box(&random, 0.5);
        placed_box ball = {.shape = {.kind = PE_SHAPE_SPHERE, .radius = 0.3}};
        place(&ball, random_vector(&random, -1.5, 1.5), random_turn(&random));
        pe_hits hits = {0};
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
        placed_box moved = ball;
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
        pe_vec3 n = random_vector(&random, -1, 1);
        placed_box plane = {.shape = {.kind = PE_SHAPE_PLANE,
                                      .normal = pe_scale(1 / pe_length(n), n),
                                      .offset = check_uniform(&random, -1, 1)}};
        placed_box box = random_box(&random, 1);
        pe_hits hits = {0}, swapped = {0};
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

/* The largest separation of two boxes over the 15 axes, from their corners, and which axis it is
 * on; *second is that on the others, but those within a hundredth of the same direction. */
static double separation_by_corners(const placed_box *a, const placed_box *b, double *second)
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
            const placed_box *box = k < 8 ? a : b;
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
static void random_pair(check_random *random, bool aligned, placed_box *a, placed_box *b)
{
    *a = random_box(random, 1.2);
    *b = random_box(random, 1.2);
    if (aligned) {
        pe_quat q = a->pose.orientation;
        pe_vec3 d = random_vector(random, -0.02, 0.02);
        place(b, b->pose.position,
              pe_quat_product((pe_quat){1, 0.5 * d.x, 0.5 * d.y, 0.5 * d.z}, q));
    }
}

static void test_a_pair_is_rejected_exactly_when_an_axis_separates_it_by_the_margin(void **state)
{
    (void)state;
    check_random random = {17};
    int apart = 0, near = 0;
    for (int i = 0; i < 40000; ++i) {
        placed_box a, b;
        random_pair(&random, i % 2 == 0, &a, &b);
        double second, margin = i % 3 == 0 ? 0 : check_uniform(&random, 0, 0.3);
        double truth = separation_by_corners(&a, &b, &second);
        pe_hits hits = {0};
        collide_convex(of(&a), of(&b), margin, &hits);
        if (truth > margin + 1e-12) {
            assert_int_equal(hits.count, 0);
            apart += 1;
        } else if (truth < margin - 1e-12 && truth < 0) {
            /* A gap may be between a face and the side of another: no point faces the face. */
            assert_true(hits.count > 0);
            near += 1;
        }
    }
    assert_true(apart > 5000);
    assert_true(near > 5000);
}

static bool has_point_at(const pe_hits *hits, const pe_hit *at, double within)
{
    for (int i = 0; i < hits->count; ++i) {
        if (pe_length(pe_sub(hits->item[i].position, at->position)) <= within &&
            fabs(hits->item[i].separation - at->separation) <= within) {
            return true;
        }
    }
    return false;
}

static void test_swapping_the_shapes_mirrors_the_points(void **state)
{
    (void)state;
    check_random random = {23};
    int compared = 0;
    for (int i = 0; i < 20000; ++i) {
        placed_box a, b;
        random_pair(&random, i % 2 == 0, &a, &b);
        if (i % 5 == 0) {
            b.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0.5};
        }
        double size = pe_min(pe_shape_size(&a.shape, NULL), pe_shape_size(&b.shape, NULL)),
               second = -HUGE_VAL;
        double best = i % 5 == 0 ? 0 : separation_by_corners(&a, &b, &second);
        pe_hits one = {0}, two = {0};
        collide_convex(of(&a), of(&b), 0.05, &one);
        collide_convex(of(&b), of(&a), 0.05, &two);
        assert_int_equal(one.count > 0, two.count > 0);
        double same = pe_dot(one.normal, two.normal);
        /* Axes that nearly tie are settled by the bias, and nearly parallel faces by who is first.
         */
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

static void test_points_are_the_same_at_every_margin_of_their_range_and_at_no_other(void **state)
{
    (void)state;
    check_random random = {29};
    int ended = 0, begun = 0;
    for (int i = 0; i < 20000; ++i) {
        placed_box a, b;
        random_pair(&random, i % 2 == 0, &a, &b);
        if (i % 4 == 0) {
            a.shape = (pe_shape){
                .kind = PE_SHAPE_PLANE, .normal = {0, 0.6, 0.8}, .offset = a.pose.position.x};
        } else if (i % 4 == 1) {
            a.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0.4};
        }
        pe_hits hits, other;
        collide_convex(of(&a), of(&b), check_uniform(&random, 0, 0.3), &hits);
        if (hits.count == 0) {
            continue;
        }
        assert_true(hits.least_margin < hits.end_margin);
        double low = hits.least_margin, end = pe_min(hits.end_margin, 10);
        for (int k = 0; k < 4; ++k) {
            double margin = k == 0 ? low : low + check_uniform(&random, 0, 1) * (end - low);
            if (margin < end) {
                collide_convex(of(&a), of(&b), margin, &other);
                assert_int_equal(other.count, hits.count);
                for (int j = 0; j < hits.count; ++j) {
                    assert_memory_equal(&other.item[j].position, &hits.item[j].position,
                                        sizeof hits.item[j].position);
                    assert_int_equal(other.item[j].feature, hits.item[j].feature);
                }
            }
        }
        collide_convex(of(&a), of(&b), nextafter(low, -HUGE_VAL), &other);
        assert_true(other.count < hits.count);
        begun += 1;
        if (hits.end_margin < HUGE_VAL) {
            collide_convex(of(&a), of(&b), hits.end_margin, &other);
            assert_true(other.count > hits.count);
            ended += 1;
        }
    }
    assert_true(begun > 5000);
    assert_true(ended > 500);
}

/* Twice the area of the projection of a quadrilateral of points, the largest over its three orders.
 */
static double quad_area(const pe_hits *hits, const int q[4])
{
    double most = 0;
    static const int orders[3][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 1, 3, 2}};
    for (int o = 0; o < 3; ++o) {
        double area = 0;
        for (int k = 0; k < 4; ++k) {
            pe_vec3 x = hits->item[q[orders[o][k]]].position;
            pe_vec3 y = hits->item[q[orders[o][(k + 1) % 4]]].position;
            area += pe_dot(hits->normal, pe_cross(x, y));
        }
        most = pe_max(most, fabs(area));
    }
    return most;
}

/* Faces that overlap in five to eight corners, tilted a little. */
static void many_points(check_random *random, pe_hits *hits)
{
    do {
        placed_box a = {.shape = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}}, b = a;
        b.shape.half_extents = random_vector(random, 0.4, 0.6);
        place(&a, pe_v3(0, 0, 0), (pe_quat){.w = 1});
        double angle = check_uniform(random, 0.1, 0.7);
        pe_vec3 tilt = random_vector(random, -1e-3, 1e-3);
        place(&b, pe_v3(tilt.x, tilt.y, 0.5 + b.shape.half_extents.z),
              (pe_quat){cos(angle), tilt.x, tilt.y, sin(angle)});
        collide_convex(of(&a), of(&b), 0.1, hits);
    } while (hits->count < 5);
}

static void test_reducing_keeps_a_deepest_point_and_most_of_the_area(void **state)
{
    (void)state;
    check_random random = {37};
    for (int i = 0; i < 2000; ++i) {
        pe_hits hits;
        many_points(&random, &hits);
        pe_hits all = hits;
        pe_hits_reduce(&hits, 0.4);
        assert_int_equal(hits.count, 4);
        assert_close(least_separation(&hits), least_separation(&all), 1e-5 * 0.4, 0);
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
        assert_at_most(0.7 * best, quad_area(&hits, every));
        for (int j = 0; j < 4; ++j) {
            assert_true(has_point_at(&all, &hits.item[j], 0));
            assert_true(j == 0 || hits.item[j - 1].feature < hits.item[j].feature);
        }
    }
}

static void test_reducing_chooses_the_same_features_under_the_motion_of_rest(void **state)
{
    (void)state;
    /* Regular polygons: depths tie, and in those of odd number the farthest points too. */
    check_random random = {41};
    for (int corners = 5; corners <= PE_MAX_POINTS; ++corners) {
        pe_hits first = {0};
        for (int i = 0; i < 500; ++i) {
            pe_hits hits = {.normal = {0, 0, 1}, .count = corners};
            for (int j = 0; j < corners; ++j) {
                /* Found from another corner on each time. */
                int k = (i + j) % corners;
                double angle = 2 * 3.141592653589793 * k / corners;
                hits.item[j] = (pe_hit){
                    .position = pe_add(pe_v3(0.5 * cos(angle), 0.5 * sin(angle), 0),
                                       random_vector(&random, -1e-8, 1e-8)),
                    .separation = check_uniform(&random, -1e-8, 1e-8),
                    .feature = (uint64_t)(7 * k % 11),
                };
            }
            pe_hits_reduce(&hits, 0.5);
            assert_int_equal(hits.count, 4);
            first = i == 0 ? hits : first;
            for (int j = 0; j < 4; ++j) {
                assert_int_equal(hits.item[j].feature, first.item[j].feature);
            }
        }
    }
}

static void test_reducing_points_on_one_line_keeps_the_ends(void **state)
{
    (void)state;
    pe_hits hits = {.normal = {0, 0, 1}, .count = 6};
    static const double at[6] = {0.3, -1, 0, 1, 0.5, -0.2};
    for (uint32_t i = 0; i < 6; ++i) {
        hits.item[i] =
            (pe_hit){.position = {at[i], 0, 0}, .separation = i == 3 ? -1e-3 : 0, .feature = 6 - i};
    }
    pe_hits_reduce(&hits, 1);
    assert_int_equal(hits.count, 2);
    assert_close(hits.item[0].position.x, 1, 0, 0);
    assert_close(hits.item[1].position.x, -1, 0, 0);
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
        cmocka_unit_test(test_a_pair_is_rejected_exactly_when_an_axis_separates_it_by_the_margin),
        cmocka_unit_test(test_swapping_the_shapes_mirrors_the_points),
        cmocka_unit_test(test_points_are_the_same_at_every_margin_of_their_range_and_at_no_other),
        cmocka_unit_test(test_reducing_keeps_a_deepest_point_and_most_of_the_area),
        cmocka_unit_test(test_reducing_chooses_the_same_features_under_the_motion_of_rest),
        cmocka_unit_test(test_reducing_points_on_one_line_keeps_the_ends),
    };
    return cmocka_run_group_tests_name("engine_collide", tests, NULL, NULL);
}
