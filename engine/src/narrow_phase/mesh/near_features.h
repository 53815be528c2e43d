/* The touches of two solids: features within reach, nearest points (near_features.c), and deep
 * overlaps (mesh_overlap.c). */
#ifndef PE_NEAR_FEATURES_H
#define PE_NEAR_FEATURES_H

#include "solid_pair.h"
#include "touches.h"

/* Adds the touches with a gap of at most `reach` or, unless `depth` is 0, an overlap of at most
 * `depth` (m, of the cores): see mesh_contact.c for the rules. */
void pe_touches_find(const pe_solid_pair *pair, double reach, double depth, pe_touches *list);

/* The nearest points of the two surfaces; of a core, without its ball. */
typedef struct pe_nearest {
    double distance; /* m; the bound if none is nearer */
    bool found;
    bool inside;    /* by the side of the face: a's core lies in b, or b in a */
    bool cross;     /* the surfaces pass through each other: the search ended there */
    pe_touch touch; /* without its separation; apart: the normal is along the line */
} pe_nearest;

/* Searches nearest points within `bound` (m). */
pe_nearest pe_solids_nearest(const pe_solid_pair *pair, double bound);

/* Whether another part of the surface lies between a face and the vertex below that touches it. */
bool pe_touch_is_blocked(const pe_solid_pair *pair, const pe_touch *touch);

/* Adds the vertices of either solid that lie deeper in the other one than `depth`, as far as they
 * are reached over the surfaces from where these cross; with `all`, all. */
void pe_touches_find_deep(const pe_solid_pair *pair, double depth, bool all, pe_touches *list);

/* Adds a translation that parts the solids, for an overlap in which no features show one. */
void pe_touches_find_translation(const pe_solid_pair *pair, const pe_nearest *nearest,
                                 pe_touches *list);

#endif
