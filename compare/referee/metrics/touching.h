/* Metrics of the pairs of bodies that touch: how deep they penetrate each other, and the islands
 * that they form.
 *
 * An island of a step consists of bodies that touch, directly or through others, in the frame
 * before or in the frame after the step. Energy that passes from body to body in a step stays
 * within one island. Static bodies join nothing, because no energy passes through them. */
#ifndef PLUMB_TOUCHING_H
#define PLUMB_TOUCHING_H

#include "metrics.h"
#include "referee/geometry/candidate_pairs.h"

/* ---- Penetration ---- */

typedef struct pl_penetration pl_penetration;

/* `scene` must outlive it. Memory of the arena; NULL when out of memory. */
pl_penetration *pl_penetration_create(const pl_scene *scene, pl_arena *arena);

/* Begins the frame after step number `step`, then takes the pairs of the frame one by one, then
 * ends the frame. Step 0, before the first step, counts for pl_penetration_touched_static alone. */
void pl_penetration_begin(pl_penetration *penetration, long step);
void pl_penetration_see(pl_penetration *penetration, const pl_near_pair *pair);
void pl_penetration_end(pl_penetration *penetration);

/* Whether a dynamic body has touched a static one: gap <= 0. */
bool pl_penetration_touched_static(const pl_penetration *penetration);

/* Sets penetration_max and penetration_rest in item (PL_METRIC_COUNT). Both are PL_METRIC_FAILED if
 * the gap of any pair could not be computed. */
void pl_penetration_metrics(const pl_penetration *penetration, pl_metric *item);

/* ---- Islands ---- */

typedef struct pl_islands pl_islands;

/* `scene` must outlive it. Memory of the arena; NULL when out of memory. */
pl_islands *pl_islands_create(const pl_scene *scene, pl_arena *arena);

/* Begins a new frame. Of the joins so far, only those of the last frame remain. */
void pl_islands_begin(pl_islands *islands);

/* Two dynamic bodies touch in this frame. */
void pl_islands_join(pl_islands *islands, int a, int b);

/* The largest sum over an island of `growth`, (body_count); the entries of static bodies are not
 * read. 0 in a scene without dynamic bodies. A NaN counts as infinite. */
double pl_islands_largest(pl_islands *islands, const double *growth);

#endif
