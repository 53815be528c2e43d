/* The laws of contact, each tested over poses of all pairs of kinds. */
#include "shape_pairs_laws.h"

#include "mesh_truth.h"
#include "narrow_phase/tolerances.h"
#include "shape_pairs_trial.h"

#include <float.h>

/* Of the size: a corner this far outside a face counts as on the face. */
static const double CLIP_SLACK = 1e-8;

/* A part of the poses of the budget. */
static law_count share(const law_budget *budget, int parts)
{
    return (law_count){budget->poses / parts, budget->mesh_poses / parts};
}

/* A part of those that are held against the truth. */
static law_count of_truth(const law_budget *budget, int parts)
{
    return (law_count){budget->truth_poses / parts, budget->mesh_truth_poses / parts};
}

/* The deepest point; fails without. */
static bool query(trial *t, manifolds *found, const pe_pair_point **point, pe_vec3 *normal)
{
    *found = collide(&t->pair.a, &t->pair.b, t->margin);
    *point = deepest_of(found, normal);
    if (*point == NULL) {
        return fails(t, "points within the margin", 0, 1);
    }
    return isfinite((*point)->separation) || fails(t, "finite", (*point)->separation, 0);
}

/* ---- Truth ---- */

static bool has_flat_faces(const placed *p)
{
    return p->shape.kind == PE_SHAPE_BOX || p->shape.kind == PE_SHAPE_HULL ||
           p->shape.kind == PE_SHAPE_MESH;
}

/* The largest true distance of a pair for which the engine reports this separation. The engine takes a
 * corner that lies beside a flat face by the slack for one on the face, and reports its height over the
 * face; its true distance is that from the rim of the face. */
static double most_distance(const trial *t, double separation)
{
    const bool clips = has_flat_faces(&t->pair.a) || has_flat_faces(&t->pair.b);
    const double beside = clips ? CLIP_SLACK * t->pair.size : 0;
    return separation > -beside ? hypot(pe_max(separation, 0), beside) : separation;
}

bool equals_the_truth(trial *t)
{
    manifolds found;
    const pe_pair_point *point;
    pe_vec3 normal;
    if (!query(t, &found, &point, &normal)) {
        return false;
    }
    /* The reported normal proves a lower bound of the signed distance. */
    double along = pair_separation_along(&t->pair, normal);
    if (!is_near(t, "separation along the normal", along, point->separation, t->tolerance)) {
        return false;
    }
    truth_distance truth = pair_truth(&t->pair, 0.1 * t->tolerance);
    if (most_distance(t, point->separation) < truth.low - t->tolerance) {
        return fails(t, "least separation, too deep", point->separation, truth.low);
    }
    if (point->separation > truth.high + t->tolerance) {
        return fails(t, "least separation, too shallow", point->separation, truth.high);
    }
    return truth.high - truth.low <= t->tolerance || skips(t);
}

/* Of convex shapes: the least separation is the signed distance, and so is the separation along the
 * normal that is reported. */
static void test_depth_and_normal_equal_the_truth(void **state)
{
    double unproven =
        run_law("equals_the_truth", equals_the_truth, LAW_CONVEX, of_truth(*state, 1), true_gap);
    /* Directions that nearly tie along a circle are too many to bound to the tolerance. */
    assert_at_most(unproven, 0.1);
}

bool equals_brute_force(trial *t)
{
    manifolds found;
    const pe_pair_point *point;
    pe_vec3 normal;
    mesh_interval distance = mesh_distance(&t->pair);
    if (!query(t, &found, &point, &normal)) {
        return false;
    }
    if (distance.high == 0 && point->separation > t->tolerance) {
        return fails(t, "separation where solids overlap", point->separation, 0);
    }
    if (point->separation > distance.high + t->tolerance) {
        return fails(t, "least separation, too large", point->separation, distance.high);
    }
    /* This near, rounding decides whether they overlap. */
    return distance.low <= t->tolerance ||
           most_distance(t, point->separation) >= distance.low - t->tolerance ||
           fails(t, "least separation, too small", point->separation, distance.low);
}

/* Of meshes: apart, the least separation is the distance; overlapping, it is not above 0. */
static void test_distance_to_a_mesh_equals_brute_force(void **state)
{
    run_law("equals_brute_force", equals_brute_force, LAW_MESH, of_truth(*state, 1), engine_gap);
}

