#include "shape_pairs_laws.h"

#include "mesh_truth.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct patches {
    int count;
    pe_hits item[PE_MAX_PATCHES];
} patches;

/* One pose, and what was wrong with it. */
typedef struct trial {
    const shape_pool *pool;
    pair pair;
    pair_pose pose;
    check_random random;
    double tolerance; /* m: 1e-9 of the size, and rounding of the lengths that were added */
    const char *what;
    double found, expected;
    int skipped; /* of all trials so far: where the law says nothing */
} trial;

/* Returns whether it holds. */
typedef bool law(trial *t);

static bool fails(trial *t, const char *what, double found, double expected)
{
    t->what = what;
    t->found = found;
    t->expected = expected;
    return false;
}

static bool is_near(trial *t, const char *what, double found, double expected, double within)
{
    return fabs(found - expected) <= within || fails(t, what, found, expected);
}

static bool skips(trial *t)
{
    t->skipped += 1;
    return true;
}

/* ---- Asking the engine */

static patches collide(const placed *a, const placed *b, double margin)
{
    pe_allocator allocator = pe_allocator_default();
    pe_arena arena = {0};
    patches found;
    found.count = pe_collide(as_placed(a), as_placed(b), margin, (pe_workspace){&arena, &allocator},
                             found.item);
    pe_arena_free(&arena, &allocator);
    assert_true(found.count >= 0);
    return found;
}

/* The deepest point, NULL when there is none; *normal is that of its patch. */
static const pe_hit *deepest_of(const patches *found, pe_vec3 *normal)
{
    const pe_hit *least = NULL;
    for (int i = 0; i < found->count && i < PE_MAX_PATCHES; ++i) {
        for (int j = 0; j < found->item[i].count && j < PE_MAX_POINTS; ++j) {
            const pe_hit *hit = &found->item[i].item[j];
            if (least == NULL || !(hit->separation >= least->separation)) {
                least = hit;
                *normal = found->item[i].normal;
            }
        }
    }
    return least;
}

/* A margin that any pair of these is within. */
static double wide(const pair *p)
{
    double between = p->a.shape.kind == PE_SHAPE_PLANE
                         ? fabs(pe_dot(p->a.shape.normal, p->b.pose.position) - p->a.shape.offset)
                         : pe_length(pe_sub(p->b.pose.position, p->a.pose.position));
    return between + p->size;
}

/* The signed distance as the engine has it. */
static double engine_gap(const pair *p, pe_vec3 *normal)
{
    *normal = pe_v3(0, 0, 1);
    patches found = collide(&p->a, &p->b, wide(p));
    const pe_hit *hit = deepest_of(&found, normal);
    return hit != NULL ? hit->separation : 0;
}

static double true_gap(const pair *p, pe_vec3 *normal)
{
    truth_distance d = pair_truth(p, 1e-12 * p->size);
    *normal = d.normal;
    return d.low;
}

/* The deepest point at a wide margin; fails without. */
static bool ask(trial *t, patches *found, const pe_hit **hit, pe_vec3 *normal)
{
    *found = collide(&t->pair.a, &t->pair.b, wide(&t->pair));
    *hit = deepest_of(found, normal);
    if (*hit == NULL) {
        return fails(t, "points within a wide margin", 0, 1);
    }
    return isfinite((*hit)->separation) || fails(t, "finite", (*hit)->separation, 0);
}

/* ---- Running laws */

typedef enum law_kinds { LAW_CONVEX = 1, LAW_MESH = 2, LAW_ALL = 3 } law_kinds;

static const char *const kind_names[] = {"plane",    "sphere", "box", "capsule",
                                         "cylinder", "hull",   "mesh"};
static const char *const pose_names[] = {"any",   "deep", "shallow", "touching",
                                         "close", "far",  "aligned", "concentric"};

/* Each pose can be made again by itself. */
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

/* Returns how many poses of the pair of kinds fail. */
static int run_pair(trial *t, law *holds, pe_shape_kind a, pe_shape_kind b, int poses,
                    pair_gap *gap)
{
    int failures = 0, by_pose[POSE_COUNT] = {0};
    for (int i = 0; i < poses; ++i) {
        t->random.state = seed_of(a, b, i);
        t->pose = (pair_pose)(i % POSE_COUNT);
        t->pair = random_pair(t->pool, a, b, t->pose, &t->random, gap);
        t->tolerance = 1e-9 * t->pair.size +
                       64 * DBL_EPSILON *
                           (wide(&t->pair) + t->pair.a.solid->reach + t->pair.b.solid->reach + 5);
        if (!holds(t)) {
            failures += 1;
            by_pose[t->pose] += 1;
            if (by_pose[t->pose] == 1) {
                report(t, i);
            }
        }
    }
    if (failures > 0) {
        print_error("%s x %s: %d of %d poses fail:", kind_names[a], kind_names[b], failures, poses);
        for (int i = 0; i < POSE_COUNT; ++i) {
            print_error(" %s %d", pose_names[i], by_pose[i]);
        }
        print_error("\n");
    }
    return failures;
}

