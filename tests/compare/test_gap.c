/* Gaps by closed forms against libccd, and both against independent computations. */
#include "referee/geometry/gap.h"

#include "check.h"

#include <math.h>
#include <string.h>

enum { POSES = 10000 };

typedef enum placing { ANYWHERE, DEEP, SHALLOW, TOUCHING, ALIGNED, PLACING_COUNT } placing;

typedef struct pose_pair {
    pl_shape shape_a, shape_b;
    pl_placed_shape a, b;
} pose_pair;

static double closed_form(const pose_pair *p)
{
    double gap = nan("");
    assert_int_equal(pl_gap_closed_form(&p->a, &p->b, &gap), PL_OK);
    return gap;
}

static double by_libccd(const pose_pair *p)
{
    double gap = nan("");
    assert_int_equal(pl_gap_convex(&p->a, &p->b, HUGE_VAL, &gap), PL_OK);
    return gap;
}

static pl_shape random_shape(check_random *random, pl_shape_kind kind)
{
    pl_shape shape = {.kind = kind, .radius = check_uniform(random, 0.1, 1)};
    for (int k = 0; k < 3; ++k) {
        shape.half_extents[k] = check_uniform(random, 0.1, 1);
    }
    return shape;
}

static void move_along(pose_pair *p, const double direction[3], double distance)
{
    for (int k = 0; k < 3; ++k) {
        p->b.position[k] = p->a.position[k] + distance * direction[k];
    }
}

/* Moves b along a random ray from a's centre until the closed form gives `gap`. */
static void slide_to(pose_pair *p, check_random *random, double gap)
{
    double direction[3], square = 0, low = 0, high = 6;
    for (int k = 0; k < 3; ++k) {
        direction[k] = check_uniform(random, -1, 1);
        square += direction[k] * direction[k];
    }
    for (int k = 0; k < 3; ++k) {
        direction[k] /= sqrt(square);
    }
    for (int i = 0; i < 80; ++i) {
        double middle = (low + high) / 2;
        move_along(p, direction, middle);
        if (closed_form(p) < gap) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/* Fills *p in place, because it contains pointers into itself. */
static void place(pose_pair *p, check_random *random, pl_shape_kind kind_a, pl_shape_kind kind_b,
                  placing how)
{
    memset(p, 0, sizeof *p);
    p->shape_a = random_shape(random, kind_a);
    p->shape_b = random_shape(random, kind_b);
    p->a.shape = &p->shape_a;
    p->b.shape = &p->shape_b;
    check_quaternion(random, p->a.orientation);
    check_quaternion(random, p->b.orientation);
    double reach = how == DEEP ? 0.15 : 1.2;
    for (int k = 0; k < 3; ++k) {
        p->a.position[k] = check_uniform(random, -reach, reach);
        p->b.position[k] = check_uniform(random, -reach, reach);
    }
    if (how == SHALLOW) {
        slide_to(p, random, -pow(10, check_uniform(random, -12, -1)));
    } else if (how == TOUCHING) {
        slide_to(p, random, 0);
    } else if (how == ALIGNED) {
        /* Equal cubes on a grid of quarter steps: every axis degenerate, many exactly touching. */
        for (int k = 0; k < 3; ++k) {
            p->shape_a.half_extents[k] = p->shape_b.half_extents[k] = 0.5;
            p->a.position[k] = 0;
            p->b.position[k] = 0.25 * floor(check_uniform(random, -5, 6));
        }
        for (int k = 0; k < 4; ++k) {
            p->a.orientation[k] = p->b.orientation[k] = k == 0;
        }
    }
}

/* How far libccd may be off by its own stopping rules, for shapes of size s (gap_convex.c): its EPA
 * ends when depth x error < 1e-14 s^2, and below depth 1.5e-8 s it reports touching. */
static double libccd_error(double gap, double s)
{
    return 1e-12 + fmin(1.01e-14 * s * s / fabs(gap), 2e-8 * s);
}

static double size_of(const pl_shape *shape)
{
    const double *h = shape->half_extents;
    return shape->kind == PL_SHAPE_BOX ? sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2])
                                       : shape->radius;
}

