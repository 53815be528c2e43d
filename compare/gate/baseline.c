/* Reads the baseline file, with the place of every fault, and writes it. */
#include "gate.h"

#include "base/json_text.h"
#include "results/store.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char schema_name[] = "plumb.baseline/1";
static const char *const file_keys[] = {"schema", "rows"};
static const char *const ratio_keys[] = {"reference", "value", "low", "high", "repeats"};
static const pl_key_set file_set = PL_KEY_SET("baseline", file_keys);
static const pl_key_set ratio_set = PL_KEY_SET("ratio", ratio_keys);

static bool read_schema(const json_t *json, pl_diagnostic *diagnostic)
{
    const char *schema = NULL;
    char quoted[PL_QUOTED_SIZE];
    return pl_json_string(json, "schema", PL_REQUIRED, "\"plumb.baseline/1\"", &schema,
                          diagnostic) &&
           (strcmp(schema, schema_name) == 0 ||
            pl_diagnose_field(diagnostic, "schema", "expected \"%s\", found %s", schema_name,
                              pl_quoted(schema, quoted)));
}

/* Checks that a row is an object of keys that there are: these, and the names of ratios. */
static bool check_keys(const json_t *row, pl_diagnostic *diagnostic)
{
    const char *keys[11 + PL_METRIC_COUNT] = {"scenario", "params",  "engine", "dt",
                                              "duration", "seed",    "member", "scene_hash",
                                              "outcome",  "verdict", "metrics"};
    pl_key_set set = {.object = "row", .keys = keys, .count = 11};
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        if (pl_metric_table[i].ratio != NULL) {
            keys[set.count++] = pl_metric_table[i].ratio;
        }
    }
    return pl_json_object(row, &set, diagnostic);
}

/* Checks an object of numbers, or, where `is_free`, of numbers, texts and nulls. */
static bool check_values(const json_t *row, const char *key, bool is_free,
                         pl_diagnostic *diagnostic)
{
    json_t *object = json_object_get(row, key);
    char found[PL_FOUND_SIZE];
    if (!json_is_object(object)) {
        return pl_diagnose_field(diagnostic, key, "expected an object, found %s",
                                 pl_json_found(object, found));
    }
    pl_path_push_key(&diagnostic->path, key);
    const char *name;
    json_t *value;
    json_object_foreach(object, name, value)
    {
        bool right =
            json_is_number(value) || (is_free && (json_is_string(value) || json_is_null(value)));
        if (!right) {
            return pl_diagnose_field(diagnostic, name, "expected a number%s, found %s",
                                     is_free ? ", a text or null" : "",
                                     pl_json_found(value, found));
        }
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool check_ratio(const json_t *row, const char *key, pl_diagnostic *diagnostic)
{
    const json_t *ratio = json_object_get(row, key);
    const char *reference = NULL;
    if (ratio == NULL) {
        return true;
    }
    pl_path_push_key(&diagnostic->path, key);
    if (!pl_json_object(ratio, &ratio_set, diagnostic) ||
        !pl_json_string(ratio, "reference", PL_REQUIRED, "an engine", &reference, diagnostic)) {
        return false;
    }
    static const char *const numbers[] = {"value", "low", "high", "repeats"};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        double value = 0;
        if (!pl_json_number(ratio, numbers[i], PL_REQUIRED, &value, diagnostic)) {
            return false;
        }
        if (!(value > 0) || (i == 3 && (value != floor(value) || value > 1e9))) {
            return pl_diagnose_field(diagnostic, numbers[i], "expected a %s above 0, found %g",
                                     i == 3 ? "whole number" : "number", value);
        }
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* A row without the key has no verdict. */
static bool check_verdict(const json_t *json, pl_diagnostic *diagnostic)
{
    const json_t *value = json_object_get(json, "verdict");
    char found[PL_FOUND_SIZE];
    return value == NULL || pl_verdict_of(json) != PL_VERDICT_UNJUDGED ||
           pl_diagnose_field(diagnostic, "verdict",
                             "expected accurate, inaccurate or failed, found %s",
                             pl_json_found(value, found));
}

static bool check_row(const json_t *json, pl_diagnostic *diagnostic)
{
    const char *text = NULL;
    double number = 0;
    return check_keys(json, diagnostic) &&
           pl_json_string(json, "scenario", PL_REQUIRED, "a scenario", &text, diagnostic) &&
           pl_json_string(json, "engine", PL_REQUIRED, "an engine", &text, diagnostic) &&
           pl_json_string(json, "outcome", PL_REQUIRED, "an outcome", &text, diagnostic) &&
           check_verdict(json, diagnostic) &&
           pl_json_string(json, "scene_hash", PL_OPTIONAL, "a hash", &text, diagnostic) &&
           pl_json_number(json, "dt", PL_REQUIRED, &number, diagnostic) &&
           pl_json_number(json, "duration", PL_REQUIRED, &number, diagnostic) &&
           pl_json_number(json, "seed", PL_REQUIRED, &number, diagnostic) &&
           pl_json_number(json, "member", PL_OPTIONAL, &number, diagnostic) &&
           check_values(json, "params", false, diagnostic) &&
           check_values(json, "metrics", true, diagnostic);
}

static bool check_ratios(const json_t *row, pl_diagnostic *diagnostic)
{
    bool right = true;
    for (int i = 0; i < PL_METRIC_COUNT && right; ++i) {
        const char *ratio = pl_metric_table[i].ratio;
        right = ratio == NULL || check_ratio(row, ratio, diagnostic);
    }
    return right;
}

/* Checks that no earlier row is of the same run. */
static bool check_last(const pl_gate_rows *rows, pl_diagnostic *diagnostic)
{
    const int last = rows->count - 1;
    int twin = 0;
    while (strcmp(rows->items[twin].key, rows->items[last].key) != 0) {
        ++twin;
    }
    return twin == last ||
           pl_diagnose(diagnostic, "expected another run than rows[%d], found the same", twin);
}

static bool read_rows(const json_t *array, pl_gate_rows *rows, pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "rows");
    size_t index;
    json_t *json;
    json_array_foreach(array, index, json)
    {
        pl_path_push_index(&diagnostic->path, (int)index);
        if (!check_row(json, diagnostic) || !check_ratios(json, diagnostic)) {
            return false;
        }
        pl_gate_rows_add(rows, json_incref(json), NULL);
        if (!check_last(rows, diagnostic)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool read_baseline(const json_t *json, void *user, pl_diagnostic *diagnostic)
{
    const json_t *array = NULL;
    return pl_json_object(json, &file_set, diagnostic) && read_schema(json, diagnostic) &&
           pl_json_array(json, "rows", PL_REQUIRED, &array, diagnostic) &&
           read_rows(array, user, diagnostic);
}

static const pl_json_kind baseline_kind = {
    .noun = "baseline", .most_bytes = PL_GATE_BASELINE_MOST_BYTES, .read = read_baseline};

pl_status pl_gate_baseline_read(const char *path, pl_gate_rows *rows, pl_error *error)
{
    *rows = (pl_gate_rows){0};
    pl_status status = pl_json_read_file(&baseline_kind, path, rows, error);
    pl_gate_rows_sort(rows);
    return status;
}

pl_status pl_gate_baseline_write(const char *path, const pl_gate_rows *rows, pl_error *error)
{
    json_t *array = json_array();
    for (int i = 0; i < rows->count; ++i) {
        json_array_append(array, rows->items[i].json);
    }
    json_t *file = json_pack("{s:s, s:o}", "schema", schema_name, "rows", array);
    const pl_status status = pl_results_write_json(path, file, error);
    json_decref(file);
    return status;
}
