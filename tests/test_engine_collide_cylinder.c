/* Narrow phase of cylinders: signed distances against directions swept densely, and the points of
 * cylinders that stand, spin, roll and lie on each other. */
#include "check.h"
#include "collide_convex.h"
#include "convex_truth.h"
#include "geometry/shape.h"

#include <string.h>

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

/* How far a point is outside a cylinder or a box. */
static double outside(const body *b, pe_vec3 x)
{
    pe_vec3 p = pe_unrotate(&b->pose.rotation, pe_sub(x, b->pose.position));
    const pe_shape *s = &b->shape;
    if (s->kind == PE_SHAPE_BOX) {
        pe_vec3 e = s->half_extents;
        return pe_max(0, pe_max(fabs(p.x) - e.x, pe_max(fabs(p.y) - e.y, fabs(p.z) - e.z)));
    }
    double past = sqrt(p.x * p.x + p.y * p.y) - s->radius, over = fabs(p.z) - s->half_height;
    return pe_max(0, pe_max(past, over));
}

/* Each point, half a separation along the normal, is in either shape. */
static void check_points_are_in_both(const body *a, const body *b, const pe_hits *hits)
{
    double size = pe_min(of(a).size, of(b).size);
    assert_true(hits->count > 0);
    for (int i = 0; i < hits->count; ++i) {
        double half = 0.5 * hits->item[i].separation;
        assert_at_most(outside(a, pe_madd(hits->item[i].position, -half, hits->normal)),
                       1e-8 * size);
        assert_at_most(outside(b, pe_madd(hits->item[i].position, half, hits->normal)),
                       1e-8 * size);
    }
}

/* Turns both about the origin. */
static void turn_both(body *a, body *b, check_random *random)
{
    double q[4];
    check_quaternion(random, q);
    pe_quat turn = pe_quat_unit((pe_quat){q[0], q[1], q[2], q[3]});
    pe_mat3 matrix = pe_matrix_of(turn);
    body *both[2] = {a, b};
    for (int i = 0; i < 2; ++i) {
        place(both[i], pe_rotate(&matrix, both[i]->pose.position),
              pe_quat_product(turn, both[i]->pose.orientation));
    }
}

/* A number from 1e-10 to 1, whose logarithm is even. */
static double of_any_order(check_random *random)
{
    return pow(10, check_uniform(random, -10, 0));
}

/* Cylinders end to end, with axes that are parallel but for a tilt of 1e-1 down to 1e-10, whose
 * rims, seen along them, touch or nearly do: there are the maxima of two rims within the tilt of an
 * axis, and ridges along which the separation hardly changes. */
static void test_nearly_tangent_rims_of_nearly_parallel_cylinders_equal_the_truth(void **state)
{
    (void)state;
    enum { POSES = 600 };
    check_random random = {11};
    int proven = 0;
    for (int i = 0; i < POSES; ++i) {
        body a = cylinder(check_uniform(&random, 0.1, 1), check_uniform(&random, 0.1, 1));
        body b = cylinder(check_uniform(&random, 0.01, 1), check_uniform(&random, 0.1, 1));
        double size = pe_min(of(&a).size, of(&b).size), ra = a.shape.radius, rb = b.shape.radius;
        double aside = i % 2 == 0 ? ra + rb : fabs(ra - rb);
        aside += of_any_order(&random) * size * (i % 3 - 1);
        double gap = of_any_order(&random) * size * (i % 5 - 2);
        double tilt = of_any_order(&random), way = check_uniform(&random, 0, 6.28);
        place(&b, pe_v3(aside, 0, a.shape.half_height + b.shape.half_height + gap),
              about(pe_v3(cos(way), sin(way), 0), tilt));
        turn_both(&a, &b, &random);
        pe_hits hits;
        collide_convex(of(&a), of(&b), 10, &hits);
        truth_difference difference =
            truth_subtract((truth_solid){.shape = &a.shape, .pose = &a.pose},
                           (truth_solid){.shape = &b.shape, .pose = &b.pose});
        truth_distance truth = truth_signed_distance(&difference, 1e-10 * size);
        assert_at_most(truth.low - 1e-9 * size, least_separation(&hits));
        assert_at_most(least_separation(&hits), truth.high + 1e-9 * size);
        assert_close(separation_along(&a, &b, hits.normal), least_separation(&hits), 1e-9 * size,
                     0);
        check_points_are_in_both(&a, &b, &hits);
        proven += truth.high - truth.low < 1e-9 * size;
    }
    assert_true(proven > POSES / 2);
}

/* A cap whose rim comes down on the edge of another cylinder, so that all of the cap is as far
 * along the normal as the one point where they meet. */
static void test_side_that_touches_a_cap_at_one_point_of_its_rim_has_that_point(void **state)
{
    (void)state;
    check_random random = {12};
    for (int i = 0; i < 1000; ++i) {
        body a = cylinder(check_uniform(&random, 0.1, 1), check_uniform(&random, 0.1, 1));
        body b = cylinder(check_uniform(&random, 0.1, 1), check_uniform(&random, 0.1, 1));
        pe_quat lying = about(pe_v3(1, 0, 0), 1.5707963267948966);
        place(&b,
              pe_v3(0, a.shape.radius + b.shape.half_height, a.shape.half_height + b.shape.radius),
              lying);
        turn_both(&a, &b, &random);
        pe_hits hits;
        collide_convex(of(&a), of(&b), 1e-2, &hits);
        assert_close(least_separation(&hits), 0, 1e-14, 0);
        check_points_are_in_both(&a, &b, &hits);
    }
}

