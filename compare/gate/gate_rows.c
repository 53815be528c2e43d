/* Rows: of a baseline's objects, or gathered from the cells of a table of results. */
#include "gate.h"

#include "base/folding.h"
#include "base/heap.h"
#include "base/json_get.h"
#include "results/store.h"

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

void pl_gate_rows_add(pl_gate_rows *rows, json_t *json, const pl_result_cell *cell)
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

void pl_gate_rows_sort(pl_gate_rows *rows)
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
        pl_gate_rows_add(rows, row_json(cell, tolerances), cell);
    }
    pl_gate_rows_sort(rows);
}
