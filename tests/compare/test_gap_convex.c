/* The gaps of convex shapes of all kinds, against sweeps of directions that use only the farthest
 * point of a shape, and against each other. */
#include "referee/geometry/gap.h"

#include "check.h"
#include "polyhedra.h"

#include <math.h>
#include <string.h>

enum { HULLS = 12 };

static const pl_shape_kind convex_kinds[] = {PL_SHAPE_SPHERE, PL_SHAPE_BOX, PL_SHAPE_CAPSULE,
                                             PL_SHAPE_CYLINDER, PL_SHAPE_HULL};
enum { KINDS = sizeof convex_kinds / sizeof convex_kinds[0] };

typedef struct pose_pair {
    pl_shape shape_a, shape_b;
    pl_placed_shape a, b;
} pose_pair;

/* Random shapes of the tests. */
typedef struct pool {
    pl_scene scene;
    check_random random;
    const pl_polyhedron *hulls[HULLS];
} pool;

static void fill_pool(pool *p, uint64_t seed)
{
    p->scene = pl_scene_default();
    p->random.state = seed;
    for (int i = 0; i < HULLS; ++i) {
        p->hulls[i] = random_hull(&p->scene, &p->random, 4 + 5 * i);
    }
}

static pl_shape random_shape(pool *p, pl_shape_kind kind)
{
    if (kind == PL_SHAPE_HULL) {
        return pl_shape_of(p->hulls[(int)check_uniform(&p->random, 0, HULLS)]);
    }
    pl_shape shape = {.kind = kind};
    shape.radius = check_uniform(&p->random, 0.1, 1);
    shape.half_height = check_uniform(&p->random, 0.1, 1);
    for (int k = 0; k < 3; ++k) {
        shape.half_extents[k] = check_uniform(&p->random, 0.1, 1);
    }
    return shape;
}

/* Fills *pair in place, because it contains pointers into itself. Coordinates of the centres are
 * within `reach`. */
static void place(pool *p, pose_pair *pair, pl_shape_kind a, pl_shape_kind b, double reach)
{
    memset(pair, 0, sizeof *pair);
    pair->shape_a = random_shape(p, a);
    pair->shape_b = random_shape(p, b);
    pair->a.shape = &pair->shape_a;
    pair->b.shape = &pair->shape_b;
    check_quaternion(&p->random, pair->a.orientation);
    check_quaternion(&p->random, pair->b.orientation);
    for (int k = 0; k < 3; ++k) {
        pair->a.position[k] = check_uniform(&p->random, -reach, reach);
        pair->b.position[k] = check_uniform(&p->random, -reach, reach);
    }
}

static double gap_of(const pl_placed_shape *a, const pl_placed_shape *b)
{
    double gap = nan("");
    assert_int_equal(pl_gap(a, b, HUGE_VAL, &gap), PL_OK);
    return gap;
}

/* ---- Sweeps of directions ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Columns: a body's axes in the world, of a unit quaternion. */
static void axes_of(const double q[4], double axis[3][3])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double m[3][3] = {
        {w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)},
        {2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)},
        {2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z}};
    memcpy(axis, m, sizeof m);
}

/* How far a shape reaches along a unit direction. */
static double reach_along(const pl_placed_shape *placed, const double (*axis)[3],
                          const double unit[3])
{
    const pl_shape *s = placed->shape;
    double d[3] = {dot(axis[0], unit), dot(axis[1], unit), dot(axis[2], unit)};
    double reach = 0;
    switch (s->kind) {
    case PL_SHAPE_SPHERE:
        reach = s->radius;
        break;
    case PL_SHAPE_BOX:
        for (int k = 0; k < 3; ++k) {
            reach += s->half_extents[k] * fabs(d[k]);
        }
        break;
    case PL_SHAPE_CAPSULE:
        reach = s->half_height * fabs(d[2]) + s->radius;
        break;
    case PL_SHAPE_CYLINDER:
        reach = s->half_height * fabs(d[2]) + s->radius * sqrt(d[0] * d[0] + d[1] * d[1]);
        break;
    default:
        reach = -HUGE_VAL;
        for (int i = 0; i < s->polyhedron->vertex_count; ++i) {
            reach = fmax(reach, dot(s->polyhedron->vertices[i], d));
        }
    }
    return dot(placed->position, unit) + reach;
}

typedef struct prepared {
    const pose_pair *pair;
    double axis_a[3][3], axis_b[3][3];
} prepared;

static prepared prepare(const pose_pair *pair)
{
    prepared p = {.pair = pair};
    axes_of(pair->a.orientation, p.axis_a);
    axes_of(pair->b.orientation, p.axis_b);
    return p;
}