/* Whether the environment asks for this pair of kinds, as in PLUMB_TEST_PAIR="box x hull", or for
 * none. */
static bool is_asked_for(int a, int b)
{
    const char *wanted = getenv("PLUMB_TEST_PAIR");
    char name[32];
    snprintf(name, sizeof name, "%s x %s", kind_names[a], kind_names[b]);
    return wanted == NULL || strcmp(wanted, name) == 0;
}

/* Over all pairs of kinds; returns the share of trials that the law says nothing of. */
static double run_law(law *holds, law_kinds kinds, int poses, pair_gap *gap)
{
    trial t = {.pool = shape_pool_create(2024)};
    assert_non_null(t.pool);
    int failures = 0, trials = 0;
    for (int a = 0; a < PE_SHAPE_COUNT; ++a) {
        for (int b = a; b < PE_SHAPE_COUNT; ++b) {
            bool mesh = b == PE_SHAPE_MESH;
            if (b > PE_SHAPE_PLANE && is_asked_for(a, b) &&
                (kinds & (mesh ? LAW_MESH : LAW_CONVEX)) != 0) {
                failures += run_pair(&t, holds, (pe_shape_kind)a, (pe_shape_kind)b, poses, gap);
                trials += poses;
            }
        }
    }
    shape_pool_destroy((shape_pool *)t.pool);
    assert_int_equal(failures, 0);
    return trials > 0 ? (double)t.skipped / trials : 0;
}

/* ---- Truth */

static bool equals_the_truth(trial *t)
{
    patches found;
    const pe_hit *hit;
    pe_vec3 normal;
    if (!ask(t, &found, &hit, &normal)) {
        return false;
    }
    /* The answer's normal proves a lower bound of the signed distance, whatever the truth finds. */
    double along = pair_separation_along(&t->pair, normal);
    if (!is_near(t, "separation along the normal", along, hit->separation, t->tolerance)) {
        return false;
    }
    truth_distance truth = pair_truth(&t->pair, 0.1 * t->tolerance);
    if (hit->separation < truth.low - t->tolerance) {
        return fails(t, "least separation, too deep", hit->separation, truth.low);
    }
    if (hit->separation > truth.high + t->tolerance) {
        return fails(t, "least separation, too shallow", hit->separation, truth.high);
    }
    return truth.high - truth.low <= t->tolerance || skips(t);
}

void test_depth_and_normal_equal_the_truth(void **state)
{
    const law_budget *budget = *state;
    double unproven = run_law(equals_the_truth, LAW_CONVEX, budget->truth_poses, true_gap);
    /* Directions that tie along a circle are too many to bound to the tolerance. */
    assert_at_most(unproven, 0.02);
}

static bool equals_brute_force(trial *t)
{
    patches found;
    const pe_hit *hit;
    pe_vec3 normal;
    double distance = mesh_distance(&t->pair);
    if (!ask(t, &found, &hit, &normal)) {
        return false;
    }
    if (distance == 0) {
        return hit->separation <= t->tolerance ||
               fails(t, "separation where solids overlap", hit->separation, 0);
    }
    /* That near, which is which is a matter of rounding. */
    return distance <= t->tolerance
               ? hit->separation <= 2 * t->tolerance ||
                     fails(t, "touching", hit->separation, distance)
               : is_near(t, "least separation", hit->separation, distance, t->tolerance);
}

void test_distance_to_a_mesh_equals_brute_force(void **state)
{
    const law_budget *budget = *state;
    run_law(equals_brute_force, LAW_MESH, budget->truth_poses, engine_gap);
}

static bool is_as_deep_as_the_hull(trial *t)
{
    if (!t->pair.b.solid->convex || !t->pair.a.solid->convex) {
        return true;
    }
    pe_vec3 n;
    double gap = true_gap(&t->pair, &n);
    pair_part(&t->pair, -1e-3 * t->pair.size * check_uniform(&t->random, 0, 1) - gap, n);
    return equals_the_truth(t);
}

