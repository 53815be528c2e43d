/* Shards: each of several processes, on one machine or many, makes one shard of the same sweep,
 * without communication. */
#ifndef PLUMB_SWEEP_SHARD_H
#define PLUMB_SWEEP_SHARD_H

#include "plumb/base.h"

#include <stdbool.h>

enum { PL_SHARD_MOST = 1000000 };

/* One of `count` disjoint parts of the runs of a study. */
typedef struct pl_shard {
    int index; /* from 0; users count from 1 */
    int count; /* >= 1 */
} pl_shard;

/* Parses "I/N", 1 <= I <= N. PL_BAD_INPUT. */
pl_status pl_shard_parse(const char *text, pl_shard *shard, pl_error *error);

/* The shard that is asked for by a job array (SLURM_ARRAY_TASK_ID, _COUNT, _MIN and _STEP), an MPI
 * launcher (OMPI_COMM_WORLD_RANK and _SIZE, PMIX_RANK and _SIZE, PMI_RANK and _SIZE), or one within
 * the other. Without these *found is false, and the shard is the only one. PL_BAD_INPUT: invalid
 * variables, or an array of task ids with gaps. */
pl_status pl_shard_from_environment(pl_shard *shard, bool *found, pl_error *error);

/* Which of `count` shards makes a point, from 0. Times should be compared within one shard. With at
 * least as many cases as shards, all engines of a case are therefore in one shard. With fewer, each
 * shard gets a contiguous range of the points, ordered by case and then by configuration. All
 * repeats of a point are in one shard. */
int pl_shard_of_point(int count, int cases, int configurations, int test_case, int configuration);

/* DIRECTORY/shard-I-of-N, with I from 1; malloc'd. */
char *pl_shard_folder(const char *directory, pl_shard shard);

#endif
