/* The features of two solids that touch or are near, and their nearest points. */
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

pe_nearest pe_solids_nearest(const pe_solid_pair *pair, double bound);

#endif