/* How far b is beyond a along a unit direction: a lower bound of the gap. */
static double separation(const prepared *p, const double unit[3])
{
    const double back[3] = {-unit[0], -unit[1], -unit[2]};
    return -reach_along(&p->pair->b, (const double(*)[3])p->axis_b, back) -
           reach_along(&p->pair->a, (const double(*)[3])p->axis_a, unit);
}

/* The best of the directions unit + x u + y v over a square grid of half width `wide`. */
static double best_on_grid(const prepared *p, double unit[3], double wide)
{
    enum { STEPS = 10 };
    int least = fabs(unit[0]) < 0.6 ? 0 : 1;
    double u[3] = {0, 0, 0}, v[3], middle[3], best = separation(p, unit);
    u[(least + 1) % 3] = -unit[(least + 2) % 3];
    u[(least + 2) % 3] = unit[(least + 1) % 3];
    memcpy(middle, unit, sizeof middle);
    for (int k = 0; k < 3; ++k) {
        v[k] = unit[(k + 1) % 3] * u[(k + 2) % 3] - unit[(k + 2) % 3] * u[(k + 1) % 3];
    }
    for (int i = -STEPS; i <= STEPS; ++i) {
        for (int j = -STEPS; j <= STEPS; ++j) {
            double tried[3];
            for (int k = 0; k < 3; ++k) {
                tried[k] = middle[k] + wide / STEPS * (i * u[k] + j * v[k]);
            }
            double length = sqrt(dot(tried, tried));
            for (int k = 0; k < 3; ++k) {
                tried[k] /= length;
            }
            double there = separation(p, tried);
            if (there > best) {
                best = there;
                memcpy(unit, tried, sizeof tried);
            }
        }
    }
    return best;
}

/* The best direction near `start`, by grids that follow it until they find no better, and then are
 * finer. */
static double refined(const prepared *p, const double start[3])
{
    double unit[3] = {start[0], start[1], start[2]}, best = separation(p, unit);
    for (double wide = 0.04; wide > 1e-8; wide *= 0.7) {
        for (double before = -HUGE_VAL; best > before + 1e-14;) {
            before = best;
            best = best_on_grid(p, unit, wide);
        }
    }
    return best;
}

/* The largest separation over a Fibonacci spiral of directions, the best of them refined. The gap
 * lies above it by the resolution of the refinement at most. */
static double swept(const pose_pair *pair)
{
    enum { SWEEP = 3000, REFINED = 8 };
    static double unit[SWEEP][3], found[SWEEP];
    prepared p = prepare(pair);
    for (int i = 0; i < SWEEP; ++i) {
        check_spiral_direction(i, SWEEP, unit[i]);
        found[i] = separation(&p, unit[i]);
    }
    double best = -HUGE_VAL;
    for (int n = 0; n < REFINED; ++n) {
        int most = 0;
        for (int i = 1; i < SWEEP; ++i) {
            most = found[i] > found[most] ? i : most;
        }
        best = fmax(best, refined(&p, unit[most]));
        /* The next start is elsewhere. */
        for (int i = 0; i < SWEEP; ++i) {
            found[i] = dot(unit[i], unit[most]) > 0.98 ? -HUGE_VAL : found[i];
        }
    }
    return best;
}

/* The gap is the largest separation over all directions. */
static void test_gap_of_every_pair_equals_dense_direction_sweep(void **state)
{
    (void)state;
    static pool p;
    fill_pool(&p, UINT64_C(362436069));
    for (int i = 0; i < 3 * KINDS * KINDS; ++i) {
        static const double reach[] = {0.1, 0.5, 1};
        pose_pair pair;
        place(&p, &pair, convex_kinds[i % KINDS], convex_kinds[i / KINDS % KINDS],
              reach[i / (KINDS * KINDS) % 3]);
        double gap = gap_of(&pair.a, &pair.b), best = swept(&pair);
        if (gap > 0 && pair.shape_a.kind == PL_SHAPE_BOX && pair.shape_b.kind == PL_SHAPE_BOX) {
            assert_int_equal(pl_gap_convex(&pair.a, &pair.b, HUGE_VAL, &gap), PL_OK);
        }
        assert_at_most(best, gap + 1e-9);
        assert_at_most(gap, best + 1e-4); /* the error of the grids on a narrow ridge */
    }
    pl_scene_free(&p.scene);
}

