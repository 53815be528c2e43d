/* The pairs of bodies that are near each other in a frame, with their gaps. */
#ifndef PLUMB_CANDIDATE_PAIRS_H
#define PLUMB_CANDIDATE_PAIRS_H

#include "base/arena.h"
#include "base/thread_pool.h"
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

/* Calls `see` once with each candidate pair of a frame, (scene->body_count): all pairs with gap <=
 * 0, all pairs that meet, and possibly more. The threads of `pool` compute the gaps; NULL: this
 * thread alone. `see` is called in this thread, and in the same order for any number of threads. */
void pl_candidate_pairs_each(pl_candidate_pairs *pairs, const pl_body_state *bodies,
                             pl_thread_pool *pool,
                             void (*see)(void *context, const pl_near_pair *pair), void *context);

#endif
