#include "contact_match.h"

/* Two points of a pair nearer than this, in m per metre of the smaller body, may be the same point
 * whose features were renamed. */
static const double MATCH_DISTANCE = 0.02;

static void inherit(pe_point *point, const pe_point *old, pe_vec3 normal)
{
    bool pushes = pe_dot(old->impulse, normal) > 0;
    point->impulse = pushes ? old->impulse : pe_v3(0, 0, 0);
}

static void match_nearest(pe_point *point, pe_vec3 normal, const pe_point *old_points,
                          int old_count, double reach, unsigned *used)
{
    int nearest = -1;
    double least = reach * reach;
    for (int j = 0; j < old_count; ++j) {
        pe_vec3 d = pe_sub(point->anchor_a, old_points[j].anchor_a);
        if (!(*used >> j & 1) && pe_dot(d, d) < least) {
            least = pe_dot(d, d);
            nearest = j;
        }
    }
    if (nearest >= 0) {
        inherit(point, &old_points[nearest], normal);
        *used |= 1u << nearest;
    }
}

/* The features of one manifold are all different. */
void pe_points_match(pe_point *points, int count, pe_vec3 normal, const pe_point *old_points,
                     int old_count, double size)
{
    unsigned used = 0, unmatched = 0; /* bit sets of old and new points */
    for (int i = 0; i < count; ++i) {
        int j = i; /* mostly the same place */
        if (i >= old_count || old_points[i].feature != points[i].feature) {
            for (j = 0; j < old_count && old_points[j].feature != points[i].feature;) {
                ++j;
            }
        }
        if (j < old_count) {
            inherit(&points[i], &old_points[j], normal);
            used |= 1u << j;
        } else {
            unmatched |= 1u << i;
        }
    }
    for (int i = 0; unmatched >> i != 0; ++i) {
        if (unmatched >> i & 1) {
            match_nearest(&points[i], normal, old_points, old_count, MATCH_DISTANCE * size, &used);
        }
    }
}
