/* References of the narrow phase's tests, against closed forms, sweeps, each other and libccd. */
#include "ccd_solid.h"
#include "mesh_truth.h"
#include "shape_pairs_trial.h"

static const shape_pool *pool;

static double no_gap(const pair *p, pe_vec3 *normal)
{
    *normal = pe_v3(0, 0, 1);
    (void)p;
    return 0;
}

static pair pair_of(pe_shape_kind a, pe_shape_kind b, int i, check_random *random)
{
    static const pair_pose poses[] = {POSE_ANY,   POSE_DEEP, POSE_SHALLOW,
                                      POSE_CLOSE, POSE_FAR,  POSE_TOUCHING};
    pair_pose pose = poses[i % 6];
    bool placed_by_gap = pose == POSE_SHALLOW || pose == POSE_CLOSE || pose == POSE_TOUCHING;
    return random_pair(pool, a, b, pose, random, placed_by_gap ? true_gap : no_gap);
}

/* Lengths of the pair, for what rounding may do. */
static double rounding(const pair *p)
{
    return 1e-14 * (pe_length(pe_sub(p->b.pose.position, p->a.pose.position)) + p->a.solid->reach +
                    p->b.solid->reach + 5);
}

/* Closest points of two segments about centres p and q of half vectors u and v: the least of a
 * convex quadratic over a square, which is at the stationary point or on a side. */
static double segments_apart(pe_vec3 p, pe_vec3 u, pe_vec3 q, pe_vec3 v)
{
    pe_vec3 w = pe_sub(q, p), n = pe_cross(u, v);
    double least = HUGE_VAL, n2 = pe_dot(n, n);
    for (int side = 0; side < 4; ++side) {
        double end = side & 1 ? 1 : -1;
        /* One at its end, the other anywhere. */
        pe_vec3 x = side < 2 ? pe_madd(w, -end, u) : pe_madd(pe_scale(-1, w), -end, v);
        pe_vec3 along = side < 2 ? v : u;
        double t = pe_dot(along, along) > 0 ? -pe_dot(x, along) / pe_dot(along, along) : 0;
        t = pe_min(1, pe_max(-1, t));
        least = pe_min(least, pe_length(pe_madd(x, t, along)));
    }
    double s = pe_dot(pe_cross(w, v), n), t = pe_dot(pe_cross(w, u), n);
    if (n2 > 0 && fabs(s) <= n2 && fabs(t) <= n2) {
        least = pe_min(least, fabs(pe_dot(w, n)) / sqrt(n2));
    }
    return least;
}

static pe_vec3 core_of(const placed *p)
{
    return pe_scale(p->shape.kind == PE_SHAPE_CAPSULE ? p->shape.half_height : 0,
                    pe_axis(&p->pose.rotation, 2));
}

static void test_truth_of_spheres_and_capsules_is_closed_form(void **state)
{
    (void)state;
    check_random random = {1};
    for (int i = 0; i < 3000; ++i) {
        pe_shape_kind a = i % 3 == 0 ? PE_SHAPE_CAPSULE : PE_SHAPE_SPHERE;
        pe_shape_kind b = i % 3 == 1 ? PE_SHAPE_SPHERE : PE_SHAPE_CAPSULE;
        pair p = pair_of(a, b, i, &random);
        double radii = p.a.shape.radius + p.b.shape.radius;
        double expected =
            segments_apart(p.a.pose.position, core_of(&p.a), p.b.pose.position, core_of(&p.b)) -
            radii;
        truth_distance truth = pair_truth(&p, 1e-11 * p.size);
        assert_at_most(truth.low, expected + rounding(&p));
        assert_at_most(expected, truth.high + rounding(&p));
        assert_at_most(truth.high - truth.low, 1e-11 * p.size + rounding(&p));
    }
}

/* Signed distance of a point to a cylinder or a box about the origin: its `over` a side and a cap,
 * or three sides, negative within. */
static double point_to_solid(const placed *p, pe_vec3 x)
{
    pe_vec3 local = pe_unrotate(&p->pose.rotation, pe_sub(x, p->pose.position));
    double over[3] = {-HUGE_VAL, -HUGE_VAL, fabs(local.z) - p->shape.half_height};
    if (p->shape.kind == PE_SHAPE_CYLINDER) {
        over[0] = sqrt(local.x * local.x + local.y * local.y) - p->shape.radius;
    } else {
        over[0] = fabs(local.x) - p->shape.half_extents.x;
        over[1] = fabs(local.y) - p->shape.half_extents.y;
        over[2] = fabs(local.z) - p->shape.half_extents.z;
    }
    double out = 0, most = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        out += over[k] > 0 ? over[k] * over[k] : 0;
        most = pe_max(most, over[k]);
    }
    return out > 0 ? sqrt(out) : most;
}

