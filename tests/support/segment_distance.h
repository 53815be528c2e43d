/* Distances of points from segments. */
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

/* m: from the ends of each of two segments, from p to q and from r to s, to the other one. */
static inline double ends_to_segments(pe_vec3 p, pe_vec3 q, pe_vec3 r, pe_vec3 s)
{
    return pe_min(pe_min(point_to_segment(p, r, s), point_to_segment(q, r, s)),
                  pe_min(point_to_segment(r, p, q), point_to_segment(s, p, q)));
}

#endif