static double core_radius(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_SPHERE ? shape->radius : 0;
}

static void compare_closed_form_and_libccd(pl_shape_kind kind_a, pl_shape_kind kind_b)
{
    check_random random = {UINT64_C(88172645463325252)};
    for (int how = 0; how < PLACING_COUNT; ++how) {
        for (int i = 0; i < POSES; ++i) {
            pose_pair p;
            place(&p, &random, kind_a, kind_b, (placing)how);
            double closed = closed_form(&p), ccd = by_libccd(&p);
            double size = size_of(&p.shape_a) + size_of(&p.shape_b);
            double core = closed + core_radius(&p.shape_a) + core_radius(&p.shape_b);
            double error = libccd_error(core, size);
            if (kind_a == PL_SHAPE_BOX && kind_b == PL_SHAPE_BOX && closed > 0) {
                /* Apart, the axes give a lower bound of the distance that libccd finds. */
                assert_at_most(closed, ccd + error);
                assert_true(ccd > -error);
            } else {
                assert_close(ccd, closed, error, 0);
            }
        }
    }
}

static void test_box_box_closed_form_equals_libccd(void **state)
{
    (void)state;
    compare_closed_form_and_libccd(PL_SHAPE_BOX, PL_SHAPE_BOX);
}

static void test_sphere_box_closed_form_equals_libccd(void **state)
{
    (void)state;
    compare_closed_form_and_libccd(PL_SHAPE_SPHERE, PL_SHAPE_BOX);
}

static void test_sphere_sphere_closed_form_equals_libccd(void **state)
{
    (void)state;
    compare_closed_form_and_libccd(PL_SHAPE_SPHERE, PL_SHAPE_SPHERE);
}

/* Rotation of v by a unit quaternion, written out so that the test does not depend on vec.h. */
static void rotate(const double q[4], const double v[3], double out[3])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    out[0] = (w * w + x * x - y * y - z * z) * v[0] + 2 * (x * y - w * z) * v[1] +
             2 * (x * z + w * y) * v[2];
    out[1] = 2 * (x * y + w * z) * v[0] + (w * w - x * x + y * y - z * z) * v[1] +
             2 * (y * z - w * x) * v[2];
    out[2] = 2 * (x * z - w * y) * v[0] + 2 * (y * z + w * x) * v[1] +
             (w * w - x * x - y * y + z * z) * v[2];
}

