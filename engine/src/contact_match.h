/* The impulses that a new manifold takes over from the one it replaces. */
#ifndef PE_CONTACT_MATCH_H
#define PE_CONTACT_MATCH_H

#include "world.h"

/* Gives each of the new points the impulse of the old point on the same features, or else of the
 * nearest one that is left, within a fiftieth of `size`, the smaller body's; none: 0. An impulse
 * that would pull along the new normal is dropped. */
void pe_points_match(pe_point *points, int count, pe_vec3 normal, const pe_point *old_points,
                     int old_count, double size);

#endif
