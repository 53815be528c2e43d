/* The shard of this process, from text or from the environment, and its points. */
#include "shard.h"

#include "base/heap.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A whole number of decimal digits with an optional minus. */
static bool read_integer(const char *text, long *value)
{
    char *end = NULL;
    const char *digits = text[0] == '-' ? text + 1 : text;
    if (digits[0] < '0' || digits[0] > '9') {
        return false;
    }
    *value = strtol(text, &end, 10);
    return *end == '\0' && *value >= -2000000000L && *value <= 2000000000L;
}

pl_status pl_shard_parse(const char *text, pl_shard *shard, pl_error *error)
{
    char *part = pl_heap_copy(text), *rest = part;
    const char *first = strsep(&rest, "/");
    long index = 0, count = 0;
    const bool right = rest != NULL && read_integer(first, &index) && read_integer(rest, &count);
    free(part);
    if (!right || index < 1 || index > count || count > PL_SHARD_MOST) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--shard takes I/N, from 1/N to N/N, N at most %d; found \"%.200s\"",
                       (int)PL_SHARD_MOST, text);
    }
    *shard = (pl_shard){.index = (int)index - 1, .count = (int)count};
    return PL_OK;
}

/* Reads the number of a variable; one that is not set leaves *value unchanged. */
static pl_status read_variable(const char *name, long *value, pl_error *error)
{
    const char *text = getenv(name);
    return text == NULL || read_integer(text, value)
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT, "%s is \"%.200s\", expected an integer", name, text);
}

/* Variables with the place of a process among several. The first is of a job array, the others are of launchers. */
static const struct {
    const char *id, *count, *first, *step; /* first, step: NULL: none */
} sources[] = {{"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_MIN",
                "SLURM_ARRAY_TASK_STEP"},
               {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", NULL, NULL},
               {"PMIX_RANK", "PMIX_SIZE", NULL, NULL},
               {"PMI_RANK", "PMI_SIZE", NULL, NULL}};

/* The place of a process by one of the sources, where its variables are set. */
static pl_status read_source(int source, pl_shard *shard, bool *found, pl_error *error)
{
    const char *name = sources[source].id;
    const bool is_array = sources[source].first != NULL;
    long id = 0, count = 0, first = is_array ? 1 : 0, step = 1;
    *found = getenv(name) != NULL && getenv(sources[source].count) != NULL;
    if (!*found) {
        return PL_OK;
    }
    if (read_variable(name, &id, error) != PL_OK ||
        read_variable(sources[source].count, &count, error) != PL_OK ||
        (is_array && (read_variable(sources[source].first, &first, error) != PL_OK ||
                      read_variable(sources[source].step, &step, error) != PL_OK))) {
        return PL_BAD_INPUT;
    }
    if (step < 1 || id < first || (id - first) % step != 0 || count < 1 || count > PL_SHARD_MOST ||
        (id - first) / step >= count) {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s is %ld, which is none of %ld ids from %ld in steps of %ld%s", name, id,
                       count, first, step,
                       is_array ? ": use an array without gaps, or give --shard" : "");
    }
    *shard = (pl_shard){.index = (int)((id - first) / step), .count = (int)count};
    return PL_OK;
}

pl_status pl_shard_from_environment(pl_shard *shard, bool *found, pl_error *error)
{
    *shard = (pl_shard){.index = 0, .count = 1};
    *found = false;
    for (int i = 0, ranks = 0; i < 4 && ranks == 0; ++i) {
        pl_shard part = {.index = 0, .count = 1};
        bool has = false;
        const pl_status status = read_source(i, &part, &has, error);
        if (status != PL_OK) {
            return status;
        }
        if (has && (long)shard->count * part.count > PL_SHARD_MOST) {
            return pl_fail(error, PL_BAD_INPUT,
                           "an array of %d jobs of %d ranks is more than %d shards", shard->count,
                           part.count, (int)PL_SHARD_MOST);
        }
        if (has) {
            *shard = (pl_shard){.index = shard->index * part.count + part.index,
                                .count = shard->count * part.count};
            *found = true;
            ranks = i;
        }
    }
    return PL_OK;
}

int pl_shard_of_point(int count, int cases, int configurations, int test_case, int configuration)
{
    if (cases >= count) {
        return test_case % count;
    }
    const long points = (long)cases * configurations;
    const long point = (long)test_case * configurations + configuration;
    return (int)(point * count / points);
}

char *pl_shard_folder(const char *directory, pl_shard shard)
{
    return pl_heap_format("%s/shard-%d-of-%d", directory, shard.index + 1, shard.count);
}
