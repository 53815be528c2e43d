/* Rows: gathered from the cells of a table of results, or read from a baseline file with the place of every fault. */
#include "gate.h"

#include "base/folding.h"
#include "base/heap.h"
#include "base/json_field.h"
#include "base/json_text.h"
#include "results/store.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static pl_case_identity identity_of(const json_t *json)
{
    const char *scenario = pl_json_get_text(json, "scenario");
    const bool is_member = json_object_get(json, "member") != NULL;
    return (pl_case_identity){.scenario = scenario,
                              .catalogue = pl_scenario_find(scenario, NULL),
                              .params = json_object_get(json, "params"),
                              .dt = pl_json_get_number(json, "dt"),
                              .duration = pl_json_get_number(json, "duration"),
                              .seed = (json_int_t)pl_json_get_number(json, "seed"),
                              .member = is_member ? (int)pl_json_get_number(json, "member") : -1};
}

/* Adds a row of an object, which it takes, and whose members are there and of the right types. */
static void add_row(pl_gate_rows *rows, json_t *json, const pl_result_cell *cell)
{
    const pl_case_identity identity = identity_of(json);
    char *key = pl_case_key(&identity);
    pl_gate_row row = {.json = json,
                       .scenario = identity.scenario,
                       .label = pl_json_get_text(json, "engine"),
                       .outcome = pl_json_get_text(json, "outcome"),
                       .verdict = pl_verdict_of(json),
                       .metrics = json_object_get(json, "metrics"),
                       .cell = cell,
                       .reason = cell == NULL ? "" : cell->worst->reason,
                       .verdict_reason =
                           cell == NULL ? ""
                                        : pl_json_get_text(cell->worst->result, "verdict_reason")};
    row.key = pl_heap_format("%s%s", key, row.label);
    free(key);
    pl_case_name(&identity, row.name);
    pl_push(&rows->items, &rows->count, &row, sizeof row);
}

static int compare_rows(const void *left, const void *right)
{
    const pl_gate_row *a = left, *b = right;
    return strcmp(a->key, b->key);
}

static void sort_rows(pl_gate_rows *rows)
{
    if (rows->count > 0) {
        qsort(rows->items, (size_t)rows->count, sizeof *rows->items, compare_rows);
    }
}

/* Whether another run of the engine has the same name. */
static bool has_same_name(const pl_gate_rows *rows, const pl_gate_row *row)
{
    for (int i = 0; i < rows->count; ++i) {
        const pl_gate_row *other = &rows->items[i];
        if (strcmp(other->label, row->label) == 0 && strcmp(other->name, row->name) == 0 &&
            strcmp(other->key, row->key) != 0) {
            return true;
        }
    }
    return false;
}

static void complete_names(pl_gate_rows *rows)
{
    for (int i = 0; i < rows->count; ++i) {
        const pl_case_identity identity = identity_of(rows->items[i].json);
        if (rows->items[i].is_shared) {
            pl_case_name_add(rows->items[i].name, " dt=%.6g duration=%.6g", identity.dt,
                             identity.duration);
        }
    }
}

void pl_gate_rows_disambiguate(pl_gate_rows *rows, pl_gate_rows *other)
{
    for (int i = 0; i < rows->count + other->count; ++i) {
        pl_gate_row *row = i < rows->count ? &rows->items[i] : &other->items[i - rows->count];
        row->is_shared = has_same_name(rows, row) || has_same_name(other, row);
    }
    complete_names(rows);
    complete_names(other);
}

const pl_gate_row *pl_gate_rows_find(const pl_gate_rows *rows, const char *key)
{
    const pl_gate_row wanted = {.key = (char *)key};
    return rows->count == 0 ? NULL
                            : bsearch(&wanted, rows->items, (size_t)rows->count,
                                      sizeof *rows->items, compare_rows);
}

bool pl_gate_row_is_ok(const pl_gate_row *row)
{
    return strcmp(row->outcome, "ok") == 0;
}

pl_metric_summary pl_gate_cell_metric(const pl_result_cell *cell, const char *metric)
{
    pl_metric_summary summary = pl_metric_summarise(cell->rows, cell->count, metric);
    if (summary.state == PL_METRIC_VALUE && summary.reason != NULL) {
        summary.state = PL_METRIC_FAILED;
    }
    return summary;
}

