#include "contact_match.h"

/* Two points of a pair nearer than this, in m per metre of the smaller body, may be the same point
 * whose features were renamed. */
static const double MATCH_DISTANCE = 0.02;
/* Cosine of the angle up to which two patches face the same way. */
static const double SAME_WAY = 0.9;

static void inherit(pe_manifold_point *point, const pe_manifold_point *old, pe_vec3 normal)
{
    bool pushes = pe_dot(old->impulse, normal) > 0;
    point->impulse = pushes ? old->impulse : pe_v3(0, 0, 0);
}

static void match_nearest(pe_manifold_point *point, pe_vec3 normal, const pe_manifold *old,
                          int old_count, const pe_manifold_point *old_points, double reach,
                          pe_matched *matched)
{
    int nearest = -1;
    double least = reach * reach;
    for (int i = 0; i < old_count; ++i) {
        int first = old[i].first - old[0].first;
        if (pe_dot(old[i].normal, normal) < SAME_WAY) {
            continue;
        }
        for (int j = first; j < first + old[i].count; ++j) {
            pe_vec3 d = pe_sub(point->anchor_a, old_points[j].anchor_a);
            if (!matched->point[j] && pe_dot(d, d) < least) {
                least = pe_dot(d, d);
                nearest = j;
            }
        }
    }
    if (nearest >= 0) {
        inherit(point, &old_points[nearest], normal);
        matched->point[nearest] = true;
    }
}

void pe_points_match(pe_manifold_point *points, int count, pe_vec3 normal, const pe_manifold *old,
                     int old_count, const pe_manifold_point *old_points, double size,
                     pe_matched *matched)
{
    const pe_manifold *last = &old[old_count - 1];
    int total = last->first + last->count - old[0].first;
    unsigned unmatched = 0; /* bit set of new points */
    for (int i = 0; i < count; ++i) {
        int j = i; /* mostly the same place */
        if (i >= total || old_points[i].feature != points[i].feature) {
            for (j = 0; j < total && old_points[j].feature != points[i].feature;) {
                ++j;
            }
        }
        if (j < total && !matched->point[j]) {
            inherit(&points[i], &old_points[j], normal);
            matched->point[j] = true;
        } else {
            unmatched |= 1u << i;
        }
    }
    for (int i = 0; unmatched >> i != 0; ++i) {
        if (unmatched >> i & 1) {
            match_nearest(&points[i], normal, old, old_count, old_points, MATCH_DISTANCE * size,
                          matched);
        }
    }
}
