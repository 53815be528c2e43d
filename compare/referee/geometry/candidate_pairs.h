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

#endif
