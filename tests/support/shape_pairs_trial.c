/* Running laws, and reports of the poses where they fail. */
#include "shape_pairs_trial.h"

#include "shape_pairs_known.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool fails(trial *t, const char *what, double found, double expected)
{
    t->what = what;
    t->found = found;
    t->expected = expected;
    return false;
}

bool is_near(trial *t, const char *what, double found, double expected, double within)
{
    return fabs(found - expected) <= within || fails(t, what, found, expected);
}

bool skips(trial *t)
{
    t->skipped += 1;
    return true;
}

/* ---- Asking the engine ---- */

manifolds collide(const placed *a, const placed *b, double margin)
{
    pe_allocator allocator = pe_allocator_default();
    pe_arena arena = {0};
    manifolds found;
    found.count = pe_collide(as_placed(a), as_placed(b), margin,
                             (pe_workspace){&arena, &allocator, NULL}, found.item);
    pe_arena_free(&arena, &allocator);
    assert_true(found.count >= 0);
    return found;
}

const pe_pair_point *deepest_of(const manifolds *found, pe_vec3 *normal)
{
    const pe_pair_point *least = NULL;
    for (int i = 0; i < found->count && i < PE_MAX_MANIFOLDS; ++i) {
        for (int j = 0; j < found->item[i].count && j < PE_MAX_POINTS; ++j) {
            const pe_pair_point *point = &found->item[i].item[j];
            if (least == NULL || !(point->separation >= least->separation)) {
                least = point;
                *normal = found->item[i].normal;
            }
        }
    }
    return least;
}

double wide(const pair *p)
{
    double between = p->a.shape.kind == PE_SHAPE_PLANE
                         ? fabs(pe_dot(p->a.shape.normal, p->b.pose.position) - p->a.shape.offset)
                         : pe_length(pe_sub(p->b.pose.position, p->a.pose.position));
    return between + p->a.solid->reach + p->b.solid->reach;
}

double engine_gap(const pair *p, pe_vec3 *normal)
{
    *normal = pe_v3(0, 0, 1);
    manifolds found = collide(&p->a, &p->b, wide(p));
    const pe_pair_point *point = deepest_of(&found, normal);
    return point != NULL ? point->separation : 0;
}

double true_gap(const pair *p, pe_vec3 *normal)
{
    truth_distance d = pair_truth(p, 1e-12 * p->size);
    *normal = d.normal;
    return d.low;
}

/* ---- Running laws ---- */

static const char *const kind_names[] = {"plane",    "sphere", "box", "capsule",
                                         "cylinder", "hull",   "mesh"};
static const char *const pose_names[] = {"any", "deep",    "shallow",    "touching", "close",
                                         "far", "aligned", "concentric", "ledge"};

