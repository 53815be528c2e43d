/* The impulses that a new manifold takes over from the one it replaces. */
#ifndef PE_CONTACT_MATCH_H
#define PE_CONTACT_MATCH_H

#include "model/world.h"

/* Which old points of a pair have given their impulse away. */
typedef struct pe_matched {
    bool point[PE_MAX_MANIFOLDS * PE_MAX_POINTS];
} pe_matched;

/* Gives each point of a new manifold the impulse of the old point of the pair on the same features,
 * or else of the nearest one that is left in a patch that faces the same way, within a fiftieth of
 * `size`, the smaller body's; none: 0. An impulse that would pull along the new normal is dropped.
 * `old` are the pair's manifolds (old_count of them), whose points stand together from old_points
 * on. */
void pe_points_match(pe_manifold_point *points, int count, pe_vec3 normal, const pe_manifold *old,
                     int old_count, const pe_manifold_point *old_points, double size,
                     pe_matched *matched);

#endif
