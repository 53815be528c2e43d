/* The pairs of bodies that are near each other in a frame, with their gaps, and the broad phase
 * that finds them. */
#ifndef PLUMB_CANDIDATE_PAIRS_H
#define PLUMB_CANDIDATE_PAIRS_H

#include "base/arena.h"
#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* ---- Broad phase: pairs of bodies whose bounding boxes overlap ---- */

/* The bounding boxes of the bodies, with the order in which they were last sorted. */
typedef struct pl_broad_phase pl_broad_phase;

/* Takes the sort axis and the first order from the scene's poses. `scene` must outlive it. Memory
 * of the arena; NULL when out of memory. */
pl_broad_phase *pl_broad_phase_create(const pl_scene *scene, pl_arena *arena);

/* Takes new poses, (scene->body_count), and calls `see` once with the scene indices of each pair. A
 * pair of two static bodies is left out. A plane is unbounded and pairs with every dynamic body.
 * `margin`, (scene->body_count) or NULL for zeros, enlarges each dynamic body's box, m: all
 * pairs with a gap of at most the sum of their two margins are seen. Poses of dynamic bodies must
 * be finite; static bodies stay where the scene has them. The order of the pairs depends only on
 * the poses so far. The cost is that of sorting a nearly sorted list, and of the pairs that overlap
 * along the axis. */
void pl_broad_phase_each_pair(pl_broad_phase *broad_phase, const pl_body_state *bodies,
                              const double *margin,
                              void (*see)(void *context, int body_a, int body_b), void *context);

/* ---- Candidate pairs ---- */

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

/* `scene` must outlive it. Memory of the arena; NULL when out of memory. */
pl_candidate_pairs *pl_candidate_pairs_create(const pl_scene *scene, pl_arena *arena);

/* Calls `see` once with each candidate pair of a frame, (scene->body_count): all pairs with gap <=
 * 0, all pairs that meet, and possibly more. */
void pl_candidate_pairs_each(pl_candidate_pairs *pairs, const pl_body_state *bodies,
                             void (*see)(void *context, const pl_near_pair *pair), void *context);

#endif
