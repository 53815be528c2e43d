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
    char number[16];
    long index = 0, count = 0;
    const size_t length = strcspn(text, "/");
    bool right = text[length] == '/' && length < sizeof number;
    if (right) {
        memcpy(number, text, length);
        number[length] = '\0';
        right = read_integer(number, &index) && read_integer(text + length + 1, &count);
    }
    if (!right || index < 1 || index > count || count > PL_SHARD_MOST) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--shard takes I/N, from 1/N to N/N, N at most %d; found \"%.200s\"",
                       (int)PL_SHARD_MOST, text);
    }
    *shard = (pl_shard){.index = (int)index - 1, .count = (int)count};
    return PL_OK;
}

/* Reads the number of a variable; `otherwise` where it is not set. */
static pl_status read_variable(const char *name, long otherwise, long *value, pl_error *error)
{
    const char *text = getenv(name);
    *value = otherwise;
    if (text != NULL && !read_integer(text, value)) {
        return pl_fail(error, PL_BAD_INPUT, "%s is \"%.200s\", expected an integer", name, text);
    }
    return PL_OK;
}

static pl_status read_array(pl_shard *shard, bool *found, pl_error *error)
{
    *shard = (pl_shard){.index = 0, .count = 1};
    *found = getenv("SLURM_ARRAY_TASK_ID") != NULL && getenv("SLURM_ARRAY_TASK_COUNT") != NULL;
    if (!*found) {
        return PL_OK;
    }
    long id = 0, count = 0, first = 0, step = 1;
    if (read_variable("SLURM_ARRAY_TASK_ID", 0, &id, error) != PL_OK ||
        read_variable("SLURM_ARRAY_TASK_COUNT", 0, &count, error) != PL_OK ||
        read_variable("SLURM_ARRAY_TASK_MIN", 1, &first, error) != PL_OK ||
        read_variable("SLURM_ARRAY_TASK_STEP", 1, &step, error) != PL_OK) {
        return PL_BAD_INPUT;
    }
    const bool in_step = step >= 1 && id >= first && (id - first) % step == 0;
    if (!in_step || count < 1 || count > PL_SHARD_MOST || (id - first) / step >= count) {
        return pl_fail(
            error, PL_BAD_INPUT,
            "SLURM_ARRAY_TASK_ID %ld is none of %ld ids from %ld in steps of %ld: use an "
            "array without gaps, or give --shard",
            id, count, first, step);
    }
    *shard = (pl_shard){.index = (int)((id - first) / step), .count = (int)count};
    return PL_OK;
}

static pl_status read_rank(pl_shard *shard, bool *found, pl_error *error)
{
    static const char *const launchers[][2] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                               {"PMIX_RANK", "PMIX_SIZE"},
                                               {"PMI_RANK", "PMI_SIZE"}};
    *shard = (pl_shard){.index = 0, .count = 1};
    *found = false;
    for (size_t i = 0; i < sizeof launchers / sizeof launchers[0]; ++i) {
        const char *const *names = launchers[i];
        if (getenv(names[0]) == NULL || getenv(names[1]) == NULL) {
            continue;
        }
        long rank = 0, size = 0;
        pl_status status = read_variable(names[0], 0, &rank, error);
        if (status == PL_OK) {
            status = read_variable(names[1], 0, &size, error);
        }
        if (status == PL_OK && (rank < 0 || rank >= size || size > PL_SHARD_MOST)) {
            status = pl_fail(error, PL_BAD_INPUT, "%s is %ld, expected 0 to %s - 1 = %ld", names[0],
                             rank, names[1], size - 1);
        }
        *found = status == PL_OK;
        if (*found) {
            *shard = (pl_shard){.index = (int)rank, .count = (int)size};
        }
        return status;
    }
    return PL_OK;
}

pl_status pl_shard_from_environment(pl_shard *shard, bool *found, pl_error *error)
{
    pl_shard task, rank;
    bool in_array = false, has_rank = false;
    *shard = (pl_shard){.index = 0, .count = 1};
    *found = false;
    pl_status status = read_array(&task, &in_array, error);
    if (status == PL_OK) {
        status = read_rank(&rank, &has_rank, error);
    }
    if (status != PL_OK) {
        return status;
    }
    if ((long)task.count * rank.count > PL_SHARD_MOST) {
        return pl_fail(error, PL_BAD_INPUT,
                       "an array of %d jobs of %d ranks is more than %d shards", task.count,
                       rank.count, (int)PL_SHARD_MOST);
    }
    *found = in_array || has_rank;
    *shard =
        (pl_shard){.index = task.index * rank.count + rank.index, .count = task.count * rank.count};
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
