#include "result_table.h"

#include "base/heap.h"
#include "base/number_format.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Ends a part of a key. No name has this character, and it sorts before those of names. */
static const char part_end[] = "\x01";

void pl_case_name_add(char name[PL_CASE_NAME_SIZE], const char *format, ...)
{
    const size_t length = strlen(name);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(name + length, PL_CASE_NAME_SIZE - length, format, arguments);
    va_end(arguments);
}

json_t *pl_case_params(const pl_case_identity *identity)
{
    const pl_scenario *scenario = identity->catalogue;
    json_t *params = json_object(), *value;
    const char *name;
    json_object_foreach((json_t *)identity->params, name, value)
    {
        const int index = scenario == NULL ? -1 : pl_scenario_param(scenario, name);
        if (index < 0 || json_number_value(value) != scenario->params[index].value) {
            json_object_set(params, name, value);
        }
    }
    return params;
}

static int compare_texts(const void *left, const void *right)
{
    return strcmp(*(const char *const *)left, *(const char *const *)right);
}

/* Adds " name=value" for every parameter that counts, by name. */
static void add_params(const pl_case_identity *identity, pl_text_buffer *out)
{
    json_t *params = pl_case_params(identity), *value;
    const char **names = pl_heap_new(json_object_size(params), sizeof(const char *)), *name;
    size_t count = 0;
    json_object_foreach(params, name, value)
    {
        names[count++] = name;
    }
    qsort(names, count, sizeof *names, compare_texts);
    for (size_t i = 0; i < count; ++i) {
        if (!isnan(identity->dt) || strcmp(names[i], "dt") != 0) {
            pl_text_format(out, " %s=%.17g", names[i],
                           json_number_value(json_object_get(params, names[i])));
        }
    }
    free(names);
    json_decref(params);
}

char *pl_case_key(const pl_case_identity *identity)
{
    pl_text_buffer out = {0};
    pl_text_format(&out, "%s%s", identity->scenario, part_end);
    add_params(identity, &out);
    pl_text_add(&out, part_end);
    if (!isnan(identity->dt)) {
        pl_text_format(&out, "%.17g", identity->dt);
    }
    pl_text_format(&out, "%s%.17g%s%.17g%s", part_end, identity->duration, part_end,
                   (double)identity->seed, part_end);
    if (identity->member >= 0) {
        pl_text_format(&out, "%d", identity->member);
    }
    pl_text_add(&out, part_end);
    return pl_text_take(&out);
}

static void add_param(char *name, const pl_case_identity *identity, const pl_param *param)
{
    const json_t *value = json_object_get(identity->params, param->name);
    const bool is_any_step = isnan(identity->dt) && strcmp(param->name, "dt") == 0;
    char number[PL_QUANTITY_SIZE];
    if (json_is_number(value) && json_number_value(value) != param->value && !is_any_step) {
        pl_format_given(json_number_value(value), param->unit, number);
        pl_case_name_add(name, " %.50s=%.60s", param->name, number);
    }
}

void pl_case_name(const pl_case_identity *identity, char name[PL_CASE_NAME_SIZE])
{
    const pl_scenario *scenario = identity->catalogue;
    const char *key;
    json_t *value;
    snprintf(name, PL_CASE_NAME_SIZE, "%.120s", identity->scenario);
    for (int i = 0; scenario != NULL && i < scenario->param_count; ++i) {
        add_param(name, identity, &scenario->params[i]);
    }
    json_object_foreach((json_t *)identity->params, key, value)
    {
        const bool is_time = strcmp(key, "dt") == 0 || strcmp(key, "duration") == 0;
        if (scenario == NULL) {
            add_param(name, identity,
                      &(pl_param){.name = key, .value = (double)NAN, .unit = is_time ? "s" : "1"});
        }
    }
    if (identity->seed != 0) {
        pl_case_name_add(name, " seed=%" JSON_INTEGER_FORMAT, identity->seed);
    }
    if (identity->member >= 0) {
        pl_case_name_add(name, " member=%d", identity->member);
    }
}
