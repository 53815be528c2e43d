#include "study.h"

#include "base/heap.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

json_t *pl_study_get(const json_t *object, const char *path)
{
    char key[64];
    const char *dot = strchr(path, '.');
    if (dot == NULL) {
        return json_object_get(object, path);
    }
    snprintf(key, sizeof key, "%.*s", (int)(dot - path), path);
    return pl_study_get(json_object_get(object, key), dot + 1);
}

double pl_study_number(const json_t *object, const char *path)
{
    const json_t *value = pl_study_get(object, path);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

int pl_study_integer(const json_t *object, const char *path)
{
    return (int)json_integer_value(pl_study_get(object, path));
}

const char *pl_study_text(const json_t *object, const char *path)
{
    const char *text = json_string_value(pl_study_get(object, path));
    return text == NULL ? "" : text;
}

char *pl_study_key(const json_t *result, const char *const *paths)
{
    json_t *values = json_object();
    for (; *paths != NULL; ++paths) {
        json_object_set(values, *paths, pl_study_get(result, *paths));
    }
    char *text = pl_result_to_line(values);
    json_decref(values);
    return text;
}

json_t *pl_study_groups(const json_t *items, const char *const *paths)
{
    json_t *groups = json_object(), *item;
    size_t index;
    json_array_foreach((json_t *)items, index, item)
    {
        char *key = pl_study_key(item, paths);
        if (json_object_get(groups, key) == NULL) {
            json_object_set_new(groups, key, json_array());
        }
        json_array_append(json_object_get(groups, key), item);
        free(key);
    }
    return groups;
}

void pl_study_add_groups(pl_document *document, const json_t *items, const char *const *paths,
                         void (*add)(pl_document *document, const json_t *group))
{
    json_t *groups = pl_study_groups(items, paths), *group;
    const char *key;
    json_object_foreach(groups, key, group)
    {
        add(document, group);
    }
    json_decref(groups);
}

void pl_study_copy(json_t *to, const json_t *from, const char *const *keys)
{
    for (; *keys != NULL; ++keys) {
        json_object_set(to, *keys, json_object_get(from, *keys));
    }
}

bool pl_study_ended(const json_t *result)
{
    const char *outcome = pl_json_get_text(result, "outcome");
    return strcmp(outcome, "ok") == 0 || strcmp(outcome, "collapsed") == 0;
}

json_t *pl_study_row(const json_t *result, const char *const *more)
{
    static const char *const shared[] = {
        "scenario",    "params",   "engine",         "engine_version", "engine_binary",
        "engine_spec", "profile",  "engine_runtime", "threads",        "as_shipped",
        "label",       "settings", "seed",           "primary_error",  "acceptance",
        "conformance", NULL};
    json_t *row = json_object();
    pl_study_copy(row, result, shared);
    pl_study_copy(row, result, more);
    return row;
}

static int compare_texts(const void *left, const void *right)
{
    return strcmp(*(const char *const *)left, *(const char *const *)right);
}

char *pl_study_params(const json_t *params)
{
    pl_text_buffer text = {0};
    const char **names = pl_heap_new(json_object_size(params), sizeof(const char *)), *name;
    json_t *value;
    size_t count = 0;
    json_object_foreach((json_t *)params, name, value)
    {
        names[count++] = name;
    }
    qsort(names, count, sizeof *names, compare_texts);
    for (size_t i = 0; i < count; ++i) {
        pl_text_format(&text, "%s%s = %.6g", i == 0 ? "" : ", ", names[i],
                       json_number_value(json_object_get(params, names[i])));
    }
    free(names);
    return pl_text_take(&text);
}