static bool is_as_deep_as_the_hull(trial *t)
{
    if (!t->pair.b.solid->convex || !t->pair.a.solid->convex) {
        return true;
    }
    pe_vec3 n;
    double gap = true_gap(&t->pair, &n);
    pair_part(&t->pair, -1e-3 * t->pair.size * check_uniform(&t->random, 0, 1) - gap, n);
    t->tolerance = tolerance_of(&t->pair); /* there edges may meet */
    return equals_the_truth(t);
}

/* A convex mesh that overlaps by up to 1e-3 of the size is as deep as the hull. */
static void test_shallow_depth_of_convex_mesh_equals_hull(void **state)
{
    run_law("is_as_deep_as_the_hull", is_as_deep_as_the_hull, LAW_MESH, of_truth(*state, 1),
            true_gap);
}

/* ---- Points ---- */

static bool has_unique_features(trial *t, const manifolds *found)
{
    uint64_t seen[PE_MAX_MANIFOLDS * PE_MAX_POINTS];
    int count = 0;
    for (int i = 0; i < found->count; ++i) {
        for (int j = 0; j < found->item[i].count; ++j) {
            seen[count] = found->item[i].item[j].feature;
            for (int k = 0; k < count; ++k) {
                if (seen[k] == seen[count]) {
                    return fails(t, "feature id used twice, point", count, k);
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

static bool is_point_sound(trial *t, const pe_pair_manifold *manifold, const pe_pair_point *point,
                           double margin)
{
    if (!pe_is_finite(point->position) || !isfinite(point->separation)) {
        return fails(t, "finite point", point->separation, 0);
    }
    if (point->separation > margin) {
        return fails(t, "separation beyond the margin", point->separation, margin);
    }
    pe_vec3 on_a = pe_madd(point->position, -0.5 * point->separation, manifold->normal);
    pe_vec3 on_b = pe_madd(point->position, 0.5 * point->separation, manifold->normal);
    double within = t->tolerance + CLIP_SLACK * t->pair.size;
    /* Across the normal, the nearest points are only known to this accuracy: a shift by it changes
     * their distance by rounding. */
    within += sqrt(2 * pe_max(0, point->separation) * DBL_EPSILON * (wide(&t->pair) + 5));
    if (t->pair.b.shape.kind == PE_SHAPE_MESH) {
        /* A touch that shares another's manifold is seen along that one's normal, and its point on a face
         * moves along the face. */
        within += PE_ONE_NORMAL * fabs(point->separation);
    }
    return is_near(t, "point of a outside it by", off_the_solid(&t->pair.a, on_a), 0, within) &&
           is_near(t, "point of b outside it by", off_the_solid(&t->pair.b, on_b), 0, within);
}

bool has_sound_points(trial *t)
{
    double margin = t->margin * check_uniform(&t->random, 0.5, 1);
    manifolds found = collide(&t->pair.a, &t->pair.b, margin);
    if (found.count < 0 || found.count > PE_MAX_MANIFOLDS) {
        return fails(t, "manifolds", found.count, 1);
    }
    for (int i = 0; i < found.count; ++i) {
        const pe_pair_manifold *manifold = &found.item[i];
        if (manifold->count < 1 || manifold->count > PE_MAX_POINTS) {
            return fails(t, "points of a manifold", manifold->count, 1);
        }
        if (!is_near(t, "length of the normal", pe_length(manifold->normal), 1, 1e-12)) {
            return false;
        }
        for (int j = 0; j < manifold->count; ++j) {
            if (!is_point_sound(t, manifold, &manifold->item[j], margin)) {
                return false;
            }
        }
    }
    return has_unique_features(t, &found);
}

/* Numbers are finite, the normal is a unit vector, the points are not too many, feature ids are
 * unique, and the point on either surface, half the separation along the normal, lies in that
 * shape. */
static void test_points_lie_in_both_shapes(void **state)
{
    run_law("has_sound_points", has_sound_points, LAW_ALL, share(*state, 1), engine_gap);
}

/* ---- Symmetry ---- */

/* b moved by `step` and turned so that no point of it moves farther. */
static placed moved_a_little(trial *t, double step)
{
    placed b = t->pair.b;
    pe_vec3 by = pe_scale(step, random_direction(&t->random));
    pe_vec3 turn = pe_scale(0.5 * step / b.solid->reach, random_direction(&t->random));
    place(&b, pe_add(b.pose.position, by),
          pe_quat_product((pe_quat){1, turn.x, turn.y, turn.z}, b.pose.orientation));
    return b;
}

/* Whether some pose within the slack of the pair's, 1e-8 of the size, has this separation. The
 * depth of an overlap with a hollow solid jumps between poses. At a jump either value is right. */
static bool jumps_to(trial *t, double separation, double within)
{
    enum { TRIES = 200 };
    bool found = false;
    for (int i = 0; i < TRIES && !found; ++i) {
        double step = 1e-8 * t->pair.size * pow(10, check_uniform(&t->random, -5, 0));
        placed b = moved_a_little(t, step);
        pe_vec3 n;
        manifolds near = collide(&t->pair.a, &b, t->margin);
        const pe_pair_point *point = deepest_of(&near, &n);
        found = point != NULL && fabs(point->separation - separation) <= within + 2 * step;
    }
    return found;
}

static bool is_hollow(const pair *p)
{
    return !(p->a.solid->convex && p->b.solid->convex);
}

/* The deepest point of another call is as deep, and its normal separates as much: of directions
 * that tie either may be chosen. */
static bool is_the_same(trial *t, const manifolds *other, double separation, pe_vec3 normal,
                        pe_vec3 other_normal, double within)
{
    pe_vec3 unused;
    const pe_pair_point *point = deepest_of(other, &unused);
    if (point == NULL) {
        return fails(t, "points", 0, 1);
    }
    /* Solids with hollows that overlap by more than the size have several ways out, and any may be
     * chosen. */
    if (is_hollow(&t->pair) && pe_max(point->separation, separation) < -t->pair.size) {
        return true;
    }
    if (!is_near(t, "least separation", point->separation, separation, within)) {
        return is_hollow(&t->pair) && jumps_to(t, point->separation, within);
    }
    /* Of meshes that overlap more than a little, depth is not the minimum translation: see
     * mesh_contact.c. */
    bool deep = t->pair.b.shape.kind == PE_SHAPE_MESH && separation < -1e-3 * t->pair.size;
    double turned = pe_length(pe_sub(normal, other_normal));
    return turned <= 1e-9 || is_hollow(&t->pair) || deep ||
           is_near(t, "separation along the other normal",
                   pair_separation_along(&t->pair, other_normal), separation, 2 * within);
}

bool is_symmetric(trial *t)
{
    manifolds one;
    const pe_pair_point *point;
    pe_vec3 n, m = {0, 0, 1};
    if (!query(t, &one, &point, &n)) {
        return false;
    }
    manifolds two = collide(&t->pair.b, &t->pair.a, t->margin);
    deepest_of(&two, &m);
    return is_the_same(t, &two, point->separation, n, pe_scale(-1, m), 2 * t->tolerance);
}

static void test_swapping_the_shapes_turns_the_normal(void **state)
{
    run_law("is_symmetric", is_symmetric, LAW_ALL, share(*state, 4), engine_gap);
}

static bool moves_with_the_world(trial *t)
{
    manifolds one;
    const pe_pair_point *point;
    pe_vec3 n, m = {0, 0, 1};
    if (!query(t, &one, &point, &n)) {
        return false;
    }
    pe_quat turn = random_turn(&t->random);
    double away = check_uniform(&t->random, 0, 1) < 0.5 ? 1 : 1e4;
    pair moved = pair_moved(&t->pair, turn, pe_scale(away, random_direction(&t->random)));
    manifolds two = collide(&moved.a, &moved.b, t->margin);
    deepest_of(&two, &m);
    pe_mat3 rotation = pe_matrix_of(turn);
    /* The rounding of positions this far away. */
    double within = 2 * t->tolerance + 32 * DBL_EPSILON * away;
    pe_vec3 back = pe_unrotate(&rotation, m);
    if (t->pair.a.shape.kind == PE_SHAPE_PLANE && pe_length(pe_sub(back, n)) <= 1e-12) {
        back = n;
    }
    return is_the_same(t, &two, point->separation, n, back, within);
}

static void test_contacts_move_with_the_world(void **state)
{
    run_law("moves_with_the_world", moves_with_the_world, LAW_ALL, share(*state, 4), engine_gap);
}

static bool scales(trial *t)
{
    manifolds one;
    const pe_pair_point *point;
    pe_vec3 n, m = {0, 0, 1};
    if (!query(t, &one, &point, &n)) {
        return false;
    }
    double factor = check_uniform(&t->random, 0, 1) < 0.5 ? 0x1p-10 : 0x1p10;
    solid a, b;
    pair scaled = {.a = placed_scaled(&t->pair.a, factor, &a),
                   .b = placed_scaled(&t->pair.b, factor, &b),
                   .size = factor * t->pair.size};
    manifolds two = collide(&scaled.a, &scaled.b, factor * t->margin);
    const pe_pair_point *other = deepest_of(&two, &m);
    double within = 2 * t->tolerance;
    bool same = other != NULL ? is_near(t, "scaled separation", other->separation / factor,
                                        point->separation, within)
                              : fails(t, "scaled points", 0, 1);
    same = same || (other != NULL && is_hollow(&t->pair) &&
                    jumps_to(t, other->separation / factor, within));
    solid_clear(&a);
    solid_clear(&b);
    return same;
}

static void test_contacts_scale_with_the_shapes(void **state)
{
    run_law("scales", scales, LAW_ALL, of_truth(*state, 4), engine_gap);
}

/* ---- Continuity ---- */

static bool is_continuous(trial *t)
{
    manifolds one;
    const pe_pair_point *point;
    pe_vec3 n, m = {0, 0, 1};
    if (!query(t, &one, &point, &n)) {
        return false;
    }
    if (t->pair.b.shape.kind == PE_SHAPE_MESH && point->separation < -1e-2 * t->pair.size) {
        return skips(t); /* deep in a mesh another surface may be the nearest */
    }
    double step = 1e-6 * t->pair.size;
    placed b = moved_a_little(t, step);
    manifolds two = collide(&t->pair.a, &b, t->margin);
    const pe_pair_point *other = deepest_of(&two, &m);
    return other != NULL ? is_near(t, "separation after a motion of 1e-6", other->separation,
                                   point->separation, 2.001 * step + 2 * t->tolerance)
                         : fails(t, "points after a motion of 1e-6", 0, 1);
}

/* The least separation changes by no more than the surfaces move. */
static void test_separation_is_continuous(void **state)
{
    run_law("is_continuous", is_continuous, LAW_ALL, share(*state, 4), engine_gap);
}

/* ---- Margins ---- */

static bool is_found_within_the_margin_alone(trial *t)
{
    manifolds found;
    const pe_pair_point *point;
    pe_vec3 n;
    if (!query(t, &found, &point, &n)) {
        return false;
    }
    double gap = point->separation;
    if (collide(&t->pair.a, &t->pair.b, pe_max(0, gap + 2 * t->tolerance)).count < 1) {
        return fails(t, "points within the margin", 0, 1);
    }
    return gap < 4 * t->tolerance ||
           is_near(t, "manifolds beyond the margin",
                   collide(&t->pair.a, &t->pair.b, gap - 2 * t->tolerance).count, 0, 0);
}

/* Points within the margin, none beyond it. */
static void test_pair_has_points_exactly_within_the_margin(void **state)
{
    run_law("is_found_within_the_margin_alone", is_found_within_the_margin_alone, LAW_ALL,
            share(*state, 4), engine_gap);
}

static bool are_same_points(const manifolds *one, const manifolds *two)
{
    bool same = one->count == two->count;
    for (int i = 0; same && i < one->count; ++i) {
        const pe_pair_manifold *p = &one->item[i], *q = &two->item[i];
        same = p->count == q->count && pe_length(pe_sub(p->normal, q->normal)) == 0;
        for (int j = 0; same && j < p->count; ++j) {
            const pe_pair_point *x = &p->item[j], *y = &q->item[j];
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
    manifolds found = collide(&t->pair.a, &t->pair.b, margin);
    if (found.count < 1) {
        return fails(t, "manifolds", found.count, 1);
    }
    double least = 0, end = 2 * margin + t->pair.size;
    for (int i = 0; i < found.count; ++i) {
        const pe_pair_manifold *manifold = &found.item[i];
        if (!(manifold->least_margin <= margin && margin < manifold->end_margin)) {
            return fails(t, "margin within its own range", margin, manifold->least_margin);
        }
        least = pe_max(least, manifold->least_margin);
        end = pe_min(end, manifold->end_margin);
    }
    for (int k = 0; k < 2; ++k) {
        /* Up to rounding: the gap may be computed in another way than the separations of the
         * points. */
        double at = k == 0 ? least + t->tolerance : check_uniform(&t->random, least, end);
        manifolds other = collide(&t->pair.a, &t->pair.b, at);
        if (at >= least && at < end && !are_same_points(&found, &other)) {
            return fails(t, "the same points at another margin of the range", at, margin);
        }
    }
    return true;
}

/* The same points at every margin from least_margin to end_margin. */
static void test_points_are_the_same_over_margin_range(void **state)
{
    run_law("keeps_points_over_the_range", keeps_points_over_the_range, LAW_ALL, share(*state, 4),
            engine_gap);
}

/* ---- Rest ---- */

static bool has_feature(const manifolds *found, uint64_t feature)
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

static bool is_the_same_contact(trial *t, const manifolds *first, const manifolds *now)
{
    if (now->count != first->count) {
        return fails(t, "manifolds after a sway", now->count, first->count);
    }
    for (int i = 0; i < now->count; ++i) {
        const pe_pair_manifold *p = &first->item[i], *q = &now->item[i];
        if (p->count != q->count) {
            return fails(t, "points after a sway", q->count, p->count);
        }
        double turn = pe_length(pe_sub(p->normal, q->normal));
        if (!is_near(t, "turn of the normal in a sway", turn, 0, 1e-6)) {
            return false;
        }
        for (int j = 0; j < q->count; ++j) {
            if (!has_feature(first, q->item[j].feature)) {
                return fails(t, "new feature after a sway, point", j, -1);
            }
        }
    }
    return true;
}

static bool keeps_its_features(trial *t)
{
    const solid *a = t->pair.a.solid, *other = t->pair.b.solid;
    if (!(a->convex && other->convex) && a->size > 0) {
        return skips(t); /* solids with hollows may not come to rest face to face */
    }
    pair_rest(&t->pair, &t->random, engine_gap);
    double margin = 1e-2 * t->pair.size;
    manifolds first = collide(&t->pair.a, &t->pair.b, margin);
    if (first.count < 1) {
        return fails(t, "manifolds", first.count, 1);
    }
    for (int k = 0; k < 4; ++k) {
        placed b = moved_a_little(t, 1e-9 * t->pair.size);
        manifolds now = collide(&t->pair.a, &b, margin);
        if (!is_the_same_contact(t, &first, &now)) {
            return false;
        }
    }
    return true;
}

/* Normal and features of a pair at rest stay while it sways by 1e-9. */
static void test_features_stay_while_resting_pair_sways(void **state)
{
    run_law("keeps_its_features", keeps_its_features, LAW_ALL, of_truth(*state, 4), engine_gap);
}

int run_pair_laws(const char *group, law_budget budget)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_depth_and_normal_equal_the_truth, &budget),
        cmocka_unit_test_prestate(test_distance_to_a_mesh_equals_brute_force, &budget),
        cmocka_unit_test_prestate(test_shallow_depth_of_convex_mesh_equals_hull, &budget),
        cmocka_unit_test_prestate(test_points_lie_in_both_shapes, &budget),
        cmocka_unit_test_prestate(test_swapping_the_shapes_turns_the_normal, &budget),
        cmocka_unit_test_prestate(test_contacts_move_with_the_world, &budget),
        cmocka_unit_test_prestate(test_contacts_scale_with_the_shapes, &budget),
        cmocka_unit_test_prestate(test_separation_is_continuous, &budget),
        cmocka_unit_test_prestate(test_pair_has_points_exactly_within_the_margin, &budget),
        cmocka_unit_test_prestate(test_points_are_the_same_over_margin_range, &budget),
        cmocka_unit_test_prestate(test_features_stay_while_resting_pair_sways, &budget),
    };
    return cmocka_run_group_tests_name(group, tests, NULL, NULL);
}
