/* Reads files of results, and makes rows of their cells. */
#include "gather.h"

#include "base/folding.h"
#include "base/heap.h"
#include "ratio.h"
#include "results/store.h"

#include <stdlib.h>
#include <sys/stat.h>

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
    const pl_gate_row row = {.cell = cell};
    json_t *kept = json_object(), *metric;
    const char *name;
    for (int i = 0; i < cell->count && pl_result_cell_is_ok(cell); ++i) {
        json_object_foreach((json_t *)cell->rows[i].metrics, name, metric)
        {
            const int id = pl_metric_by_name(name);
            const bool is_asked = id >= 0 && tolerances->of[id].given && !tolerances->of[id].off;
            const bool is_kept = is_asked || pl_metric_is_deterministic(metric, id);
            if (is_kept && pl_gate_cost_of(name) < 0 && json_object_get(kept, name) == NULL) {
                const pl_metric_summary summary = pl_gate_row_metric(&row, name);
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
