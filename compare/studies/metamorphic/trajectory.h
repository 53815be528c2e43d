/* A run's frames as they stand in its trajectory file (CSV, every digit), one at a time: long runs
 * of many bodies need not fit into memory. */
#ifndef PLUMB_TRAJECTORY_H
#define PLUMB_TRAJECTORY_H

#include "plumb/engine_abi.h"

#include <stdio.h>

typedef struct pl_trajectory {
    FILE *file;
    pl_frame frame; /* the one that was read last */
    char *line;
    size_t capacity;
} pl_trajectory;

/* An empty temporary file, gone when closed, for a run's frames. */
pl_status pl_trajectory_open(pl_trajectory *trajectory, pl_error *error);
void pl_trajectory_close(pl_trajectory *trajectory); /* of all zeros allowed */

/* Goes to the first frame of a scene with so many bodies. */
pl_status pl_trajectory_rewind(pl_trajectory *trajectory, int body_count, pl_error *error);

/* Reads the next frame into trajectory->frame. False at the end, and where a run broke off. */
bool pl_trajectory_next(pl_trajectory *trajectory);

#endif
