/* The pairs of bodies that are near each other in a frame, with their gaps. */
#ifndef PLUMB_CANDIDATE_PAIRS_H
#define PLUMB_CANDIDATE_PAIRS_H

#include "base/arena.h"
#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* The shapes of a scene, prepared for queries of their gaps. */
typedef struct pl_candidate_pairs pl_candidate_pairs;

/* A candidate pair of a frame, with its gap. */
typedef struct pl_near_pair {
    int a, b;         /* scene indices, not both static */
    pl_status status; /* of the gap: not PL_OK if it could not be computed */
    /* m, as in gap.h. If the pair neither touches nor meets, only a lower bound, above 0 and above
     * the gap at which the two would meet. */
    double gap;
    /* The gap is one that they can close, or have opened, in a step, or within a thousandth of the
     * smaller one's size: bodies that hover within rounding of each other touch. */
    bool meets;
} pl_near_pair;

/* `scene` must outlive it. Memory of the arena. */
pl_candidate_pairs *pl_candidate_pairs_create(const pl_scene *scene, pl_arena *arena);

/* Finds the candidate pairs of a frame, (scene->body_count), on up to `threads` threads: all pairs with
 * gap <= 0, all pairs that meet, and possibly more. `meanwhile` (NULL allowed) is called once, with
 * `context`, by any of the threads. */
void pl_candidate_pairs_find(pl_candidate_pairs *pairs, const pl_body_state *bodies, int threads,
                             void (*meanwhile)(void *context), void *context);

/* Calls `see` once with each pair of the frame, in an order that does not depend on the threads. */
void pl_candidate_pairs_each(const pl_candidate_pairs *pairs,
                             void (*see)(void *context, const pl_near_pair *pair), void *context);

#endif
