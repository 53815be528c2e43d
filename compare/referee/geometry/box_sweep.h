/* The broad phase of the referee: the pairs of bodies whose bounding boxes overlap. */
#ifndef PLUMB_BOX_SWEEP_H
#define PLUMB_BOX_SWEEP_H

#include "base/arena.h"
#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* The bounding boxes of the bodies of a frame, sorted. */
typedef struct pl_broad_phase pl_broad_phase;

/* Takes the sort axis and the first order from the scene's poses. `scene` must outlive it. Memory
 * of the arena. */
pl_broad_phase *pl_broad_phase_create(const pl_scene *scene, pl_arena *arena);

/* Moves the boxes to new poses, (scene->body_count). `margin`, (scene->body_count) or NULL for
 * zeros, enlarges each dynamic body's box, m. Poses of dynamic bodies must be finite; static bodies
 * stay where the scene has them. The cost is that of sorting a nearly sorted list. */
void pl_broad_phase_follow(pl_broad_phase *broad_phase, const pl_body_state *bodies,
                           const double *margin);

/* The number of rows into which the pairs of a frame are divided. */
long pl_broad_phase_rows(const pl_broad_phase *broad_phase);

/* Calls `see` with the scene indices of each pair of the rows from `begin` to before `end`. All rows
 * together have each pair once: every pair with a gap of at most the sum of the two margins, but
 * for pairs of two static bodies. The order of the pairs depends only on the poses. Several threads
 * may look at rows of one frame. Returns the cost: the number of pairs of boxes that are compared. */
long pl_broad_phase_see(const pl_broad_phase *broad_phase, long begin, long end,
                        void (*see)(void *context, int body_a, int body_b), void *context);

#endif