void test_shallow_depth_of_a_convex_mesh_equals_that_of_the_hull(void **state)
{
    const law_budget *budget = *state;
    run_law(is_as_deep_as_the_hull, LAW_MESH, budget->truth_poses, true_gap);
}

/* ---- Points */

static bool has_features_named_once(trial *t, const patches *found)
{
    uint64_t seen[PE_MAX_PATCHES * PE_MAX_POINTS];
    int count = 0;
    for (int i = 0; i < found->count; ++i) {
        for (int j = 0; j < found->item[i].count; ++j) {
            seen[count] = found->item[i].item[j].feature;
            for (int k = 0; k < count; ++k) {
                if (seen[k] == seen[count]) {
                    return fails(t, "feature named twice, point", count, k);
                }
            }
            count += 1;
        }
    }
    return true;
}

static double off_the_solid(const placed *p, pe_vec3 x)
{
    if (p->solid->convex) {
        return outside(p, x);
    }
    return is_in_polyhedron(p, x) ? 0 : surface_distance(p, x);
}

static bool is_point_sound(trial *t, const pe_hits *patch, const pe_hit *hit, double margin)
{
    if (!pe_is_finite(hit->position) || !isfinite(hit->separation)) {
        return fails(t, "finite point", hit->separation, 0);
    }
    if (hit->separation > margin) {
        return fails(t, "separation beyond the margin", hit->separation, margin);
    }
    pe_vec3 on_a = pe_madd(hit->position, -0.5 * hit->separation, patch->normal);
    pe_vec3 on_b = pe_madd(hit->position, 0.5 * hit->separation, patch->normal);
    /* Corners a hundred-millionth beside a face count as on it, so that flush sides do not make
     * them come and go. */
    double within = t->tolerance + 1e-8 * t->pair.size;
    return is_near(t, "point of a outside it by", off_the_solid(&t->pair.a, on_a), 0, within) &&
           is_near(t, "point of b outside it by", off_the_solid(&t->pair.b, on_b), 0, within);
}

static bool has_sound_points(trial *t)
{
    pe_vec3 normal;
    double gap = engine_gap(&t->pair, &normal);
    double margin = pe_max(0, gap) + t->pair.size * check_uniform(&t->random, 0, 0.2);
    patches found = collide(&t->pair.a, &t->pair.b, margin);
    if (found.count < 1 || found.count > PE_MAX_PATCHES) {
        return fails(t, "patches", found.count, 1);
    }
    for (int i = 0; i < found.count; ++i) {
        const pe_hits *patch = &found.item[i];
        if (patch->count < 1 || patch->count > PE_MAX_POINTS) {
            return fails(t, "points of a patch", patch->count, 1);
        }
        if (!is_near(t, "length of the normal", pe_length(patch->normal), 1, 1e-12)) {
            return false;
        }
        for (int j = 0; j < patch->count; ++j) {
            if (!is_point_sound(t, patch, &patch->item[j], margin)) {
                return false;
            }
        }
    }
    return has_features_named_once(t, &found);
}

void test_points_lie_in_both_shapes_a_separation_apart(void **state)
{
    const law_budget *budget = *state;
    run_law(has_sound_points, LAW_ALL, budget->poses, engine_gap);
}

/* ---- Symmetry */

/* The deepest point of another call is as deep, and its normal is as good where it is not the same:
 * directions that tie may be chosen either way. */
static bool is_the_same(trial *t, const patches *other, double separation, pe_vec3 normal,
                        pe_vec3 other_normal, double within)
{
    pe_vec3 unused;
    const pe_hit *hit = deepest_of(other, &unused);
    if (hit == NULL) {
        return fails(t, "points", 0, 1);
    }
    if (!is_near(t, "least separation", hit->separation, separation, within)) {
        return false;
    }
    bool convex = t->pair.a.solid->convex && t->pair.b.solid->convex;
    double turned = pe_length(pe_sub(normal, other_normal));
    return turned <= 1e-9 || !convex || t->pair.b.shape.kind == PE_SHAPE_MESH ||
           is_near(t, "separation along the other normal",
                   pair_separation_along(&t->pair, other_normal), separation, 2 * within);
}

static bool is_symmetric(trial *t)
{
    patches one;
    const pe_hit *hit;
    pe_vec3 n, m = {0, 0, 1};
    if (!ask(t, &one, &hit, &n)) {
        return false;
    }
    patches two = collide(&t->pair.b, &t->pair.a, wide(&t->pair));
    deepest_of(&two, &m);
    return is_the_same(t, &two, hit->separation, n, pe_scale(-1, m), 2 * t->tolerance);
}