/* Vertex 0 .. 7 of a box; a sphere's centre. */
static void vertex_of(const pl_placed_shape *placed, int which, double out[3])
{
    double local[3] = {0, 0, 0};
    for (int k = 0; k < 3 && placed->shape->kind == PL_SHAPE_BOX; ++k) {
        double half = placed->shape->half_extents[k];
        local[k] = (which >> k & 1) != 0 ? half : -half;
    }
    rotate(placed->orientation, local, out);
    for (int k = 0; k < 3; ++k) {
        out[k] += placed->position[k];
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The Minkowski difference of two shapes as points and a radius, for support by brute force. */
typedef struct difference {
    double point[64][3];
    int count;
    double radius;
} difference;

static difference difference_of(const pose_pair *p)
{
    difference d = {.radius = core_radius(&p->shape_a) + core_radius(&p->shape_b)};
    int of_a = p->shape_a.kind == PL_SHAPE_BOX ? 8 : 1;
    int of_b = p->shape_b.kind == PL_SHAPE_BOX ? 8 : 1;
    for (int i = 0; i < of_a * of_b; ++i, ++d.count) {
        double a[3], b[3];
        vertex_of(&p->a, i / of_b, a);
        vertex_of(&p->b, i % of_b, b);
        for (int k = 0; k < 3; ++k) {
            d.point[i][k] = a[k] - b[k];
        }
    }
    return d;
}

/* How far b must move along `unit` to separate from a. */
static double parting(const difference *d, const double unit[3])
{
    double most = -HUGE_VAL;
    for (int i = 0; i < d->count; ++i) {
        most = fmax(most, dot(d->point[i], unit));
    }
    return most + d->radius;
}

/* Improves `unit` by smaller and smaller random rotations. Returns its depth. */
static double refined(const difference *d, check_random *random, double unit[3])
{
    double best = parting(d, unit), turn = 0.05;
    for (int failures = 0; turn > 1e-9;) {
        double tried[3], square = 0;
        for (int k = 0; k < 3; ++k) {
            tried[k] = unit[k] + turn * check_uniform(random, -1, 1);
            square += tried[k] * tried[k];
        }
        for (int k = 0; k < 3; ++k) {
            tried[k] /= sqrt(square);
        }
        double depth = parting(d, tried);
        failures += 1;
        if (depth < best) {
            best = depth;
            failures = 0;
            memcpy(unit, tried, sizeof tried);
        } else if (failures > 150) {
            turn *= 0.6;
            failures = 0;
        }
    }
    return best;
}

/* The minimum translation over a dense set of directions (a Fibonacci spiral). Each direction
 * within the spacing of the best is refined. */
static double swept_depth(const pose_pair *p, check_random *random)
{
    enum { SWEEP = 2000 };
    const double spacing = sqrt(12.566370614359172 / SWEEP);
    difference d = difference_of(p);
    double unit[SWEEP][3], depth[SWEEP], best = HUGE_VAL;
    for (int i = 0; i < SWEEP; ++i) {
        check_spiral_direction(i, SWEEP, unit[i]);
        depth[i] = parting(&d, unit[i]);
        best = fmin(best, depth[i]);
    }
    double coarse = best;
    for (int i = 0; i < SWEEP; ++i) {
        if (depth[i] < coarse + spacing / 2) {
            best = fmin(best, refined(&d, random, unit[i]));
        }
    }
    return best;
}

/* Every direction of a sweep gives at least the depth, and the refined best gives it to its
 * resolution. */
static void compare_with_sweep(pl_shape_kind kind_a, pl_shape_kind kind_b)
{
    check_random random = {UINT64_C(362436069)};
    for (int i = 0; i < 60; ++i) {
        pose_pair p;
        double depth;
        do {
            place(&p, &random, kind_a, kind_b, i % 2 == 0 ? ANYWHERE : DEEP);
            depth = -closed_form(&p);
        } while (depth <= 0);
        double swept = swept_depth(&p, &random);
        assert_at_most(depth, swept + 1e-12);
        assert_at_most(-by_libccd(&p), swept + 1e-12);
        assert_close(depth, swept, 1e-6, 0);
    }
}

static void test_box_box_depth_equals_dense_direction_sweep(void **state)
{
    (void)state;
    compare_with_sweep(PL_SHAPE_BOX, PL_SHAPE_BOX);
}

static void test_sphere_box_depth_equals_dense_direction_sweep(void **state)
{
    (void)state;
    compare_with_sweep(PL_SHAPE_SPHERE, PL_SHAPE_BOX);
}

/* The depth from the convex hull of the 64 vertex differences by brute force: the nearest plane
 * through three of them that has all the others on one side. Uses vertices only, no axes. */
static double hull_depth(const pose_pair *p)
{
    double best = HUGE_VAL;
    const difference d = difference_of(p);
    const double(*point)[3] = d.point;
    for (int i = 0; i < 64; ++i) {
        for (int j = i + 1; j < 64; ++j) {
            for (int k = j + 1; k < 64; ++k) {
                double u[3], v[3], n[3];
                for (int c = 0; c < 3; ++c) {
                    u[c] = point[j][c] - point[i][c];
                    v[c] = point[k][c] - point[i][c];
                }
                for (int c = 0; c < 3; ++c) {
                    n[c] = u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3];
                }
                double length = sqrt(dot(n, n));
                if (length < 1e-9) {
                    continue;
                }
                double low = HUGE_VAL, high = -HUGE_VAL, offset = dot(n, point[i]);
                for (int m = 0; m < 64 && !(low < -1e-12 * length && high > 1e-12 * length); ++m) {
                    double side = dot(n, point[m]) - offset;
                    low = fmin(low, side);
                    high = fmax(high, side);
                }
                if (low >= -1e-12 * length || high <= 1e-12 * length) {
                    best = fmin(best, fabs(offset) / length);
                }
            }
        }
    }
    return best;
}

static void test_box_box_depth_equals_hull_of_vertex_differences(void **state)
{
    (void)state;
    check_random random = {UINT64_C(521288629)};
    for (int i = 0; i < 150; ++i) {
        pose_pair p;
        double depth;
        do {
            place(&p, &random, PL_SHAPE_BOX, PL_SHAPE_BOX, (placing)(i % 3));
            depth = -closed_form(&p);
        } while (depth < 1e-6);
        assert_close(depth, hull_depth(&p), 1e-11, 0);
    }
}

/* A unit quaternion that turns by `angle` about a unit axis. */
static void turn_about(const double axis[3], double angle, double q[4])
{
    q[0] = cos(angle / 2);
    for (int k = 0; k < 3; ++k) {
        q[k + 1] = sin(angle / 2) * axis[k];
    }
}

/* With b = a turned by a tiny angle, all cross axes are differences of nearly equal numbers. The
 * depth may change by no more than the angle times the lever arm, and must never exceed any swept
 * direction. */
static void test_box_box_depth_is_continuous_at_parallel_edges(void **state)
{
    (void)state;
    check_random random = {UINT64_C(123456789)};
    for (int i = 0; i < 2000; ++i) {
        pose_pair p;
        place(&p, &random, PL_SHAPE_BOX, PL_SHAPE_BOX, DEEP);
        for (int k = 0; k < 4; ++k) {
            p.a.orientation[k] = p.b.orientation[k] = k == 0;
        }
        double parallel = closed_form(&p);
        double axis[3];
        for (int k = 0; k < 3; ++k) {
            axis[k] = check_uniform(&random, -1, 1);
        }
        double length = sqrt(dot(axis, axis));
        for (int k = 0; k < 3; ++k) {
            axis[k] /= length;
        }
        for (int power = 1; power <= 18; ++power) {
            double angle = pow(10, -power);
            turn_about(axis, angle, p.b.orientation);
            assert_close(closed_form(&p), parallel, 2 * angle + 1e-14, 0);
            difference d = difference_of(&p);
            for (int s = 0; s < 20; ++s) {
                double q[4], unit[3];
                const double x[3] = {1, 0, 0};
                check_quaternion(&random, q);
                rotate(q, x, unit);
                assert_at_most(-closed_form(&p), parting(&d, unit) + 1e-14);
            }
        }
    }
}

/* Two unit cubes edge to edge, one leaning by a tiny angle about the diagonal between them, so that
 * the two edges cross. Only the cross product of the edges shows by how much they miss or overlap;
 * the face axes see an overlap of 0.35 angle more. */
static void test_nearly_parallel_edges_are_distinguished_by_their_axis(void **state)
{
    (void)state;
    const double diagonal[3] = {sqrt(0.5), sqrt(0.5), 0};
    for (int power = 2; power <= 14; ++power) {
        for (int sign = -1; sign <= 1; sign += 2) {
            double angle = pow(10, -power), apart = sign * 0.1 * angle;
            pose_pair p = {.shape_a = {.kind = PL_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}}};
            p.a = p.b = (pl_placed_shape){.shape = &p.shape_a, .orientation = {1, 0, 0, 0}};
            turn_about(diagonal, angle, p.b.orientation);
            p.b.position[0] = p.b.position[1] = 1 + apart;
            assert_close(closed_form(&p), sqrt(2) * apart, 1e-15, 0);
        }
    }
}

