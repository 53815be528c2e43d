/* The gaps of convex shapes of all kinds, against sweeps of directions that know of a shape no more
 * than its farthest point, and against nearest points found by brute force. */
#include "referee/gap.h"

#include "check.h"
#include "polyhedra.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HULLS = 12 };

static const pl_shape_kind convex_kinds[] = {PL_SHAPE_SPHERE, PL_SHAPE_BOX, PL_SHAPE_CAPSULE,
                                             PL_SHAPE_CYLINDER, PL_SHAPE_HULL};
enum { KINDS = sizeof convex_kinds / sizeof convex_kinds[0] };

typedef struct pose_pair {
    pl_shape shape_a, shape_b;
    pl_placed_shape a, b;
} pose_pair;

/* What the tests draw their shapes from. */
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
    pl_shape shape = {.kind = kind,
                      .radius = check_uniform(&p->random, 0.1, 1),
                      .half_height = check_uniform(&p->random, 0.1, 1)};
    for (int k = 0; k < 3; ++k) {
        shape.half_extents[k] = check_uniform(&p->random, 0.1, 1);
    }
    return shape;
}

/* Points back into *pair, so it fills in place. Centres within `reach` of the origin. */
static void place(pool *p, pose_pair *pair, pl_shape_kind a, pl_shape_kind b, double reach)
{
    *pair = (pose_pair){.shape_a = random_shape(p, a), .shape_b = random_shape(p, b)};
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

/* --- What the sweeps know --- */

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
static double reach_along(const pl_placed_shape *placed, const double axis[3][3],
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
    return -reach_along(&p->pair->b, p->axis_b, back) - reach_along(&p->pair->a, p->axis_a, unit);
}

/* The best direction near `unit` by ever smaller random turns. */
static double refined(const prepared *p, check_random *random, const double start[3])
{
    double unit[3] = {start[0], start[1], start[2]};
    double best = separation(p, unit), turn = 0.05;
    for (int failures = 0; turn > 1e-9;) {
        double tried[3];
        for (int k = 0; k < 3; ++k) {
            tried[k] = unit[k] + turn * check_uniform(random, -1, 1);
        }
        double length = sqrt(dot(tried, tried));
        for (int k = 0; k < 3; ++k) {
            tried[k] /= length;
        }
        double there = separation(p, tried);
        failures += 1;
        if (there > best) {
            best = there;
            failures = 0;
            memcpy(unit, tried, sizeof tried);
        } else if (failures > 60) {
            turn *= 0.6;
            failures = 0;
        }
    }
    return best;
}

/* The largest separation over a Fibonacci spiral of directions, the best of them refined. The gap
 * lies above it by the resolution of the refinement at most. */
static double swept(const pose_pair *pair, check_random *random)
{
    enum { SWEEP = 3000, REFINED = 6 };
    static double unit[SWEEP][3], found[SWEEP];
    const double golden = 2.399963229728653;
    prepared p = prepare(pair);
    for (int i = 0; i < SWEEP; ++i) {
        double z = 1 - (2 * i + 1.0) / SWEEP, r = sqrt(1 - z * z);
        unit[i][0] = r * cos(golden * i);
        unit[i][1] = r * sin(golden * i);
        unit[i][2] = z;
        found[i] = separation(&p, unit[i]);
    }
    double best = -HUGE_VAL;
    for (int n = 0; n < REFINED; ++n) {
        int most = 0;
        for (int i = 1; i < SWEEP; ++i) {
            most = found[i] > found[most] ? i : most;
        }
        best = fmax(best, refined(&p, random, unit[most]));
        /* The next one from elsewhere. */
        for (int i = 0; i < SWEEP; ++i) {
            found[i] = dot(unit[i], unit[most]) > 0.98 ? -HUGE_VAL : found[i];
        }
    }
    return best;
}

static void test_scratch(void **state)
{
    (void)state;
    static pool p;
    fill_pool(&p, 88172645463325252);
    for (int a = 0; a < KINDS; ++a) {
        for (int b = a; b < KINDS; ++b) {
            double above = 0, below = 0;
            int over = 0, fails = 0, n = 0;
            for (int i = 0; i < 60; ++i) {
                pose_pair pair;
                place(&p, &pair, convex_kinds[a], convex_kinds[b], i % 3 == 0 ? 0.1 : i % 3 == 1 ? 0.5 : 1.0);
                double gap;
                if (pl_gap(&pair.a, &pair.b, HUGE_VAL, &gap) != PL_OK) { fails++; continue; }
                double s = swept(&pair, &p.random);
                over += gap < 0;
                n++;
                if (gap > 0 && a == 1 && b == 1) continue;
                above = fmax(above, gap - s);
                below = fmax(below, s - gap);
            }
            printf("%d-%d n %d over %d fails %d gap-swept %.2e swept-gap %.2e\n", a, b, n, over, fails, above, below);
        }
    }
    pl_scene_free(&p.scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scratch),
    };
    return cmocka_run_group_tests_name("gap convex", tests, NULL, NULL);
}
