/* Touches of solids that overlap deeply. */
#ifndef PE_MESH_OVERLAP_H
#define PE_MESH_OVERLAP_H

#include "near_features.h"

/* Whether another part of the surface lies between a face and the vertex under it that touches it.
 */
bool pe_touch_is_blocked(const pe_solid_pair *pair, const pe_touch *touch);

/* Adds the vertices of either solid that lie deeper in the other one than `depth`, as far as they
 * are reached over the surfaces from where these cross; with `all`, all. */
void pe_touches_find_deep(const pe_solid_pair *pair, double depth, bool all, pe_touches *list);

/* Adds a translation that parts the solids, for an overlap in which no features show one. */
void pe_touches_find_translation(const pe_solid_pair *pair, const pe_nearest *nearest,
                                 pe_touches *list);

#endif
