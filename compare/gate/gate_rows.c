#include "gate_rows.h"

#include "base/heap.h"
#include "results/result.h"

#include <stdlib.h>
#include <string.h>

static double number_of(const json_t *row, const char *key)
{
    return json_number_value(json_object_get(row, key));
}

static pl_case_identity identity_of(const json_t *json)
{
    const char *scenario = pl_json_get_text(json, "scenario");
    const bool is_member = json_object_get(json, "member") != NULL;
    return (pl_case_identity){.scenario = scenario,
                              .catalogue = pl_scenario_find(scenario, NULL),
                              .params = json_object_get(json, "params"),
                              .dt = number_of(json, "dt"),
                              .duration = number_of(json, "duration"),
                              .seed = (json_int_t)number_of(json, "seed"),
                              .member = is_member ? (int)number_of(json, "member") : -1};
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

/* For each row whether its name is shared. The caller frees. */
static bool *find_shared(const pl_gate_rows *rows, const pl_gate_rows *other)
{
    bool *shared = pl_heap_new((size_t)rows->count, sizeof *shared);
    for (int i = 0; i < rows->count; ++i) {
        shared[i] = has_same_name(rows, &rows->items[i]) || has_same_name(other, &rows->items[i]);
    }
    return shared;
}

static void complete_names(pl_gate_rows *rows, const bool *shared)
{
    for (int i = 0; i < rows->count; ++i) {
        const pl_case_identity identity = identity_of(rows->items[i].json);
        if (shared[i]) {
            pl_case_name_add(rows->items[i].name, " dt=%.6g duration=%.6g", identity.dt,
                             identity.duration);
        }
    }
}

void pl_gate_rows_disambiguate(pl_gate_rows *rows, pl_gate_rows *other)
{
    bool *shared = find_shared(rows, other), *other_shared = find_shared(other, rows);
    complete_names(rows, shared);
    complete_names(other, other_shared);
    free(shared);
    free(other_shared);
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

pl_metric_summary pl_gate_row_metric(const pl_gate_row *row, const char *metric)
{
    pl_metric_summary summary = pl_metric_summarise(row->cell->rows, row->cell->count, metric);
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