/* Rotates a shape about the origin by `q` and moves it. */
static void move_all(pl_placed_shape *placed, const double q[4], const double by[3])
{
    double axis[3][3];
    const double *p = placed->position, o[4] = {placed->orientation[0], placed->orientation[1],
                                                placed->orientation[2], placed->orientation[3]};
    double moved[3];
    axes_of(q, axis);
    for (int k = 0; k < 3; ++k) {
        moved[k] = by[k] + axis[0][k] * p[0] + axis[1][k] * p[1] + axis[2][k] * p[2];
    }
    memcpy(placed->position, moved, sizeof moved);
    placed->orientation[0] = q[0] * o[0] - q[1] * o[1] - q[2] * o[2] - q[3] * o[3];
    placed->orientation[1] = q[0] * o[1] + q[1] * o[0] + q[2] * o[3] - q[3] * o[2];
    placed->orientation[2] = q[0] * o[2] - q[1] * o[3] + q[2] * o[0] + q[3] * o[1];
    placed->orientation[3] = q[0] * o[3] + q[1] * o[2] - q[2] * o[1] + q[3] * o[0];
}

/* Every third pair is aligned with the other on a grid of quarter steps, where everything is
 * degenerate. */
static void test_gap_is_independent_of_order_and_place(void **state)
{
    (void)state;
    static pool p;
    fill_pool(&p, UINT64_C(521288629));
    for (int i = 0; i < 200 * KINDS * KINDS; ++i) {
        pose_pair pair;
        double q[4], by[3];
        place(&p, &pair, convex_kinds[i % KINDS], convex_kinds[i / KINDS % KINDS],
              i % 2 == 0 ? 0.3 : 1.2);
        for (int k = 0; k < 3 && i % 3 == 0; ++k) {
            pair.a.position[k] = 0;
            pair.b.position[k] = 0.25 * floor(check_uniform(&p.random, -5, 6));
        }
        for (int k = 0; k < 4 && i % 3 == 0; ++k) {
            pair.a.orientation[k] = pair.b.orientation[k] = k == 0;
        }
        double gap = gap_of(&pair.a, &pair.b);
        if (gap > 0 && pair.shape_a.kind == PL_SHAPE_BOX && pair.shape_b.kind == PL_SHAPE_BOX) {
            continue; /* a lower bound, that rounding of parallel edges may raise */
        }
        assert_close(gap_of(&pair.b, &pair.a), gap, 1e-8, 0);
        check_quaternion(&p.random, q);
        for (int k = 0; k < 3; ++k) {
            by[k] = check_uniform(&p.random, -10, 10);
        }
        move_all(&pair.a, q, by);
        move_all(&pair.b, q, by);
        assert_close(gap_of(&pair.a, &pair.b), gap, 1e-7, 0);
    }
    pl_scene_free(&p.scene);
}

static void test_closed_forms_equal_gjk_and_epa(void **state)
{
    (void)state;
    static pool p;
    const pl_shape_kind kinds[][2] = {{PL_SHAPE_SPHERE, PL_SHAPE_CAPSULE},
                                      {PL_SHAPE_SPHERE, PL_SHAPE_CYLINDER},
                                      {PL_SHAPE_CAPSULE, PL_SHAPE_CAPSULE}};
    fill_pool(&p, UINT64_C(777));
    for (int i = 0; i < 3000; ++i) {
        pose_pair pair;
        double closed, other;
        place(&p, &pair, kinds[i % 3][0], kinds[i % 3][1], 1);
        assert_int_equal(pl_gap_closed_form(&pair.a, &pair.b, &closed), PL_OK);
        assert_int_equal(pl_gap_convex(&pair.a, &pair.b, HUGE_VAL, &other), PL_OK);
        assert_close(other, closed, 1e-7, 0);
    }
    pl_scene_free(&p.scene);
}

/* All directions around the axis are equivalent, and EPA's polytope never closes on the circle. */
static void test_coaxial_round_shapes_have_the_smaller_depth(void **state)
{
    (void)state;
    pose_pair p = {.shape_a = pl_shape_cylinder(0.5, 0.5), .shape_b = pl_shape_cylinder(0.25, 1)};
    p.a = (pl_placed_shape){.shape = &p.shape_a, .orientation = {1, 0, 0, 0}};
    p.b = (pl_placed_shape){.shape = &p.shape_b, .orientation = {1, 0, 0, 0}};
    for (int i = 0; i <= 30; ++i) {
        p.b.position[2] = 0.05 * i;
        double depth = fmin(0.75, 1.5 - 0.05 * i);
        p.shape_b = pl_shape_cylinder(0.25, 1);
        assert_close(gap_of(&p.a, &p.b), -depth, 1e-9, 0);
        p.shape_b = pl_shape_capsule(0.25, 0.75);
        assert_close(gap_of(&p.a, &p.b), -depth, 1e-9, 0);
    }
}

