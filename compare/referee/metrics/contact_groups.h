/* The islands of a step: bodies that touch, directly or through others, in the frame before it or
 * in the one after. What flows between two bodies in a step flows inside of one island.
 *
 * Static bodies join nothing: no energy goes through them. All memory is allocated by create. */
#ifndef PLUMB_ISLANDS_H
#define PLUMB_ISLANDS_H

#include "plumb/scene.h"

typedef struct pl_islands pl_islands;

/* `scene` must outlive it. NULL when out of memory. Freed by pl_islands_destroy (NULL allowed). */
pl_islands *pl_islands_create(const pl_scene *scene);
void pl_islands_destroy(pl_islands *islands);

/* A new frame: of the joins so far, those of the last frame alone stay. */
void pl_islands_begin(pl_islands *islands);

/* Two dynamic bodies touch in this frame. */
void pl_islands_join(pl_islands *islands, int a, int b);

/* The largest sum over an island of `growth`, (body_count), of which static bodies' entries are not
 * read. 0 in a scene without dynamic bodies; a NaN counts as infinite. */
double pl_islands_largest(pl_islands *islands, const double *growth);

#endif
