/* A shard: the part of a sweep that one process of several makes. Several processes, on one machine
 * or many, make all shards of the same sweep without talking to each other. */
#ifndef PLUMB_SWEEP_SHARD_H
#define PLUMB_SWEEP_SHARD_H

#include "plumb/base.h"

#include <stdbool.h>

enum { PL_SHARD_MOST = 1000000 };

typedef struct pl_shard {
    int index; /* from 0; users count from 1 */
    int count; /* >= 1 */
} pl_shard;

/* "I/N", 1 <= I <= N. PL_BAD_INPUT. */
pl_status pl_shard_parse(const char *text, pl_shard *shard, pl_error *error);

/* The shard that a job array (SLURM_ARRAY_TASK_ID, _COUNT, _MIN and _STEP), an MPI launcher
 * (OMPI_COMM_WORLD_RANK and _SIZE, PMIX_RANK and _SIZE, PMI_RANK and _SIZE), or one within the
 * other asks for. *found is false, and the shard the only one, when there is none. PL_BAD_INPUT:
 * variables that make no sense, among them an array of task ids with gaps, which is named. */
pl_status pl_shard_from_environment(pl_shard *shard, bool *found, pl_error *error);

/* Which of `count` shards makes a point, from 0. Times are to be compared within one shard, so that
 * all engines of a case stay in one where there are as many cases as shards. Else each shard
 * gets one stretch of the points in their order, case by case, in which engines that are
 * neighbours in a case stay so. All repeats of a point are in one shard. */
int pl_shard_of_point(int count, int cases, int configurations, int test_case, int configuration);

/* DIRECTORY/shard-I-of-N, with I from 1; malloc'd, NULL when out of memory. */
char *pl_shard_folder(const char *directory, pl_shard shard);

#endif
