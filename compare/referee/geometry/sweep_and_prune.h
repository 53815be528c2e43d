/* The pairs of bodies whose bounding boxes overlap, by sort and sweep along one axis.
 *
 * Every pair with a gap <= 0 is among them, except pairs of two static bodies, which are left out.
 * A plane is unbounded and pairs with every dynamic body. Pairs come in the same order for the same
 * poses and history. All memory is allocated by create. */
#ifndef PLUMB_BROAD_PHASE_H
#define PLUMB_BROAD_PHASE_H

#include "plumb/engine_abi.h"

typedef struct pl_broad_phase pl_broad_phase;

/* Takes the sweep's axis and first order from the scene's own poses. `scene` must outlive it. NULL
 * when out of memory. The caller frees it by pl_broad_phase_destroy (NULL allowed). */
pl_broad_phase *pl_broad_phase_create(const pl_scene *scene);
void pl_broad_phase_destroy(pl_broad_phase *broad_phase);

/* Takes new poses, (scene->body_count), and calls `see` with the scene indices of each pair once.
 * `reach`, (scene->body_count) or NULL for zeros, is by how much each dynamic body's box is widened
 * on all sides: pairs with a gap of at most the sum of their two are then among them, m.
 * Poses of dynamic bodies must be finite; static ones stay where the scene has them. The cost is
 * that of keeping a nearly sorted order sorted, and of the pairs that overlap along the axis. */
void pl_broad_phase_each_pair(pl_broad_phase *broad_phase, const pl_body_state *bodies,
                              const double *reach,
                              void (*see)(void *context, int body_a, int body_b), void *context);

#endif