static void test_gap_above_the_bound_is_a_lower_bound(void **state)
{
    (void)state;
    static pool p;
    fill_pool(&p, UINT64_C(99));
    for (int i = 0; i < 50 * KINDS * KINDS; ++i) {
        pose_pair pair;
        double within = check_uniform(&p.random, -0.1, 0.5), bounded;
        place(&p, &pair, convex_kinds[i % KINDS], convex_kinds[i / KINDS % KINDS], 1);
        double gap = gap_of(&pair.a, &pair.b);
        assert_int_equal(pl_gap(&pair.a, &pair.b, within, &bounded), PL_OK);
        if (gap > within) {
            assert_true(bounded > within);
        } else {
            assert_close(bounded, gap, 1e-12, 0);
        }
    }
    pl_scene_free(&p.scene);
}

static void test_plane_gap_is_the_reach_against_its_normal(void **state)
{
    (void)state;
    static pool p;
    fill_pool(&p, UINT64_C(4242));
    for (int i = 0; i < 1000 * KINDS; ++i) {
        pose_pair pair;
        double axis[3][3], q[4];
        place(&p, &pair, convex_kinds[i % KINDS], PL_SHAPE_SPHERE, 1);
        check_quaternion(&p.random, q);
        axes_of(q, axis);
        pair.shape_b = pl_shape_plane(axis[0][0], axis[0][1], axis[0][2], 0.3);
        prepared ready = prepare(&pair);
        const double down[3] = {-axis[0][0], -axis[0][1], -axis[0][2]};
        double lowest = -reach_along(&pair.a, (const double(*)[3])ready.axis_a, down);
        assert_close(gap_of(&pair.a, &pair.b), lowest - 0.3, 1e-14, 0);
    }
    pl_scene_free(&p.scene);
}

/* Two wedges whose ridges cross: the lower one's lies at z = 0, the upper one's at z = height. The
 * frame of the upper one's vertices is in the middle of the ridge of the lower one, or at a random place
 * near it. */
static void place_wedges(pool *p, pose_pair *pair, double height, bool in_middle)
{
    pl_placed_shape *const placed[2] = {&pair->a, &pair->b};
    pl_shape *const shapes[2] = {&pair->shape_a, &pair->shape_b};
    for (int i = 0; i < 2; ++i) {
        const double up = i == 0 ? -1 : 1, turn = i * check_uniform(&p->random, 0.2, 2.9);
        double points[6][3];
        for (int k = 0; k < 6; ++k) {
            const double along = k % 2 == 0 ? -1 : 1, side = k < 2 ? 0.5 : -0.5;
            const double across = k < 4 ? side : 0;
            points[k][0] = cos(turn) * across - sin(turn) * along;
            points[k][1] = sin(turn) * across + cos(turn) * along;
            points[k][2] = k < 4 ? 3 * up : 0;
        }
        const pl_polyhedron *hull;
        assert_int_equal(
            pl_scene_add_hull(&p->scene, NULL, (const double(*)[3])points, 6, &hull, NULL), PL_OK);
        *shapes[i] = pl_shape_of(hull);
        placed[i]->shape = shapes[i];
        placed[i]->position[0] = in_middle ? 0 : i * check_uniform(&p->random, -0.1, 0.1);
        placed[i]->position[1] = in_middle ? 0 : i * check_uniform(&p->random, -0.5, 0.5);
        placed[i]->position[2] = i * height;
        placed[i]->orientation[0] = 1;
    }
}

static void test_crossing_edges_that_touch_have_a_gap(void **state)
{
    (void)state;
    pool p;
    fill_pool(&p, 23);
    for (int i = 0; i < 400; ++i) {
        static const double heights[] = {0,    1e-15, -1e-15, 1e-12, -1e-12,
                                         1e-9, -1e-9, 1e-6,   -1e-6, 1e-3};
        const double height = heights[i % 10];
        pose_pair pair;
        double gap = (double)NAN;
        memset(&pair, 0, sizeof pair);
        place_wedges(&p, &pair, height, i % 20 < 10);
        assert_int_equal(pl_gap(&pair.a, &pair.b, 1, &gap), PL_OK);
        assert_close(gap, height, 1e-9, 0);
    }
    pl_scene_free(&p.scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_crossing_edges_that_touch_have_a_gap),
        cmocka_unit_test(test_gap_of_every_pair_equals_dense_direction_sweep),
        cmocka_unit_test(test_gap_is_independent_of_order_and_place),
        cmocka_unit_test(test_closed_forms_equal_gjk_and_epa),
        cmocka_unit_test(test_coaxial_round_shapes_have_the_smaller_depth),
        cmocka_unit_test(test_gap_above_the_bound_is_a_lower_bound),
        cmocka_unit_test(test_plane_gap_is_the_reach_against_its_normal),
    };
    return cmocka_run_group_tests_name("gap convex", tests, NULL, NULL);
}
