/* The distance of a point from a segment. */
#ifndef PLUMB_TEST_SEGMENT_DISTANCE_H
#define PLUMB_TEST_SEGMENT_DISTANCE_H

#include "base/vec3.h"

/* m: from x to the segment from p to q, which are apart. */
static inline double point_to_segment(pe_vec3 x, pe_vec3 p, pe_vec3 q)
{
    pe_vec3 d = pe_sub(q, p);
    double t = pe_max(0, pe_min(1, pe_dot(pe_sub(x, p), d) / pe_dot(d, d)));
    return pe_length(pe_sub(x, pe_madd(p, t, d)));
}

#endif