/* Prisms rotated about their axis and tilted by a tiny angle: the nearest facet may be the narrow
 * one between two nearly parallel edges. libccd computes the projection of the origin onto such a
 * triangle as a quotient of tiny numbers, with an error of up to 1e-9. So the comparison is
 * one-sided: both depths are widths along some direction, never less than the true depth, and the
 * closed form must be the smaller. */
static void test_box_box_depth_never_exceeds_that_of_libccd(void **state)
{
    (void)state;
    check_random random = {UINT64_C(987654321)};
    const double up[3] = {0, 0, 1}, side[3] = {0.6, 0.8, 0};
    for (int i = 0; i < 4000; ++i) {
        pose_pair p;
        place(&p, &random, PL_SHAPE_BOX, PL_SHAPE_BOX, ANYWHERE);
        double about_z[4], lean[4];
        turn_about(up, check_uniform(&random, 0, 1.5), about_z);
        turn_about(side, pow(10, check_uniform(&random, -16, -2)), lean);
        for (int k = 0; k < 4; ++k) {
            p.a.orientation[k] = k == 0;
        }
        double *q = p.b.orientation;
        q[0] = lean[0] * about_z[0];
        q[1] = lean[1] * about_z[0] + lean[2] * about_z[3];
        q[2] = lean[2] * about_z[0] - lean[1] * about_z[3];
        q[3] = lean[0] * about_z[3];
        double closed = closed_form(&p);
        double ccd = by_libccd(&p);
        double size = size_of(&p.shape_a) + size_of(&p.shape_b);
        assert_true(closed > 0 || ccd <= closed + 1e-14);
        assert_true(closed > 0 || ccd >= closed - 2e-8 * size);
    }
}

