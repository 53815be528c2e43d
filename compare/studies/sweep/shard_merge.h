/* Merges the results of several files: of shards, of machines, or of the same sweep made twice. */
#ifndef PLUMB_SWEEP_SHARD_MERGE_H
#define PLUMB_SWEEP_SHARD_MERGE_H

#include "results/result_table.h"

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

/* Adds the results of an array, the lines of the file `path`, without warnings. */
void pl_merge_add_results(pl_merge *merge, const char *path, json_t *results);

/* Adds a folder that may have no results, or not exist, without warnings, to the same snapshot as others. */
pl_status pl_merge_add_any(pl_merge *merge, const char *folder, pl_error *error);

/* Writes all results as JSON lines (pl_write_text). */
pl_status pl_merge_write(const pl_merge *merge, const char *path, pl_error *error);

#endif
