/* The choice of manifold points: deepest first, then the farthest from those chosen. */
#include "points.h"

#include "tolerances.h"

/* ---- Candidates of polytopes ---- */

void pe_candidates_add(pe_candidates *found, const pe_pose *pose, pe_vec3 middle, double separation,
                       uint64_t feature)
{
    found->least = pe_min(found->least, separation);
    found->item[found->count++] = (pe_pair_point){
        .position = pe_pose_to_world(pose, middle),
        .separation = separation,
        .feature = feature,
    };
}

/* The point of lowest feature, of those not taken whose score is at least `enough`; -1: none. */
static int lowest_feature(const pe_candidates *found, const double *score, double enough,
                          const bool *taken)
{
    int lowest = -1;
    for (int i = 0; i < found->count; ++i) {
        if (!taken[i] && score[i] >= enough &&
            (lowest < 0 || found->item[i].feature < found->item[lowest].feature)) {
            lowest = i;
        }
    }
    return lowest;
}

/* Marks the points to keep; there are more than PE_MAX_POINTS. */
static void take_spread(const pe_candidates *found, double size, bool *taken)
{
    double score[PE_MOST_CANDIDATES], deepest = -HUGE_VAL;
    for (int i = 0; i < found->count; ++i) {
        taken[i] = false;
        score[i] = -found->item[i].separation;
        deepest = pe_max(deepest, score[i]);
    }
    int next = lowest_feature(found, score, deepest - PE_START_TIE * size, taken);
    for (int i = 0; i < found->count; ++i) {
        score[i] = HUGE_VAL; /* squared distance from the nearest one taken */
    }
    int last = next;
    bool has_deepest = false;
    for (int count = 0; count < PE_MAX_POINTS && next >= 0; ++count) {
        last = next;
        taken[last] = true;
        has_deepest =
            has_deepest || -found->item[last].separation >= deepest - PE_SAME_DISTANCE * size;
        double farthest = 0;
        for (int i = 0; i < found->count; ++i) {
            pe_vec3 d = pe_sub(found->item[i].position, found->item[last].position);
            score[i] = pe_min(score[i], pe_dot(d, d));
            farthest = pe_max(farthest, score[i]);
        }
        next = lowest_feature(found, score, farthest * (1 - PE_SPREAD_TIE), taken);
    }
    if (!has_deepest) {
        taken[last] = false;
        for (int i = 0; i < found->count && !has_deepest; ++i) {
            has_deepest = -found->item[i].separation >= deepest;
            taken[i] = taken[i] || has_deepest;
        }
    }
}

void pe_candidates_keep(pe_candidates *found, double size, double margin,
                        pe_pair_manifold *manifold)
{
    int count = 0;
    for (int i = 0; i < found->count; ++i) {
        if (pe_pair_manifold_within(manifold, found->item[i].separation, margin)) {
            found->item[count++] = found->item[i];
        }
    }
    found->count = count;
    bool taken[PE_MOST_CANDIDATES], all = count <= PE_MAX_POINTS;
    if (!all) {
        take_spread(found, size, taken);
    }
    for (int i = 0; i < count; ++i) {
        if (all || taken[i]) {
            manifold->item[manifold->count++] = found->item[i];
        }
    }
}

/* ---- Point list of cylinders ---- */

pe_point_list pe_point_list_begin(pe_vec3 normal, double least, double margin, double size)
{
    pe_point_list list;
    list.normal = normal;
    list.least = least;
    list.margin = margin;
    list.size = size;
    list.least_margin = least;
    list.end_margin = HUGE_VAL;
    list.count = 0; /* the points need no value */
    return list;
}

/* Index of the point with the least separation. */
static int nearest_of(const pe_point_list *list)
{
    int nearest = 0;
    for (int i = 1; i < list->count; ++i) {
        nearest = list->item[i].separation < list->item[nearest].separation ? i : nearest;
    }
    return nearest;
}

static double square(pe_vec3 v)
{
    return pe_dot(v, v);
}

/* Keeps PE_MAX_POINTS points: the first, then repeatedly the one farthest from all kept ones, and
 * in any case one with the least separation within a tie. Of equally far ones the first wins. */
static void reduce(pe_point_list *list)
{
    int nearest = nearest_of(list), count = list->count;
    double enough = list->item[nearest].separation + PE_CYLINDER_TIE * list->size,
           apart[PE_POINT_LIST_ROOM];
    for (int i = 0; i < count; ++i) {
        apart[i] = HUGE_VAL;
    }
    unsigned kept = 0;
    bool has_nearest = false;
    int next = 0;
    for (int n = 0; n < PE_MAX_POINTS; ++n) {
        kept |= 1u << next;
        has_nearest = has_nearest || list->item[next].separation <= enough;
        int farthest = -1;
        for (int i = 0; i < count; ++i) {
            apart[i] =
                pe_min(apart[i], square(pe_sub(list->item[i].position, list->item[next].position)));
            bool is_free = (kept >> i & 1) == 0;
            if (is_free &&
                (farthest < 0 || apart[i] > (1 + PE_LIST_SPREAD_TIE) * apart[farthest])) {
                farthest = i;
            }
        }
        next = n + 2 == PE_MAX_POINTS && !has_nearest ? nearest : farthest;
    }
    list->count = 0;
    for (int i = 0; i < count; ++i) {
        if (kept >> i & 1) {
            list->item[list->count++] = list->item[i];
        }
    }
}

void pe_point_list_add(pe_point_list *list, pe_vec3 on_second, double separation, uint64_t feature)
{
    /* Points within the slack of a bound may come out nearer than the signed distance. */
    double s = pe_max(separation, list->least);
    if (s > list->margin) {
        list->end_margin = pe_min(list->end_margin, s);
        return;
    }
    list->least_margin = pe_max(list->least_margin, s);
    pe_vec3 x = pe_madd(on_second, -0.5 * s, list->normal);
    double merge = PE_LIST_MERGE * list->size;
    for (int i = 0; i < list->count; ++i) {
        pe_pair_point *other = &list->item[i];
        if (other->feature == feature) {
            if (s < other->separation) {
                *other = (pe_pair_point){x, s, feature};
            }
            return;
        }
        if (other->separation <= s + PE_CYLINDER_TIE * list->size &&
            square(pe_sub(other->position, x)) <= merge * merge) {
            return;
        }
    }
    if (list->count == PE_POINT_LIST_ROOM) {
        reduce(list);
    }
    list->item[list->count++] = (pe_pair_point){x, s, feature};
}

bool pe_point_list_has_nearest(const pe_point_list *list)
{
    return list->count > 0 &&
           list->item[nearest_of(list)].separation <= list->least + PE_CYLINDER_TIE * list->size;
}

void pe_point_list_finish(pe_point_list *list, const pe_pose *pose, bool flip,
                          pe_pair_manifold *manifold)
{
    if (list->count > PE_MAX_POINTS) {
        reduce(list);
    }
    manifold->normal = pe_rotate(&pose->rotation, pe_scale(flip ? -1 : 1, list->normal));
    manifold->least_margin = list->least_margin;
    manifold->end_margin = list->end_margin;
    manifold->count = list->count;
    for (int i = 0; i < list->count; ++i) {
        manifold->item[i] = list->item[i];
        manifold->item[i].position = pe_pose_to_world(pose, list->item[i].position);
    }
}