/* Each pose can be reproduced alone. */
static uint64_t seed_of(pe_shape_kind a, pe_shape_kind b, int index)
{
    uint64_t s = 1 + (uint64_t)index + ((uint64_t)a << 40) + ((uint64_t)b << 48);
    s = (s ^ s >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    s = (s ^ s >> 27) * UINT64_C(0x94d049bb133111eb);
    return (s ^ s >> 31) | 1;
}

static void report(const trial *t, int index)
{
    const pair *p = &t->pair;
    print_error("%s x %s, pose %d (%s): %s: %.17g, expected %.17g, off by %.3g, tolerance %.3g\n",
                kind_names[p->a.shape.kind], kind_names[p->b.shape.kind], index,
                pose_names[t->pose], t->what, t->found, t->expected, t->found - t->expected,
                t->tolerance);
    pair_print(p);
}

/* Pairs that touch or surely overlap are tested at the margins of a simulation. */
static double margin_of(const trial *t)
{
    bool convex = t->pair.a.solid->convex && t->pair.b.solid->convex;
    bool inside = t->pose == POSE_DEEP || t->pose == POSE_CONCENTRIC;
    bool anywhere =
        t->pose == POSE_ANY || t->pose == POSE_FAR || (inside && !convex) || t->pose == POSE_LEDGE;
    return anywhere ? wide(&t->pair) : 0.2 * t->pair.size;
}

/* Whether the pair touches along parallel edges that meet: these may be a ten-thousandth of the size
 * apart or aside and still have one normal. The feature ids tell ends of a line. */
static bool meets_at_edges(const pair *p)
{
    const double reach = 1e-4 * p->size;
    const manifolds found = collide(&p->a, &p->b, reach);
    bool meets = false;
    for (int i = 0; found.count == 1 && i < found.item[0].count; ++i) {
        const pe_pair_point *point = &found.item[0].item[i];
        meets = meets || (point->feature >> 61 == 1 && point->separation >= -reach);
    }
    return meets && p->a.solid->convex && p->b.solid->convex && p->a.shape.radius == 0 &&
           p->b.shape.radius == 0 && p->a.shape.kind != PE_SHAPE_PLANE;
}

double tolerance_of(const pair *p)
{
    const double exact = 1e-9 * p->size + 64 * DBL_EPSILON * (wide(p) + 5);
    return meets_at_edges(p) ? pe_max(exact, 1e-4 * p->size) : exact;
}

void trial_set(trial *t)
{
    t->margin = margin_of(t);
    t->tolerance = tolerance_of(&t->pair);
}

typedef struct named_law {
    const char *name;
    law *holds;
    pair_gap *gap;
} named_law;

/* Returns how many poses of the pair of kinds fail, without those that are known to. */
static int run_pair(trial *t, const named_law *run, pe_shape_kind a, pe_shape_kind b, int poses)
{
    int failures = 0, by_pose[POSE_COUNT] = {0};
    for (int i = 0; i < poses; ++i) {
        t->random.state = seed_of(a, b, i);
        t->pose = (pair_pose)(i % POSE_COUNT);
        t->pair = random_pair(t->pool, a, b, t->pose, &t->random, run->gap);
        trial_set(t);
        if (!run->holds(t)) {
            failures += 1;
            by_pose[t->pose] += 1;
            if (by_pose[t->pose] == 1) {
                report(t, i);
            }
        }
    }
    int known = known_failures(run->name, a, b);
    if (failures > 0) {
        print_error("%s x %s: %d of %d poses fail, %d known:", kind_names[a], kind_names[b],
                    failures, poses, known);
        for (int i = 0; i < POSE_COUNT; ++i) {
            print_error(" %s %d", pose_names[i], by_pose[i]);
        }
        print_error("\n");
    }
    return failures > known ? failures - known : 0;
}

/* Whether the environment selects this pair of kinds, as in PLUMB_TEST_PAIR="box x hull". */
static bool is_asked_for(int a, int b)
{
    const char *wanted = getenv("PLUMB_TEST_PAIR");
    char name[32];
    snprintf(name, sizeof name, "%s x %s", kind_names[a], kind_names[b]);
    return wanted == NULL || strcmp(wanted, name) == 0;
}

double run_law(const char *name, law *holds, law_kinds kinds, law_count count, pair_gap *gap)
{
    trial t = {.pool = shape_pool_create(2024)};
    const named_law named = {name, holds, gap};
    assert_non_null(t.pool);
    int failures = 0;
    double skipped = 0;
    for (int a = 0; a < PE_SHAPE_COUNT; ++a) {
        for (int b = a; b < PE_SHAPE_COUNT; ++b) {
            bool mesh = b == PE_SHAPE_MESH;
            int poses = mesh ? count.mesh : count.convex;
            if (b > PE_SHAPE_PLANE && is_asked_for(a, b) && poses > 0 &&
                (kinds & (mesh ? LAW_MESH : LAW_CONVEX)) != 0) {
                t.skipped = 0;
                failures += run_pair(&t, &named, (pe_shape_kind)a, (pe_shape_kind)b, poses);
                skipped = pe_max(skipped, (double)t.skipped / poses);
            }
        }
    }
    shape_pool_destroy((shape_pool *)t.pool);
    assert_int_equal(failures, 0);
    return skipped;
}
