/* Shards: each of several processes, on one machine or many, makes one shard of the same sweep,
 * without communication. Their results are merged, as are those of machines, or of the same sweep made twice. */
#ifndef PLUMB_SWEEP_SHARD_H
#define PLUMB_SWEEP_SHARD_H

#include "results/result_table.h"

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

/* The results merged so far. */
typedef struct pl_merge {
    json_t *results; /* array: the first result of each run, in the order of reading */
    json_t *runs;    /* run hash -> its result */
    /* (source_count): the same by file, for pl_result_table_build. A file or folder that was added is a snapshot with
     * its shards. */
    pl_result_file *sources;
    int source_count;
    int snapshot; /* of the files that are added next */
    long files;
    long doubles;   /* results left out because their run had one already */
    long differing; /* doubles that differ in their outcome or a deterministic metric */
} pl_merge;

/* An empty merge, which the caller frees. */
pl_merge pl_merge_begin(void);

/* Releases the results. */
void pl_merge_free(pl_merge *merge);

/* Adds a file of results ("-" is standard input), or a folder: its results.jsonl and those of its
 * shards, shard-*-of-*. The first ten doubles that differ are reported on `warnings` (NULL
 * allowed). PL_BAD_INPUT: a file with other content, or a folder without results; PL_IO. */
pl_status pl_merge_add(pl_merge *merge, const char *path, FILE *warnings, pl_error *error);

/* Adds the results of an array, the lines of the file `path`, with the warnings of pl_merge_add. */
void pl_merge_add_results(pl_merge *merge, const char *path, json_t *results, FILE *warnings);

/* Adds a folder that may have no results, or not exist, without warnings, to the same snapshot as others. */
pl_status pl_merge_add_any(pl_merge *merge, const char *folder, pl_error *error);

/* Writes all results as JSON lines (pl_write_text). */
pl_status pl_merge_write(const pl_merge *merge, const char *path, pl_error *error);

#endif
