#include "study.h"

#include "base/heap.h"
#include "results/result.h"

#include <stdlib.h>
#include <string.h>

char *pl_study_key(const json_t *result, const char *const *keys)
{
    json_t *values = json_object();
    for (; *keys != NULL; ++keys) {
        json_object_set(values, *keys, json_object_get(result, *keys));
    }
    char *text = pl_result_to_line(values);
    json_decref(values);
    return text;
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