static void test_gap_is_the_same_in_either_order(void **state)
{
    (void)state;
    check_random random = {UINT64_C(777)};
    const pl_shape_kind kinds[3][2] = {{PL_SHAPE_BOX, PL_SHAPE_BOX},
                                       {PL_SHAPE_SPHERE, PL_SHAPE_BOX},
                                       {PL_SHAPE_SPHERE, PL_SHAPE_SPHERE}};
    for (int i = 0; i < 3000; ++i) {
        pose_pair p;
        place(&p, &random, kinds[i % 3][0], kinds[i % 3][1], ANYWHERE);
        double swapped = nan("");
        assert_int_equal(pl_gap_closed_form(&p.b, &p.a, &swapped), PL_OK);
        assert_close(swapped, closed_form(&p), 1e-14, 0);
    }
}

static void test_growing_a_sphere_by_the_gap_touches(void **state)
{
    (void)state;
    check_random random = {UINT64_C(4242)};
    for (int i = 0; i < 1000; ++i) {
        pose_pair p;
        place(&p, &random, PL_SHAPE_SPHERE, PL_SHAPE_BOX, ANYWHERE);
        /* Growing the sphere by the gap must make the shapes touch: from outside, inside, face,
         * edge. */
        p.shape_a.radius += closed_form(&p);
        assert_close(closed_form(&p), 0, 1e-14, 0);
        assert_close(by_libccd(&p), 0, 1e-7, 0);
    }
}

static void test_plane_gap_is_the_lowest_points_height(void **state)
{
    (void)state;
    check_random random = {UINT64_C(99)};
    for (int i = 0; i < 10000; ++i) {
        pose_pair p;
        double q[4];
        const double up[3] = {0, 0, 1};
        place(&p, &random, PL_SHAPE_SPHERE, i % 2 == 0 ? PL_SHAPE_BOX : PL_SHAPE_SPHERE, ANYWHERE);
        p.shape_a = (pl_shape){.kind = PL_SHAPE_PLANE, .offset = check_uniform(&random, -1, 1)};
        check_quaternion(&random, q);
        rotate(q, up, p.shape_a.normal);
        double expected = HUGE_VAL;
        for (int vertex = 0; vertex < 8; ++vertex) {
            double v[3];
            vertex_of(&p.b, vertex, v);
            expected = fmin(expected, dot(v, p.shape_a.normal));
        }
        expected -= p.shape_a.offset + core_radius(&p.shape_b);
        assert_close(closed_form(&p), expected, 1e-14, 0);
    }
}