static void test_truth_of_sphere_at_solid_is_closed_form(void **state)
{
    (void)state;
    check_random random = {2};
    for (int i = 0; i < 3000; ++i) {
        pair p =
            pair_of(PE_SHAPE_SPHERE, i % 2 == 0 ? PE_SHAPE_BOX : PE_SHAPE_CYLINDER, i / 2, &random);
        double expected = point_to_solid(&p.b, p.a.pose.position) - p.a.shape.radius;
        truth_distance truth = pair_truth(&p, 1e-11 * p.size);
        assert_at_most(truth.low, expected + rounding(&p));
        assert_at_most(expected, truth.high + rounding(&p));
        assert_at_most(truth.high - truth.low, 1e-11 * p.size + rounding(&p));
    }
}

/* The largest of the separations along the 15 axes of two boxes: the signed distance where they
 * overlap (Gottschalk 1996). */
static double largest_of_15_axes(const pair *p)
{
    double most = -HUGE_VAL;
    for (int i = 0; i < 15; ++i) {
        pe_vec3 n = i < 3   ? pe_axis(&p->a.pose.rotation, i)
                    : i < 6 ? pe_axis(&p->b.pose.rotation, i - 3)
                            : pe_cross(pe_axis(&p->a.pose.rotation, (i - 6) / 3),
                                       pe_axis(&p->b.pose.rotation, (i - 6) % 3));
        double length = pe_length(n), low[2] = {HUGE_VAL, HUGE_VAL}, high[2];
        if (length < 1e-9) {
            continue;
        }
        for (int k = 0; k < 2; ++k) {
            const placed *box = k == 0 ? &p->a : &p->b;
            high[k] = -HUGE_VAL;
            for (int j = 0; j < 8; ++j) {
                pe_vec3 v = pe_rotate(&box->pose.rotation, box->solid->vertices[j]);
                v = pe_sub(pe_add(v, box->pose.position), p->a.pose.position);
                double height = pe_dot(n, v) / length;
                low[k] = pe_min(low[k], height);
                high[k] = pe_max(high[k], height);
            }
        }
        most = pe_max(most, pe_max(low[0] - high[1], low[1] - high[0]));
    }
    return most;
}

static void test_truth_of_boxes_equals_axes_and_triangles(void **state)
{
    (void)state;
    check_random random = {3};
    int overlapping = 0, apart = 0;
    for (int i = 0; i < 3000; ++i) {
        pair p = pair_of(PE_SHAPE_BOX, PE_SHAPE_BOX, i, &random);
        truth_distance truth = pair_truth(&p, 1e-11 * p.size);
        assert_at_most(truth.high - truth.low, 1e-11 * p.size + rounding(&p));
        double axes = largest_of_15_axes(&p);
        if (axes < 0) {
            assert_close(truth.low, axes, 1e-11 * p.size + rounding(&p), 0);
            overlapping += 1;
        } else {
            assert_close(truth.low, mesh_distance(&p).low, 1e-11 * p.size + rounding(&p), 0);
            apart += 1;
        }
    }
    assert_true(overlapping > 500 && apart > 500);
}

static void test_no_swept_direction_is_beyond_the_truth(void **state)
{
    (void)state;
    check_random random = {4};
    for (int i = 0; i < 300; ++i) {
        pe_shape_kind a = (pe_shape_kind)(PE_SHAPE_SPHERE + i % 5);
        pe_shape_kind b = (pe_shape_kind)(PE_SHAPE_SPHERE + i / 5 % 5);
        pair p = pair_of(a < b ? a : b, a < b ? b : a, i, &random);
        truth_distance truth = pair_truth(&p, 1e-11 * p.size);
        assert_close(pair_separation_along(&p, truth.normal), truth.low, rounding(&p), 0);
        for (int j = 0; j < 2000; ++j) {
            double along = pair_separation_along(&p, random_direction(&random));
            assert_at_most(along, truth.high + rounding(&p));
        }
        /* Nor next to the direction that it gives. */
        for (int j = 0; j < 200; ++j) {
            double tilt = exp(check_uniform(&random, -20, 0));
            pe_vec3 n = pe_madd(truth.normal, tilt, random_direction(&random));
            double along = pair_separation_along(&p, pe_scale(1 / pe_length(n), n));
            assert_at_most(along, truth.high + rounding(&p));
        }
    }
}

static void test_parting_along_normal_parts_surfaces_as_much(void **state)
{
    (void)state;
    check_random random = {5};
    for (int i = 0; i < 300; ++i) {
        pair p = pair_of(PE_SHAPE_BOX, i % 2 == 0 ? PE_SHAPE_CYLINDER : PE_SHAPE_HULL, i, &random);
        truth_distance one = pair_truth(&p, 1e-11 * p.size);
        /* Parted until they touch, and on. */
        double within = rounding(&p), gap = check_uniform(&random, 0, 1) * p.size;
        pair_part(&p, gap - one.low, one.normal);
        truth_distance two = pair_truth(&p, 1e-11 * p.size);
        /* The normal is as good as the width of the interval, to second order. */
        assert_at_most(gap, two.high + within + rounding(&p));
        assert_at_most(two.low, gap + 1e-9 * p.size);
    }
}

/* ---- libccd ---- */