int pl_gate_cost_of(const char *name)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[i];
        if (info->ratio != NULL &&
            (strcmp(info->name, name) == 0 || strcmp(info->ratio, name) == 0)) {
            return i;
        }
    }
    return -1;
}

void pl_gate_rows_free(pl_gate_rows *rows)
{
    for (int i = 0; i < rows->count; ++i) {
        json_decref(rows->items[i].json);
        free(rows->items[i].key);
    }
    free(rows->items);
    *rows = (pl_gate_rows){0};
}

/* ---- From results ---- */

pl_status pl_gate_read(const char *path, json_t **results, pl_error *error)
{
    struct stat found;
    long long whole = 0;
    const bool is_folder = stat(path, &found) == 0 && S_ISDIR(found.st_mode);
    char *file = pl_heap_format("%s%s", path, is_folder ? "/results.jsonl" : "");
    *results = NULL;
    pl_status status = pl_results_read(file, results, &whole, error);
    if (status == PL_OK && stat(file, &found) == 0 && S_ISREG(found.st_mode) &&
        found.st_size > whole) {
        pl_print_line(stderr, "%s: the last line is not whole, and left out", file);
    }
    free(file);
    return status;
}

/* The value as a baseline keeps it: of numbers the median. */
static json_t *value_of(const pl_metric_summary *summary)
{
    return summary->state == PL_METRIC_VALUE  ? json_real(summary->value)
           : summary->state == PL_METRIC_TEXT ? json_string(summary->text)
                                              : json_null();
}

/* The metrics that a baseline keeps: none of a run that is not ok, and those that differ from run to run only where
 * a tolerance is given. */
static json_t *metrics_of(const pl_result_cell *cell, const pl_gate_tolerances *tolerances)
{
    json_t *kept = json_object(), *metric;
    const char *name;
    for (int i = 0; i < cell->count && pl_result_cell_is_ok(cell); ++i) {
        json_object_foreach((json_t *)cell->rows[i].metrics, name, metric)
        {
            const int id = pl_metric_by_name(name);
            const bool is_asked = id >= 0 && tolerances->of[id].given && !tolerances->of[id].off;
            const bool is_kept = is_asked || pl_metric_is_deterministic(metric, id);
            if (is_kept && pl_gate_cost_of(name) < 0 && json_object_get(kept, name) == NULL) {
                const pl_metric_summary summary = pl_gate_cell_metric(cell, name);
                json_object_set_new(kept, name, value_of(&summary));
            }
        }
    }
    return kept;
}

static json_t *row_json(const pl_result_cell *cell, const pl_gate_tolerances *tolerances)
{
    const pl_result_row *row = cell->worst;
    const pl_case_identity identity = pl_result_row_identity(row);
    json_t *json = json_pack(
        "{s:s, s:o, s:s, s:f, s:f, s:I, s:s, s:s, s:o}", "scenario", row->scenario, "params",
        pl_case_params(&identity), "engine", row->label, "dt", row->dt, "duration", row->duration,
        "seed", row->seed, "scene_hash", row->scene_hash, "outcome", pl_outcome_name(row->outcome),
        "metrics", metrics_of(cell, tolerances));
    if (row->member >= 0) {
        json_object_set_new(json, "member", json_integer(row->member));
    }
    if (row->verdict != PL_VERDICT_UNJUDGED) {
        json_object_set_new(json, "verdict", json_string(pl_verdict_name(row->verdict)));
    }
    return json;
}

void pl_gate_gather(const pl_result_table *results, const pl_gate_tolerances *tolerances,
                    pl_gate_rows *rows)
{
    *rows = (pl_gate_rows){.results = results};
    for (int i = 0; i < results->cell_count; ++i) {
        const pl_result_cell *cell = &results->cells[i];
        add_row(rows, row_json(cell, tolerances), cell);
    }
    sort_rows(rows);
}

/* ---- Baseline files ---- */

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
        add_row(rows, json_incref(json), NULL);
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
    .noun = "baseline", .most_bytes = 64 << 20, .read = read_baseline};

pl_status pl_gate_baseline_read(const char *path, pl_gate_rows *rows, pl_error *error)
{
    *rows = (pl_gate_rows){0};
    pl_status status = pl_json_read_file(&baseline_kind, path, rows, error);
    sort_rows(rows);
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