static void test_two_planes_have_no_gap(void **state)
{
    (void)state;
    pl_shape plane = {.kind = PL_SHAPE_PLANE, .normal = {0, 0, 1}};
    pl_placed_shape placed = {.shape = &plane};
    double gap = 0;
    assert_int_equal(pl_gap(&placed, &placed, HUGE_VAL, &gap), PL_UNSUPPORTED);
    assert_int_equal(pl_gap_closed_form(&placed, &placed, &gap), PL_UNSUPPORTED);
    assert_int_equal(pl_gap_convex(&placed, &placed, HUGE_VAL, &gap), PL_UNSUPPORTED);
}

static void test_coincident_bodies_overlap_by_their_half_widths(void **state)
{
    (void)state;
    pose_pair p = {.shape_a = {.kind = PL_SHAPE_BOX, .half_extents = {1, 2, 3}},
                   .shape_b = {.kind = PL_SHAPE_BOX, .half_extents = {4, 2, 3}}};
    p.a = (pl_placed_shape){.shape = &p.shape_a, .orientation = {1, 0, 0, 0}};
    p.b = (pl_placed_shape){.shape = &p.shape_b, .orientation = {1, 0, 0, 0}};
    assert_close(closed_form(&p), -4, 0, 0);
    assert_close(by_libccd(&p), -4, 1e-12, 0);
    p.shape_a = (pl_shape){.kind = PL_SHAPE_SPHERE, .radius = 0.5};
    assert_close(closed_form(&p), -2.5, 0, 0);
    assert_close(by_libccd(&p), -2.5, 1e-12, 0);
    p.shape_b = (pl_shape){.kind = PL_SHAPE_SPHERE, .radius = 0.25};
    assert_close(closed_form(&p), -0.75, 0, 0);
    assert_close(by_libccd(&p), -0.75, 1e-12, 0);
}

/* A validated scene allows a deviation from unit length of 1e-9; here it is 1e-3. */
static void test_quaternion_length_does_not_scale_the_shape(void **state)
{
    (void)state;
    check_random random = {UINT64_C(5150)};
    for (int i = 0; i < 1000; ++i) {
        pose_pair p;
        place(&p, &random, PL_SHAPE_BOX, PL_SHAPE_BOX, ANYWHERE);
        double unit = closed_form(&p);
        for (int k = 0; k < 4; ++k) {
            p.b.orientation[k] *= 1.001;
        }
        assert_close(closed_form(&p), unit, 1e-14, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_box_closed_form_equals_libccd),
        cmocka_unit_test(test_sphere_box_closed_form_equals_libccd),
        cmocka_unit_test(test_sphere_sphere_closed_form_equals_libccd),
        cmocka_unit_test(test_box_box_depth_equals_dense_direction_sweep),
        cmocka_unit_test(test_sphere_box_depth_equals_dense_direction_sweep),
        cmocka_unit_test(test_box_box_depth_equals_hull_of_vertex_differences),
        cmocka_unit_test(test_box_box_depth_is_continuous_at_parallel_edges),
        cmocka_unit_test(test_nearly_parallel_edges_are_distinguished_by_their_axis),
        cmocka_unit_test(test_box_box_depth_never_exceeds_that_of_libccd),
        cmocka_unit_test(test_gap_is_the_same_in_either_order),
        cmocka_unit_test(test_growing_a_sphere_by_the_gap_touches),
        cmocka_unit_test(test_plane_gap_is_the_lowest_points_height),
        cmocka_unit_test(test_two_planes_have_no_gap),
        cmocka_unit_test(test_coincident_bodies_overlap_by_their_half_widths),
        cmocka_unit_test(test_quaternion_length_does_not_scale_the_shape),
    };
    return cmocka_run_group_tests_name("gap", tests, NULL, NULL);
}
