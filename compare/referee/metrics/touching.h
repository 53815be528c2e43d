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

/* The state of these metrics over a run. */
typedef struct pl_touching pl_touching;

/* `scene` must outlive it. Memory of the arena. */
pl_touching *pl_touching_create(const pl_scene *scene, pl_arena *arena);

/* Begins the frame after step number `step`. Step 0 (the start) has no penetration. */
void pl_touching_begin(pl_touching *touching, long step);

/* Takes one pair of the frame. `touching` is a pl_touching. */
void pl_touching_see(void *touching, const pl_near_pair *pair);

/* Ends the frame, after all of its pairs. */
void pl_touching_end(pl_touching *touching);

/* Whether a dynamic body may have touched a static one, between frames included: the pair met
 * (pl_near_pair). Impulses of static bodies are then possible. */
bool pl_touching_static(const pl_touching *touching);

/* The largest sum of `growth`, (body_count), over an island of the last step; the entries of static
 * bodies are not read. 0 in a scene without dynamic bodies. A NaN counts as infinite. */
double pl_touching_island_max(pl_touching *touching, const double *growth);

/* The island of the last step that a dynamic body is in, by the least index of its bodies. */
int pl_touching_island(pl_touching *touching, int body);

/* The sum of the depths of a body's overlaps in the frames before and after the last step, m. */
double pl_touching_depth(const pl_touching *touching, int body);

/* The deepest overlap of the last frame, m. */
double pl_touching_deepest(const pl_touching *touching);

/* Whether a body flew through the last step: it met no other, neither in the frame before nor in the
 * frame after. */
bool pl_touching_flew(const pl_touching *touching, int body);

#endif
