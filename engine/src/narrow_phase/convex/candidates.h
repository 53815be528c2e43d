/* Points of a patch before the choice of those to keep. */
#ifndef PE_CANDIDATES_H
#define PE_CANDIDATES_H

#include "narrow_phase/collide.h"

enum { PE_MOST_CANDIDATES = 130 };

typedef struct pe_candidates {
    int count;
    double least; /* separation, m */
    pe_pair_point item[PE_MOST_CANDIDATES];
} pe_candidates;

static inline void pe_candidates_none(pe_candidates *found)
{
    found->count = 0;
    found->least = HUGE_VAL;
}

/* Adds a point, `middle` in the axes of the pose; there must be room. */
void pe_candidates_add(pe_candidates *found, const pe_pose *pose, pe_vec3 middle, double separation,
                       uint64_t feature);

/* Hands over the points within the margin, at most PE_MAX_POINTS, and narrows the range of margins
 * accordingly. Of more it takes a deepest one, and then whatever is farthest from all taken before;
 * what ties within rounding and the motion of rest goes to the lower feature. `size` is the smaller
 * shape's. Changes *found. */
void pe_candidates_keep(pe_candidates *found, double size, double margin, pe_pair_manifold *hits);

#endif