void test_swapping_the_shapes_turns_the_normal(void **state)
{
    const law_budget *budget = *state;
    run_law(is_symmetric, LAW_ALL, budget->poses / 2, engine_gap);
}

static bool moves_with_the_world(trial *t)
{
    patches one;
    const pe_hit *hit;
    pe_vec3 n, m = {0, 0, 1};
    if (!ask(t, &one, &hit, &n)) {
        return false;
    }
    pe_quat turn = random_turn(&t->random);
    double away = check_uniform(&t->random, 0, 1) < 0.5 ? 1 : 1e4;
    pair moved = pair_moved(&t->pair, turn, pe_scale(away, random_direction(&t->random)));
    patches two = collide(&moved.a, &moved.b, wide(&moved));
    deepest_of(&two, &m);
    pe_mat3 rotation = pe_matrix_of(turn);
    /* A position so far away is rounded to so much. */
    double within = 2 * t->tolerance + 32 * DBL_EPSILON * away;
    pe_vec3 back = pe_unrotate(&rotation, m);
    if (t->pair.a.shape.kind == PE_SHAPE_PLANE && pe_length(pe_sub(back, n)) <= 1e-12) {
        back = n;
    }
    return is_the_same(t, &two, hit->separation, n, back, within);
}

void test_contacts_move_with_the_world(void **state)
{
    const law_budget *budget = *state;
    run_law(moves_with_the_world, LAW_ALL, budget->poses / 2, engine_gap);
}

static bool scales(trial *t)
{
    patches one;
    const pe_hit *hit;
    pe_vec3 n, m = {0, 0, 1};
    if (!ask(t, &one, &hit, &n)) {
        return false;
    }
    double factor = check_uniform(&t->random, 0, 1) < 0.5 ? 0x1p-10 : 0x1p10;
    solid a, b;
    pair scaled = {.a = placed_scaled(&t->pair.a, factor, &a),
                   .b = placed_scaled(&t->pair.b, factor, &b),
                   .size = factor * t->pair.size};
    patches two = collide(&scaled.a, &scaled.b, wide(&scaled));
    const pe_hit *other = deepest_of(&two, &m);
    bool same = other != NULL ? is_near(t, "scaled separation", other->separation / factor,
                                        hit->separation, 2 * t->tolerance)
                              : fails(t, "scaled points", 0, 1);
    solid_clear(&a);
    solid_clear(&b);
    return same;
}

void test_contacts_scale_with_the_shapes(void **state)
{
    const law_budget *budget = *state;
    run_law(scales, LAW_ALL, budget->truth_poses / 4, engine_gap);
}

/* ---- Continuity */

static bool is_continuous(trial *t)
{
    patches one;
    const pe_hit *hit;
    pe_vec3 n, m = {0, 0, 1};
    if (!ask(t, &one, &hit, &n)) {
        return false;
    }
    if (t->pair.b.shape.kind == PE_SHAPE_MESH && hit->separation < -1e-2 * t->pair.size) {
        return skips(t); /* deep in a mesh another surface may be the nearest */
    }
    double step = 1e-6 * t->pair.size, angle = step / t->pair.b.solid->reach;
    pe_vec3 axis = pe_scale(0.5 * angle, random_direction(&t->random));
    placed b = t->pair.b;
    place(&b, pe_madd(b.pose.position, step, random_direction(&t->random)),
          pe_quat_product((pe_quat){1, axis.x, axis.y, axis.z}, b.pose.orientation));
    patches two = collide(&t->pair.a, &b, wide(&t->pair));
    const pe_hit *other = deepest_of(&two, &m);
    return other != NULL ? is_near(t, "separation after a motion of 1e-6", other->separation,
                                   hit->separation, 2.001 * step + 2 * t->tolerance)
                         : fails(t, "points after a motion of 1e-6", 0, 1);
}

void test_separation_is_continuous(void **state)
{
    const law_budget *budget = *state;
    run_law(is_continuous, LAW_ALL, budget->poses / 2, engine_gap);
}

/* ---- Margins */

static bool is_found_within_the_margin_alone(trial *t)
{
    patches found;
    const pe_hit *hit;
    pe_vec3 n;
    if (!ask(t, &found, &hit, &n)) {
        return false;
    }
    double gap = hit->separation;
    if (collide(&t->pair.a, &t->pair.b, pe_max(0, gap + 2 * t->tolerance)).count < 1) {
        return fails(t, "points within the margin", 0, 1);
    }
    return gap < 4 * t->tolerance ||
           is_near(t, "patches beyond the margin",
                   collide(&t->pair.a, &t->pair.b, gap - 2 * t->tolerance).count, 0, 0);
}

