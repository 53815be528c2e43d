#include "capture_file.h"

#include <stdlib.h>
#include <string.h>

bool pl_capture_parse(const char *text, long *step, const char **path)
{
    char *end;
    *step = strtol(text, &end, 10);
    if (end == text || *end != ':' || *step < 1 || end[1] == '\0') {
        return false;
    }
    *path = end + 1;
    return true;
}

int pl_capture_largest(pe_contact_problem *const *problems, int count)
{
    int largest = -1;
    for (int i = 0; i < count; ++i) {
        if (largest < 0 || problems[i]->point_count > problems[largest]->point_count) {
            largest = i;
        }
    }
    return largest;
}

/* The path with its "{}" replaced, malloc'd. */
static char *numbered_path(const char *path, const char *braces, int number)
{
    char *text = malloc(strlen(path) + 16);
    if (text != NULL) {
        sprintf(text, "%.*s%d%s", (int)(braces - path), path, number, braces + 2);
    }
    return text;
}

static pl_status write_island(const pl_capture_target *target, const char *path,
                              const pe_contact_problem *problem, int island, int islands,
                              pl_error *error)
{
    json_t *source = json_copy((json_t *)target->source);
    int failed = json_object_set_new(source, "step", json_integer(target->step));
    failed |= json_object_set_new(source, "island", json_integer(island));
    failed |= json_object_set_new(source, "islands", json_integer(islands));
    pl_status status = failed != 0 ? pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path)
                                   : pl_problem_write_file(path, problem, source, error);
    json_decref(source);
    return status;
}

pl_status pl_capture_write(void *user, pe_contact_problem **problems, int count, pl_error *error)
{
    const pl_capture_target *target = user;
    const char *braces = strstr(target->path, "{}");
    pl_status status = PL_OK;
    if (count == 0) {
        status =
            pl_fail(error, PL_FAILED, "nothing to capture: step %ld has no contact", target->step);
    } else if (braces == NULL) {
        int largest = pl_capture_largest(problems, count);
        status = write_island(target, target->path, problems[largest], largest + 1, count, error);
    }
    for (int i = 0; i < count && braces != NULL && status == PL_OK; ++i) {
        char *path = numbered_path(target->path, braces, i + 1);
        status = path == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                              : write_island(target, path, problems[i], i + 1, count, error);
        free(path);
    }
    pe_contact_problems_destroy(problems, count);
    return status;
}