/* The result of libccd is only compared if its depth is that along its direction. */
static void test_truth_equals_libccd_where_its_depth_is_proven(void **state)
{
    (void)state;
    check_random random = {6};
    int compared = 0, trials = 0;
    for (int i = 0; i < 1500; ++i) {
        static const pe_shape_kind kinds[] = {PE_SHAPE_BOX, PE_SHAPE_CYLINDER, PE_SHAPE_HULL};
        pe_shape_kind a = kinds[i % 3], b = kinds[i / 3 % 3];
        pair p = pair_of(a < b ? a : b, a < b ? b : a, i % 2, &random);
        truth_distance truth = pair_truth(&p, 1e-11 * p.size);
        if (truth.low > -1e-2 * p.size) {
            continue;
        }
        ccd_solid one = {&p.a, p.a.pose.position, p.size}, two = {&p.b, p.a.pose.position, p.size};
        ccd_t ccd;
        CCD_INIT(&ccd);
        ccd.support1 = ccd.support2 = ccd_support;
        ccd.max_iterations = 300;
        ccd.epa_tolerance = 1e-9;
        double depth;
        ccd_vec3_t dir, at;
        trials += 1;
        if (ccdGJKPenetration(&one, &two, &ccd, &depth, &dir, &at) != 0) {
            continue;
        }
        depth *= p.size;
        pe_vec3 n = pe_v3(dir.v[0], dir.v[1], dir.v[2]);
        double along = pair_separation_along(&p, n);
        assert_at_most(along, truth.high + rounding(&p));
        if (fabs(along + depth) <= 1e-8 * p.size) {
            /* libccd may stop at a direction that is not the least, never beyond it. */
            assert_at_most(-depth, truth.high + 1e-8 * p.size);
            compared += fabs(depth + truth.low) <= 1e-6 * p.size;
        }
    }
    assert_true(trials > 300);
    assert_true(compared > trials / 2);
}

/* ---- Meshes ---- */

static void test_distance_of_convex_meshes_equals_their_hulls(void **state)
{
    (void)state;
    check_random random = {7};
    int apart = 0;
    for (int i = 0; i < 1500; ++i) {
        pe_shape_kind a = (pe_shape_kind)(i % PE_SHAPE_COUNT);
        pair p = pair_of(a, PE_SHAPE_MESH, i / 7, &random);
        if (!p.a.solid->convex || !p.b.solid->convex) {
            continue;
        }
        truth_distance truth = pair_truth(&p, 1e-11 * p.size);
        double distance = mesh_distance(&p).low;
        assert_at_most(pe_max(0, truth.low), distance + rounding(&p));
        assert_at_most(distance, pe_max(0, truth.high) + 1e-12 * p.size + rounding(&p));
        apart += distance > 0;
    }
    assert_true(apart > 200);
}

static void test_containment_in_l_shape_follows_its_outline(void **state)
{
    (void)state;
    check_random random = {8};
    const solid *l = &pool->item[PE_SHAPE_MESH][3];
    assert_int_equal(l->vertex_count, 12);
    placed p = {.solid = l};
    place(&p, pe_v3(1, 2, 3), random_turn(&random));
    /* Vertices 0, 1, 5 and 6 are the origin and the ends of the axes of its own frame. */
    pe_vec3 origin = l->vertices[0], x = pe_sub(l->vertices[1], origin),
            y = pe_sub(l->vertices[5], origin), z = pe_sub(l->vertices[6], origin);
    for (int i = 0; i < 3000; ++i) {
        double u = check_uniform(&random, -0.5, 1.5), v = check_uniform(&random, -0.5, 1.5),
               w = check_uniform(&random, -0.5, 1.5);
        bool inside = u > 0 && v > 0 && u < 1 && v < 1 && w > 0 && w < 1 && (u < 0.5 || v < 0.5);
        pe_vec3 local = pe_madd(pe_madd(pe_madd(origin, u, x), v, y), w, z);
        pe_vec3 at = pe_add(p.pose.position, pe_rotate(&p.pose.rotation, local));
        assert_int_equal(is_in_polyhedron(&p, at), inside);
        if (inside) {
            double lu = u * pe_length(x), lw = w * pe_length(z);
            assert_at_most(surface_distance(&p, at), pe_min(lu, lw) + 1e-12);
        }
    }
}

static int set_up(void **state)
{
    (void)state;
    pool = shape_pool_create(99);
    return pool == NULL;
}

static int tear_down(void **state)
{
    (void)state;
    shape_pool_destroy((shape_pool *)pool);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_truth_of_spheres_and_capsules_is_closed_form),
        cmocka_unit_test(test_truth_of_sphere_at_solid_is_closed_form),
        cmocka_unit_test(test_truth_of_boxes_equals_axes_and_triangles),
        cmocka_unit_test(test_no_swept_direction_is_beyond_the_truth),
        cmocka_unit_test(test_parting_along_normal_parts_surfaces_as_much),
        cmocka_unit_test(test_truth_equals_libccd_where_its_depth_is_proven),
        cmocka_unit_test(test_distance_of_convex_meshes_equals_their_hulls),
        cmocka_unit_test(test_containment_in_l_shape_follows_its_outline),
    };
    return cmocka_run_group_tests_name("engine_pairs_truth", tests, set_up, tear_down);
}
