/* Polytopes that touch at edges or corners: see polytope_edges.c. */
#ifndef PE_POLYTOPE_EDGES_H
#define PE_POLYTOPE_EDGES_H

#include "narrow_phase/points.h"
#include "polytope.h"

/* Adds the points of nearly parallel edges along s->normal, if there are no points yet or s is of a
 * line, and the nearest points, those of *nearest, if no point lies as near as `least` (m). */
void pe_polytope_add_nearest(const pe_polytope_pair *pair, const pe_separation *s,
                             const pe_separation *nearest, double least, pe_candidates *found);

/* Whether cores without radii touch along parallel edges, whose faces do not lie flat on each
 * other. `face` is that of pe_polytope_best_face. *meeting is of kind PE_OF_LINE. */
bool pe_polytope_edges_meet(const pe_polytope_pair *pair, const pe_separation *face,
                            pe_separation *meeting);

#endif
