/* Merges files and folders of results, and compares runs that were made twice. */
#include "shard.h"

#include "base/folding.h"
#include "base/heap.h"
#include "results/result.h"
#include "results/store.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_WARNINGS = 10 };

pl_merge pl_merge_begin(void)
{
    return (pl_merge){.results = json_array(), .runs = json_object()};
}

void pl_merge_free(pl_merge *merge)
{
    for (int i = 0; i < merge->source_count; ++i) {
        const pl_result_file *source = &merge->sources[i];
        free((char *)source->path);
        free((int *)source->lines);
        json_decref((json_t *)source->results);
    }
    free(merge->sources);
    json_decref(merge->results);
    json_decref(merge->runs);
    *merge = (pl_merge){.results = NULL};
}

/* The name of a deterministic metric whose values differ; NULL when there is none. */
static const char *differing_metric(const json_t *first, const json_t *second)
{
    const json_t *others = json_object_get(second, "metrics");
    const char *name;
    json_t *metric;
    json_object_foreach(json_object_get(first, "metrics"), name, metric)
    {
        const json_t *other = json_object_get(others, name);
        if (other != NULL && json_is_true(json_object_get(metric, "deterministic")) &&
            !json_equal(json_object_get(metric, "value"), json_object_get(other, "value"))) {
            return name;
        }
    }
    return NULL;
}

/* The outcome, or the value of a metric, as text. The caller frees. */
static char *text_of(const json_t *result, const char *metric)
{
    const json_t *found = json_object_get(json_object_get(result, "metrics"), metric);
    const json_t *value = json_object_get(found, "value");
    return metric == NULL  ? pl_heap_copy(pl_json_get_text(result, "outcome"))
           : value == NULL ? pl_heap_copy("?")
                           : json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
}

/* Counts a double, and says where it differs from the first result of its run. */
static void judge_double(pl_merge *merge, const json_t *first, const json_t *second, FILE *warnings)
{
    const bool same_outcome =
        strcmp(pl_json_get_text(first, "outcome"), pl_json_get_text(second, "outcome")) == 0;
    const char *metric = same_outcome ? differing_metric(first, second) : NULL;
    const bool differs = !same_outcome || metric != NULL;
    merge->doubles += 1;
    merge->differing += differs;
    if (differs && warnings != NULL && merge->differing <= MOST_WARNINGS) {
        char *before = text_of(first, metric), *after = text_of(second, metric);
        pl_print_line(warnings,
                      "run %s, %s on %s, repeat %lld, was made twice and differs: %s %s, then %s",
                      pl_json_get_text(first, "run"), pl_json_get_text(first, "scenario"),
                      pl_json_get_text(first, "label"),
                      (long long)json_integer_value(json_object_get(first, "repeat")),
                      metric != NULL ? metric : "outcome", before, after);
        free(before);
        free(after);
    }
}

void pl_merge_add_results(pl_merge *merge, const char *path, json_t *results, FILE *warnings)
{
    size_t index;
    json_t *result, *kept = json_array();
    int *lines = pl_heap_new(json_array_size(results), sizeof *lines);
    json_array_foreach(results, index, result)
    {
        const char *run = pl_json_get_text(result, "run");
        const json_t *first = json_object_get(merge->runs, run);
        if (first != NULL) {
            judge_double(merge, first, result, warnings);
            continue;
        }
        json_object_set(merge->runs, run, result);
        json_array_append(merge->results, result);
        lines[json_array_size(kept)] = (int)index + 1;
        json_array_append(kept, result);
    }
    const pl_result_file source = {
        .path = pl_heap_copy(path), .results = kept, .lines = lines, .snapshot = merge->snapshot};
    pl_push(&merge->sources, &merge->source_count, &source, sizeof source);
}

static pl_status add_file(pl_merge *merge, const char *path, FILE *warnings, pl_error *error)
{
    json_t *read = NULL;
    pl_status status = pl_results_read(path, &read, NULL, error);
    if (status == PL_OK) {
        merge->files += 1;
        pl_merge_add_results(merge, path, read, warnings);
        json_decref(read);
    }
    return status;
}

static int is_shard(const struct dirent *entry)
{
    int index = 0, count = 0, length = 0;
    return sscanf(entry->d_name, "shard-%d-of-%d%n", &index, &count, &length) == 2 &&
           entry->d_name[length] == '\0';
}

/* Adds the results.jsonl of a folder and of its shards, where they exist. */
static pl_status add_folder(pl_merge *merge, const char *folder, FILE *warnings, pl_error *error)
{
    struct dirent **shards = NULL;
    const int count = scandir(folder, &shards, is_shard, versionsort);
    pl_status status =
        count >= 0 ? PL_OK : pl_fail(error, PL_IO, "%s: %s", folder, strerror(errno));
    for (int i = -1; i < count; ++i) {
        char *path = i < 0 ? pl_heap_format("%s/results.jsonl", folder)
                           : pl_heap_format("%s/%s/results.jsonl", folder, shards[i]->d_name);
        if (status == PL_OK && access(path, F_OK) == 0) {
            status = add_file(merge, path, warnings, error);
        }
        free(path);
        if (i >= 0) {
            free(shards[i]);
        }
    }
    free(shards);
    return status;
}

static bool is_folder(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

pl_status pl_merge_add(pl_merge *merge, const char *path, FILE *warnings, pl_error *error)
{
    const long before = merge->files;
    pl_status status = is_folder(path) ? add_folder(merge, path, warnings, error)
                                       : add_file(merge, path, warnings, error);
    if (status == PL_OK && merge->files == before) {
        status = pl_fail(error, PL_BAD_INPUT,
                         "%s: has neither a results.jsonl nor shard-*-of-*/results.jsonl", path);
    }
    ++merge->snapshot;
    return status;
}

pl_status pl_merge_add_any(pl_merge *merge, const char *folder, pl_error *error)
{
    return is_folder(folder) ? add_folder(merge, folder, NULL, error) : PL_OK;
}

pl_status pl_merge_write(const pl_merge *merge, const char *path, pl_error *error)
{
    pl_text_buffer text = {0};
    size_t index;
    const json_t *result;
    json_array_foreach(merge->results, index, result)
    {
        pl_result_add_line(&text, result);
    }
    return pl_write_buffer(path, &text, error);
}
