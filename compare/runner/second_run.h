/* A second run of a scene in the same process: whether an engine gives the same bits again. State that an
 * engine keeps outside its world, or an order that depends on addresses, shows here. */
#ifndef PLUMB_SECOND_RUN_H
#define PLUMB_SECOND_RUN_H

#include "referee/metrics/expectations.h"
#include "session.h"

#include <stdint.h>

/* The hashes of the states of a run. Starts as {0}. */
typedef struct pl_state_hashes {
    uint64_t *step; /* (count), by step; NULL: none are kept */
    long count;     /* steps so far, with the state before the first */
} pl_state_hashes;

/* Makes room for the states of a scene that expects the same bits; keeps none of another. */
void pl_state_hashes_create(const pl_scene *scene, pl_state_hashes *hashes);
/* Adds the next state. */
void pl_state_hashes_add(pl_state_hashes *hashes, const pl_frame *frame);
/* Frees them. */
void pl_state_hashes_free(pl_state_hashes *hashes);

/* Destroys the session's instance, creates the scene again, and takes as many steps as `first` has. It ends
 * early where create and steps take more than `cpu_limit` s (0: no limit) and leaves the session's costs as
 * they were. `frame` is overwritten. The engine's own status. */
pl_status pl_second_run(pl_session *session, const pl_scene *scene, const pl_state_hashes *first,
                        double cpu_limit, pl_frame *frame, pl_difference *difference,
                        pl_error *error);

#endif