/* A prism along z, of a convex outline counter-clockwise. */
static pe_geometry *make_prism(const double (*outline)[2], int count, double half_height)
{
    enum { MOST = 6 };
    pe_vec3 vertices[2 * MOST];
    uint32_t triangles[4 * MOST][3], n = (uint32_t)count, triangle_count = 0;
    for (uint32_t i = 0; i < n; ++i) {
        vertices[i] = pe_v3(outline[i][0], outline[i][1], -half_height);
        vertices[n + i] = pe_v3(outline[i][0], outline[i][1], half_height);
        uint32_t next = (i + 1) % n;
        const uint32_t of_corner[4][3] = {
            {i, next, n + next}, {i, n + next, n + i}, {0, next, i}, {n, n + i, n + next}};
        for (int k = 0; k < (i > 0 && next > 0 ? 4 : 2); ++k, ++triangle_count) {
            memcpy(triangles[triangle_count], of_corner[k], sizeof of_corner[k]);
        }
    }
    const pe_geometry_def def = {vertices, (const uint32_t(*)[3])triangles, (int)(2 * n),
                                 (int)triangle_count, true};
    pe_allocator allocator = pe_allocator_default();
    pe_geometry *geometry;
    assert_int_equal(pe_geometry_make(&def, &allocator, &geometry, NULL), PE_OK);
    return geometry;
}

/* Puts a hull so that the axes it was given in are the world's. */
static body hull_of(const pe_geometry *geometry)
{
    body b = {.shape = {.kind = PE_SHAPE_HULL}};
    place(&b, geometry->frame.centre, geometry->frame.orientation);
    return b;
}

/* The edge and the line on the side meet in their ends only; the other end of the edge is as near
 * to the axis. */
static void test_edge_in_line_with_a_side_touches_it_at_the_end_they_share(void **state)
{
    (void)state;
    static const double hexagon[6][2] = {{1, 0},  {0.5, 0.4},   {-0.5, 0.4},
                                         {-1, 0}, {-0.5, -0.4}, {0.5, -0.4}};
    pe_geometry *geometry = make_prism(hexagon, 6, 0.2);
    check_random random = {13};
    for (int i = 0; i < 1000; ++i) {
        body hull = hull_of(geometry);
        body b = cylinder(check_uniform(&random, 0.1, 1), check_uniform(&random, 0.1, 0.3));
        double way = i % 2 == 0 ? 1 : -1, aside = b.shape.radius * sqrt(0.5);
        pe_vec3 end = pe_v3(way * 0.5, 0.4, 0.2);
        pe_vec3 centre = pe_add(end, pe_v3(way * b.shape.half_height, aside, aside));
        place(&b, pe_add(centre, random_vector(&random, 4e-16)),
              about(pe_v3(0, 1, 0), 1.5707963267948966));
        pe_hits hits;
        collide_convex((pe_placed){&hull.shape, geometry, &hull.pose, geometry->size}, of(&b), 1e-2,
                       &hits);
        assert_true(hits.count > 0);
        for (int k = 0; k < hits.count; ++k) {
            assert_close(hits.item[k].separation, 0, 1e-14, 0);
            assert_at_most(pe_length(pe_sub(hits.item[k].position, end)), 1e-8);
        }
    }
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_free(geometry, &allocator);
}

/* A point of the rim falls on a sharp corner of the face. */
static void test_cap_with_a_corner_on_its_rim_keeps_its_features_while_it_sways(void **state)
{
    (void)state;
    static const double wedge[3][2] = {{0.6, 0}, {-0.3, 0.2}, {-0.3, -0.2}};
    pe_geometry *geometry = make_prism(wedge, 3, 0.2);
    body hull = hull_of(geometry);
    check_random random = {14};
    pe_vec3 across[2];
    pe_tangents(pe_unrotate(&hull.pose.rotation, pe_v3(0, 0, 1)), &across[0], &across[1]);
    for (int way = 0; way < 4; ++way) {
        pe_vec3 arm =
            pe_scale(way < 2 ? 0.5 : -0.5, pe_rotate(&hull.pose.rotation, across[way % 2]));
        if (arm.x < -0.4) {
            continue; /* the cap is beside the face */
        }
        pe_hits first = {0}, hits;
        for (int i = 0; i < 300; ++i) {
            body b = cylinder(0.5, 0.4);
            pe_vec3 sway = i == 0 ? pe_v3(0, 0, 0) : random_vector(&random, 2e-10);
            place(&b, pe_add(pe_sub(pe_v3(0.6, 0, 0.6), arm), sway),
                  (pe_quat){1, 0.2 * sway.y, 0.2 * sway.z, 0});
            collide_convex((pe_placed){&hull.shape, geometry, &hull.pose, geometry->size}, of(&b),
                           1e-2, &hits);
            first = i == 0 ? hits : first;
            assert_int_equal(hits.count, first.count);
            for (int k = 0; k < hits.count; ++k) {
                assert_true(has_feature(&first, hits.item[k].feature));
            }
        }
    }
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_free(geometry, &allocator);
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
        cmocka_unit_test(test_nearly_tangent_rims_of_nearly_parallel_cylinders_equal_the_truth),
        cmocka_unit_test(test_side_that_touches_a_cap_at_one_point_of_its_rim_has_that_point),
        cmocka_unit_test(test_edge_in_line_with_a_side_touches_it_at_the_end_they_share),
        cmocka_unit_test(test_cap_with_a_corner_on_its_rim_keeps_its_features_while_it_sways),
    };
    return cmocka_run_group_tests_name("engine_collide_cylinder", tests, NULL, NULL);
}
