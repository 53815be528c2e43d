#include "candidates.h"

/* In units of the smaller shape: depths that tie for where to begin, and for being the deepest. */
static const double SAME_DEPTH = 1e-5, DEEPEST = 5e-10;
static const double SAME_REACH = 1e-5; /* of squared distances, relatively */

void pe_candidates_add(pe_candidates *found, const pe_pose *pose, pe_vec3 middle, double separation,
                       uint64_t feature)
{
    found->least = pe_min(found->least, separation);
    found->item[found->count++] = (pe_pair_point){
        .position = pe_add(pose->position, pe_rotate(&pose->rotation, middle)),
        .separation = separation,
        .feature = feature,
    };
}

/* Of the points not taken whose score reaches `enough`, that of the lowest feature; -1: none. */
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

static void take_spread(const pe_candidates *found, double size, bool *taken)
{
    double score[PE_MOST_CANDIDATES], deepest = -HUGE_VAL;
    for (int i = 0; i < found->count; ++i) {
        taken[i] = false;
        score[i] = -found->item[i].separation;
        deepest = pe_max(deepest, score[i]);
    }
    int next = lowest_feature(found, score, deepest - SAME_DEPTH * size, taken);
    for (int i = 0; i < found->count; ++i) {
        score[i] = HUGE_VAL; /* squared distance from the nearest one taken */
    }
    int last = next;
    bool has_deepest = false;
    for (int count = 0; count < PE_MAX_POINTS && next >= 0; ++count) {
        last = next;
        taken[last] = true;
        has_deepest = has_deepest || -found->item[last].separation >= deepest - DEEPEST * size;
        double farthest = 0;
        for (int i = 0; i < found->count; ++i) {
            pe_vec3 d = pe_sub(found->item[i].position, found->item[last].position);
            score[i] = pe_min(score[i], pe_dot(d, d));
            farthest = pe_max(farthest, score[i]);
        }
        next = lowest_feature(found, score, farthest * (1 - SAME_REACH), taken);
    }
    if (!has_deepest) {
        taken[last] = false;
        for (int i = 0; i < found->count && !has_deepest; ++i) {
            has_deepest = -found->item[i].separation >= deepest;
            taken[i] = taken[i] || has_deepest;
        }
    }
}

void pe_candidates_keep(pe_candidates *found, double size, double margin, pe_pair_manifold *hits)
{
    int count = 0;
    for (int i = 0; i < found->count; ++i) {
        double separation = found->item[i].separation;
        if (separation > margin) {
            hits->end_margin = pe_min(hits->end_margin, separation);
        } else {
            hits->least_margin = pe_max(hits->least_margin, separation);
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
            hits->item[hits->count++] = found->item[i];
        }
    }
}
