#include "contact_reduce.h"

static const double TIE = 1e-5; /* in units of the smaller body */

static void sort_by_feature(pe_pair_manifold *hits)
{
    for (int i = 1; i < hits->count; ++i) {
        pe_pair_point hit = hits->item[i];
        int j = i;
        for (; j > 0 && hits->item[j - 1].feature > hit.feature; --j) {
            hits->item[j] = hits->item[j - 1];
        }
        hits->item[j] = hit;
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

void pe_pair_manifold_reduce(pe_pair_manifold *hits, double size)
{
    sort_by_feature(hits);
    double tie = TIE * size, score[PE_MAX_POINTS] = {0};
    int count = hits->count;
    double least = hits->item[0].separation;
    for (int i = 1; i < count; ++i) {
        least = pe_min(least, hits->item[i].separation);
    }
    int deepest = 0;
    while (hits->item[deepest].separation > least + tie) {
        ++deepest;
    }
    unsigned kept = 1u << deepest;

    pe_vec3 from = hits->item[deepest].position;
    for (int i = 0; i < count; ++i) {
        score[i] = pe_length(pe_sub(hits->item[i].position, from));
    }
    int far = first_best(score, count, tie);
    if (far >= 0) {
        kept |= 1u << far;
        /* Distance of each point from the line, positive on one side of it. */
        pe_vec3 along = pe_sub(hits->item[far].position, from);
        pe_vec3 across = pe_scale(1 / pe_length(along), pe_cross(hits->normal, along));
        for (double side = -1; side < 2; side += 2) {
            for (int i = 0; i < count; ++i) {
                score[i] = side * pe_dot(across, pe_sub(hits->item[i].position, from));
            }
            int wide = first_best(score, count, tie);
            kept |= wide >= 0 ? 1u << wide : 0;
        }
    }
    hits->count = 0;
    for (int i = 0; i < count; ++i) {
        if (kept >> i & 1) {
            hits->item[hits->count++] = hits->item[i];
        }
    }
}