void test_a_pair_has_points_exactly_when_its_gap_is_within_the_margin(void **state)
{
    const law_budget *budget = *state;
    run_law(is_found_within_the_margin_alone, LAW_ALL, budget->poses / 2, engine_gap);
}

static bool are_same_points(const patches *one, const patches *two)
{
    bool same = one->count == two->count;
    for (int i = 0; same && i < one->count; ++i) {
        const pe_hits *p = &one->item[i], *q = &two->item[i];
        same = p->count == q->count && pe_length(pe_sub(p->normal, q->normal)) == 0;
        for (int j = 0; same && j < p->count; ++j) {
            const pe_hit *x = &p->item[j], *y = &q->item[j];
            same = x->feature == y->feature && x->separation == y->separation &&
                   pe_length(pe_sub(x->position, y->position)) == 0;
        }
    }
    return same;
}

static bool keeps_points_over_the_range(trial *t)
{
    pe_vec3 n;
    double gap = engine_gap(&t->pair, &n);
    double margin = pe_max(0, gap + t->pair.size * check_uniform(&t->random, 0, 0.2));
    patches found = collide(&t->pair.a, &t->pair.b, margin);
    if (found.count < 1) {
        return fails(t, "patches", found.count, 1);
    }
    double least = 0, end = 2 * margin + t->pair.size;
    for (int i = 0; i < found.count; ++i) {
        const pe_hits *patch = &found.item[i];
        if (!(patch->least_margin <= margin && margin < patch->end_margin)) {
            return fails(t, "margin within its own range", margin, patch->least_margin);
        }
        least = pe_max(least, patch->least_margin);
        end = pe_min(end, patch->end_margin);
    }
    for (int k = 0; k < 2; ++k) {
        double at = k == 0 ? least : check_uniform(&t->random, least, end);
        patches other = collide(&t->pair.a, &t->pair.b, at);
        if (at >= least && at < end && !are_same_points(&found, &other)) {
            return fails(t, "the same points at another margin of the range", at, margin);
        }
    }
    return true;
}

void test_points_are_the_same_at_every_margin_of_their_range(void **state)
{
    const law_budget *budget = *state;
    run_law(keeps_points_over_the_range, LAW_ALL, budget->poses / 2, engine_gap);
}

/* ---- Rest */

static bool has_feature(const patches *found, uint64_t feature)
{
    for (int i = 0; i < found->count; ++i) {
        for (int j = 0; j < found->item[i].count; ++j) {
            if (found->item[i].item[j].feature == feature) {
                return true;
            }
        }
    }
    return false;
}

static bool keeps_its_features(trial *t)
{
    const solid *a = t->pair.a.solid, *other = t->pair.b.solid;
    if (!(a->convex && other->convex) && a->size > 0) {
        return skips(t); /* what has hollows may not come to lie face to face */
    }
    pair_rest(&t->pair, &t->random, engine_gap);
    double margin = 1e-2 * t->pair.size;
    patches first = collide(&t->pair.a, &t->pair.b, margin);
    if (first.count < 1) {
        return fails(t, "patches", first.count, 1);
    }
    placed b = t->pair.b;
    for (int k = 0; k < 4; ++k) {
        double step = 1e-9 * t->pair.size;
        pe_vec3 axis = pe_scale(0.5 * step / b.solid->reach, random_direction(&t->random));
        place(&b, pe_madd(t->pair.b.pose.position, step, random_direction(&t->random)),
              pe_quat_product((pe_quat){1, axis.x, axis.y, axis.z}, t->pair.b.pose.orientation));
        patches now = collide(&t->pair.a, &b, margin);
        if (now.count != first.count) {
            return fails(t, "patches after a sway", now.count, first.count);
        }
        for (int i = 0; i < now.count; ++i) {
            const pe_hits *p = &first.item[i], *q = &now.item[i];
            if (p->count != q->count) {
                return fails(t, "points after a sway", q->count, p->count);
            }
            if (!is_near(t, "turn of the normal in a sway", pe_length(pe_sub(p->normal, q->normal)),
                         0, 1e-6)) {
                return false;
            }
            for (int j = 0; j < q->count; ++j) {
                if (!has_feature(&first, q->item[j].feature)) {
                    return fails(t, "new feature after a sway, point", j, -1);
                }
            }
        }
    }
    return true;
}

void test_features_stay_while_a_pair_at_rest_sways(void **state)
{
    const law_budget *budget = *state;
    run_law(keeps_its_features, LAW_ALL, budget->truth_poses / 4, engine_gap);
}
