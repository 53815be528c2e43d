/* Fewer points for a manifold. */
#ifndef PE_CONTACT_REDUCE_H
#define PE_CONTACT_REDUCE_H

#include "narrow_phase/collide.h"

/* Keeps 4 of the points: a deepest one, the one farthest from it, and those that widen the polygon
 * most on either side of the line between the two. Depths and widths that differ by less than
 * rounding and rocking at rest (1e-5 of `size`, the smaller body's) tie, and ties go to the lower
 * feature, so that the choice does not flip from step to step. Fewer than 4 remain when the points
 * lie on one line. The points come out sorted by feature. */
void pe_pair_manifold_reduce(pe_pair_manifold *hits, double size);

#endif
