/* How deep bodies sink into one another, over the frames of a run. */
#ifndef PLUMB_PENETRATION_H
#define PLUMB_PENETRATION_H

#include "referee/geometry/candidate_pairs.h"
#include "series.h"

typedef struct pl_penetration pl_penetration;

/* `scene` must outlive it. NULL when out of memory. Freed by pl_penetration_destroy (NULL allowed).
 */
pl_penetration *pl_penetration_create(const pl_scene *scene);
void pl_penetration_destroy(pl_penetration *penetration);

/* The frame after step number `step`: its pairs come between begin and end. Step 0, before the
 * first, shows only what touches. */
void pl_penetration_begin(pl_penetration *penetration, long step);
void pl_penetration_see(pl_penetration *penetration, const pl_near_pair *pair);
void pl_penetration_end(pl_penetration *penetration);

/* Whether any gap to a static body has been <= 0. */
bool pl_penetration_touched_static(const pl_penetration *penetration);

/* The depth of each touching pair (gap <= 0) at each step, m. */
pl_metric pl_penetration_max(const pl_penetration *penetration);

/* The mean over the last second of the scene's duration of the largest depth of each frame, m. */
pl_metric pl_penetration_rest(const pl_penetration *penetration);

#endif
