/* The pairs of bodies that are near each other in a frame, with their gaps: one pass of geometry
 * for all that ask who touches whom. */
#ifndef PLUMB_NEARBY_H
#define PLUMB_NEARBY_H

#include "plumb/engine_abi.h"

typedef struct pl_candidate_pairs pl_candidate_pairs;

typedef struct pl_near_pair {
    int a, b;         /* scene indices, not both static */
    pl_status status; /* of the gap: anything but PL_OK when it could not be found */
    /* m, as of gap.h: of one that neither touches nor meets, only a number above 0, or above that
     * at which they would meet. */
    double gap;
    /* Both dynamic, and the gap no more than they could close, or have opened, in a step. */
    bool meets;
} pl_near_pair;

/* `scene` must outlive it. NULL when out of memory. Freed by pl_candidate_pairs_destroy (NULL
 * allowed). */
pl_candidate_pairs *pl_candidate_pairs_create(const pl_scene *scene);
void pl_candidate_pairs_destroy(pl_candidate_pairs *nearby);

/* Calls `see` with each pair of a frame, (scene->body_count), once: all with gap <= 0, all that
 * meet, and maybe more. */
void pl_candidate_pairs_each(pl_candidate_pairs *nearby, const pl_body_state *bodies,
                             void (*see)(void *context, const pl_near_pair *pair), void *context);

#endif
