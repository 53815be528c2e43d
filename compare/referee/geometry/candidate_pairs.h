/* The pairs of bodies that are near each other in a frame, with their gaps. */
#ifndef PLUMB_CANDIDATE_PAIRS_H
#define PLUMB_CANDIDATE_PAIRS_H

#include "base/arena.h"
#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* The shapes of a scene, prepared for queries of their gaps. */
typedef struct pl_candidate_pairs pl_candidate_pairs;

/* A pair of a frame that meets: its gap is one that it can close, or has opened, in a step, or within a
 * thousandth of the smaller one's size. Bodies that hover within rounding of each other touch. */
typedef struct pl_near_pair {
    int a, b;         /* scene indices, not both static */
    pl_status status; /* of the gap: not PL_OK if it could not be computed */
    double gap;       /* m, as in gap.h */
} pl_near_pair;

/* `scene` must outlive it. Memory of the arena. */
pl_candidate_pairs *pl_candidate_pairs_create(const pl_scene *scene, pl_arena *arena);

/* Finds the pairs of a frame, (scene->body_count), that meet, on up to `threads` threads. `meanwhile` (NULL allowed) is called once, with
 * `context`, by any of the threads. */
void pl_candidate_pairs_find(pl_candidate_pairs *pairs, const pl_body_state *bodies, int threads,
                             void (*meanwhile)(void *context), void *context);

/* Calls `see` once with each pair of the frame, in an order that does not depend on the threads. */
void pl_candidate_pairs_each(const pl_candidate_pairs *pairs,
                             void (*see)(void *context, const pl_near_pair *pair), void *context);

/* ---- The broad phase: the pairs of bodies whose bounding boxes overlap (box_sweep.c) ---- */

/* The bounding boxes of the bodies of a frame, sorted. */
typedef struct pl_broad_phase pl_broad_phase;

/* Takes the sort axis and the first order from the scene's poses. `scene` must outlive it. Memory
 * of the arena. */
pl_broad_phase *pl_broad_phase_create(const pl_scene *scene, pl_arena *arena);

/* Moves the boxes to new poses, (scene->body_count). `margin`, (scene->body_count) or NULL for
 * zeros, enlarges each dynamic body's box, m. Poses of dynamic bodies must be finite; static bodies
 * stay where the scene has them. The cost is that of sorting a nearly sorted list. */
void pl_broad_phase_follow(pl_broad_phase *bp, const pl_body_state *bodies, const double *margin);

/* The number of rows into which the pairs of a frame are divided. */
long pl_broad_phase_rows(const pl_broad_phase *bp);

/* Calls `see` with the scene indices of each pair of the rows from `begin` to before `end`. All rows
 * together have each pair once: every pair with a gap of at most the sum of the two margins, but
 * for pairs of two static bodies. The order of the pairs depends only on the poses. Several threads
 * may look at rows of one frame. Returns the cost: the number of pairs of boxes that are compared. */
long pl_broad_phase_see(const pl_broad_phase *bp, long begin, long end,
                        void (*see)(void *context, int body_a, int body_b), void *context);

#endif
