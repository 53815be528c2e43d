/* Keys of rows of results: canonical JSON of the fields that identify a scene, and of those that
 * identify a series, which are all except the time step; and the order that the keys give. */
#include "analysis_rows.h"

#include "plumb/scenario.h"
#include "results/result.h"

#include <stdlib.h>
#include <string.h>

/* ---- Keys ---- */

static pl_status check_row(const json_t *row, size_t index, pl_error *error)
{
    static const char *const texts[] = {"scenario", "engine",  "profile",
                                        "label",    "outcome", "primary_error"};
    static const char *const objects[] = {"params", "settings", "metrics"};
    if (!json_is_object(row)) {
        return pl_fail(error, PL_BAD_INPUT, "results[%zu]: expected an object", index);
    }
    if (strcmp(pl_json_get_text(row, "schema"), "plumb.result/1") != 0) {
        return pl_fail(error, PL_BAD_INPUT,
                       "results[%zu].schema: expected \"plumb.result/1\", found \"%.40s\"", index,
                       pl_json_get_text(row, "schema"));
    }
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        if (!json_is_string(json_object_get(row, texts[i]))) {
            return pl_fail(error, PL_BAD_INPUT, "results[%zu].%s: expected a string", index,
                           texts[i]);
        }
    }
    for (size_t i = 0; i < sizeof objects / sizeof objects[0]; ++i) {
        if (!json_is_object(json_object_get(row, objects[i]))) {
            return pl_fail(error, PL_BAD_INPUT, "results[%zu].%s: expected an object", index,
                           objects[i]);
        }
    }
    const json_t *dt = json_object_get(json_object_get(row, "settings"), "dt");
    if (!json_is_number(dt) || !(json_number_value(dt) > 0)) {
        return pl_fail(error, PL_BAD_INPUT,
                       "results[%zu].settings.dt: expected a time step above 0", index);
    }
    return PL_OK;
}

static json_t *without_dt(const json_t *row, const char *object)
{
    json_t *copy = json_copy(json_object_get(row, object));
    json_object_del(copy, "dt");
    return copy;
}

/* A new reference to a value; null where it is absent. */
static json_t *same(const json_t *object, const char *key)
{
    json_t *value = json_object_get(object, key);
    return value == NULL ? json_null() : json_incref(value);
}

static char *to_text(json_t *value)
{
    char *text = pl_result_to_line(value);
    json_decref(value);
    return text;
}

pl_status pl_keyed_row_make(const json_t *row, size_t index, pl_keyed_row *keyed, pl_error *error)
{
    *keyed = (pl_keyed_row){.row = row, .index = index};
    pl_status status = check_row(row, index, error);
    if (status != PL_OK) {
        return status;
    }
    const json_t *settings = json_object_get(row, "settings"),
                 *plumb = json_object_get(row, "plumb");
    /* The duration of a scene file is no parameter unless it was given. */
    const bool has_duration = json_object_get(json_object_get(row, "params"), "duration") != NULL;
    keyed->change = pl_json_get_text(row, "change");
    keyed->dt = json_number_value(json_object_get(settings, "dt"));
    keyed->scene = to_text(
        json_pack("[o, o, o, o, o, o]", same(row, "scenario"), without_dt(row, "params"),
                  same(row, "seed"), same(row, "member"),
                  same(has_duration ? NULL : settings, "duration"), same(row, "primary_error")));
    json_t *series = json_pack("[o, o, o, o, o, o]", same(row, "engine"), same(row, "profile"),
                               same(row, "label"), without_dt(row, "settings"),
                               same(row, "engine_version"), same(plumb, "git"));
    json_t *binary = json_object_get(row, "engine_binary");
    if (binary != NULL) { /* results of earlier versions have none */
        json_array_append(series, binary);
    }
    keyed->series = to_text(series);
    if (keyed->scene == NULL || keyed->series == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory at result %zu", index);
    }
    return PL_OK;
}

void pl_keyed_row_free(pl_keyed_row *keyed)
{
    free(keyed->scene);
    free(keyed->series);
}

/* ---- Orders ---- */

static int catalogue_index(const char *scenario)
{
    int count = 0, i = 0;
    const pl_scenario *const *all = pl_scenarios(&count);
    while (i < count && strcmp(all[i]->name, scenario) != 0) {
        ++i;
    }
    return i;
}

bool pl_engine_is_ours(const char *engine)
{
    return strcmp(engine, "plumb") == 0;
}

static int compare_scenes(const pl_keyed_row *a, const pl_keyed_row *b)
{
    if (strcmp(a->scene, b->scene) == 0) {
        return 0;
    }
    const char *scenario_a = pl_json_get_text(a->row, "scenario");
    const char *scenario_b = pl_json_get_text(b->row, "scenario");
    int order = catalogue_index(scenario_a) - catalogue_index(scenario_b);
    order = order != 0 ? order : strcmp(scenario_a, scenario_b);
    const pl_scenario *scenario = order == 0 ? pl_scenario_find(scenario_a, NULL) : NULL;
    for (int i = 0; order == 0 && scenario != NULL && i < scenario->param_count; ++i) {
        const char *name = scenario->params[i].name;
        double x = json_number_value(json_object_get(json_object_get(a->row, "params"), name));
        double y = json_number_value(json_object_get(json_object_get(b->row, "params"), name));
        order = strcmp(name, "dt") == 0 ? 0 : (x > y) - (x < y);
    }
    return order != 0 ? order : strcmp(a->scene, b->scene);
}

static int compare_engines(const json_t *a, const json_t *b)
{
    const char *name_a = pl_json_get_text(a, "engine"), *name_b = pl_json_get_text(b, "engine");
    if (pl_engine_is_ours(name_a) != pl_engine_is_ours(name_b)) {
        return pl_engine_is_ours(name_a) ? -1 : 1;
    }
    int order = strcmp(name_a, name_b);
    return order != 0 ? order
                      : strcmp(pl_json_get_text(a, "profile"), pl_json_get_text(b, "profile"));
}

/* By scene, engine, series and falling dt; 0 for repeats of one point. */
static int compare_rows(const void *left, const void *right)
{
    const pl_keyed_row *a = left, *b = right;
    int order = compare_scenes(a, b);
    order = order != 0 ? order : compare_engines(a->row, b->row);
    order = order != 0 ? order : strcmp(a->series, b->series);
    return order != 0 ? order : (a->dt < b->dt) - (a->dt > b->dt);
}

/* The same, with changes (those of the unchanged scene first) and repeats ordered too, so that the
 * order of the rows has no effect. */
static int compare_repeats(const void *left, const void *right)
{
    const pl_keyed_row *a = left, *b = right;
    int order = compare_rows(a, b);
    if (order != 0) {
        return order;
    }
    order = strcmp(a->change, b->change);
    if (order != 0) {
        return order;
    }
    json_int_t repeat_a = json_integer_value(json_object_get(a->row, "repeat"));
    json_int_t repeat_b = json_integer_value(json_object_get(b->row, "repeat"));
    if (repeat_a != repeat_b) {
        return repeat_a < repeat_b ? -1 : 1;
    }
    order = strcmp(pl_json_get_text(a->row, "started"), pl_json_get_text(b->row, "started"));
    return order != 0 ? order : (a->index > b->index) - (a->index < b->index);
}

void pl_keyed_rows_sort(pl_keyed_row *rows, size_t count)
{
    qsort(rows, count, sizeof *rows, compare_repeats);
}

bool pl_keyed_row_is_same_point(const pl_keyed_row *a, const pl_keyed_row *b)
{
    return compare_rows(a, b) == 0;
}
