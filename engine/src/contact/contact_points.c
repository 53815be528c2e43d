#include "contact_points.h"

#include "narrow_phase/tolerances.h"

static const double TIE = 1e-5; /* in units of the smaller body */
static const double FAR = 0.5;  /* margin, in units of the smaller body's bounding radius */
static const uint64_t CENTRE_FEATURE = UINT64_MAX;

/* ---- Reduction ---- */

static void sort_by_feature(pe_pair_manifold *manifold)
{
    for (int i = 1; i < manifold->count; ++i) {
        pe_pair_point point = manifold->item[i];
        int j = i;
        for (; j > 0 && manifold->item[j - 1].feature > point.feature; --j) {
            manifold->item[j] = manifold->item[j - 1];
        }
        manifold->item[j] = point;
    }
}

/* The first whose score is within `tie` of the largest, and at least `tie` itself; -1: none. */
static int first_best(const double *score, int count, double tie)
{
    double largest = tie;
    for (int i = 0; i < count; ++i) {
        largest = pe_max(largest, score[i]);
    }
    for (int i = 0; i < count; ++i) {
        if (score[i] > tie && score[i] >= largest - tie) {
            return i;
        }
    }
    return -1;
}

/* The first of the least separated points, with a tolerance. */
static int deepest_point(const pe_pair_manifold *manifold, double tie)
{
    double least = manifold->item[0].separation;
    for (int i = 1; i < manifold->count; ++i) {
        least = pe_min(least, manifold->item[i].separation);
    }
    int deepest = 0;
    while (manifold->item[deepest].separation > least + tie) {
        ++deepest;
    }
    return deepest;
}

void pe_pair_manifold_reduce(pe_pair_manifold *manifold, double size)
{
    sort_by_feature(manifold);
    double tie = TIE * size, score[PE_MAX_POINTS] = {0};
    int count = manifold->count, deepest = deepest_point(manifold, tie);
    unsigned kept = 1u << deepest;
    const pe_pair_point *first = &manifold->item[deepest];
    pe_vec3 from = first->position;
    double drawback[PE_MAX_POINTS];
    for (int i = 0; i < count; ++i) {
        pe_vec3 d = pe_sub(manifold->item[i].position, from);
        d = pe_madd(d, -pe_dot(d, manifold->normal), manifold->normal);
        drawback[i] =
            PE_HEIGHT_WEIGHT * pe_max(0, manifold->item[i].separation - first->separation);
        score[i] = pe_length(d) - drawback[i];
    }
    int far = first_best(score, count, tie);
    if (far >= 0) {
        kept |= 1u << far;
        /* Distance of each point from the line, positive on one side of it. */
        pe_vec3 along = pe_sub(manifold->item[far].position, from);
        along = pe_madd(along, -pe_dot(along, manifold->normal), manifold->normal);
        pe_vec3 across = pe_scale(1 / pe_length(along), pe_cross(manifold->normal, along));
        for (double side = -1; side < 2; side += 2) {
            for (int i = 0; i < count; ++i) {
                pe_vec3 d = pe_sub(manifold->item[i].position, from);
                score[i] = side * pe_dot(across, d) - drawback[i];
            }
            int wide = first_best(score, count, tie);
            kept |= wide >= 0 ? 1u << wide : 0;
        }
    }
    manifold->count = 0;
    for (int i = 0; i < count; ++i) {
        if (kept >> i & 1) {
            manifold->item[manifold->count++] = manifold->item[i];
        }
    }
}

/* ---- The centre of a fast body ---- */

static void drop_point(pe_pair_manifold *manifold, int index)
{
    manifold->count -= 1;
    for (int i = index; i < manifold->count; ++i) {
        manifold->item[i] = manifold->item[i + 1];
    }
}

/* The first of the points with the least separation times `sign`. */
static int extreme_point(const pe_pair_manifold *manifold, double sign)
{
    int best = 0;
    for (int i = 1; i < manifold->count; ++i) {
        bool less = sign * manifold->item[i].separation < sign * manifold->item[best].separation;
        best = less ? i : best;
    }
    return best;
}

void pe_pair_manifold_hold_centre(pe_pair_manifold *manifold, const pe_body *a,
                                  const pe_pose *pose_a, const pe_body *b, const pe_pose *pose_b,
                                  double margin)
{
    double ra = a->bounding_radius, rb = b->bounding_radius;
    bool b_is_smaller = ra == 0 || (rb > 0 && rb <= ra);
    double from = FAR * (b_is_smaller ? rb : ra);
    if (margin < from) {
        manifold->end_margin = pe_min(manifold->end_margin, from);
        return;
    }
    /* The plane through the other body's nearest point, and the centre's height over it. */
    const pe_pair_point *deepest = &manifold->item[extreme_point(manifold, 1)];
    pe_vec3 out = b_is_smaller ? manifold->normal : pe_scale(-1, manifold->normal);
    pe_vec3 centre = b_is_smaller ? pose_b->position : pose_a->position;
    pe_vec3 on_other = pe_madd(deepest->position, -0.5 * deepest->separation, out);
    double height = pe_dot(out, pe_sub(centre, on_other));
    if (height <= 0) {
        manifold->least_margin = pe_max(manifold->least_margin, from);
    } else if (height > margin) {
        manifold->end_margin = pe_min(manifold->end_margin, height);
    } else {
        manifold->least_margin = pe_max(manifold->least_margin, pe_max(from, height));
        if (manifold->count == PE_MAX_POINTS) {
            drop_point(manifold, extreme_point(manifold, -1));
        }
        manifold->item[manifold->count++] = (pe_pair_point){
            .position = pe_madd(centre, -0.5 * height, out),
            .separation = height,
            .feature = CENTRE_FEATURE,
        };
    }
}
