#include "sweep_analysis_rows.h"

#include "check.h"
#include "result_tables.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static json_t *value_of(double value)
{
    return isnan(value) ? json_pack("{s:n, s:s}", "value", "unit", "1")
                        : json_pack("{s:f, s:s}", "value", value, "unit", "1");
}

json_t *add_sweep_run(json_t *results, sweep_run run)
{
    const double dt = run.dt == 0 ? 1.0 / 64 : run.dt;
    const char *profile = strchr(run.engine, ':') + 1;
    char label[128];
    snprintf(label, sizeof label, run.shipped ? "%s" : "%s,iterations=%d", run.engine,
             run.iterations);
    json_t *row = json_pack(
        "{s:s, s:s, s:s, s:{s:i, s:f}, s:s, s:s%, s:s, s:s, s:s, s:{s:f, s:f, s:i}, s:i, s:i, s:s, "
        "s:n, s:{s:o, s:o}, s:{s:s}, s:{s:s, s:s}}",
        "schema", "plumb.result/1", "run", "00", "scenario", run.scenario, "params", "n", run.n,
        "dt", dt, "primary_error", "travel_error", "engine", run.engine,
        (int)(profile - 1 - run.engine), "profile", profile, "engine_version", "1.0", "label",
        label, "settings", "dt", dt, "duration", 2.0, "iterations", run.iterations, "seed", 0,
        "repeat", run.repeat, "outcome", run.outcome == NULL ? "ok" : run.outcome, "reason",
        "metrics", "travel_error", value_of(run.error), "time_per_step", value_of(run.cost * dt),
        "host", "cpu", "one", "plumb", "version", "0.1.0", "git", "abc");
    assert_non_null(row);
    json_object_set_new(row, "as_shipped", json_boolean(run.shipped));
    if (run.change != NULL) {
        json_object_set_new(row, "change", json_string(run.change));
    }
    assert_int_equal(json_array_append_new(results, row), 0);
    return row;
}

void add_repeats(json_t *results, sweep_run run, const double *costs, int count)
{
    for (int i = 0; i < count; ++i) {
        run.repeat = i;
        run.cost = costs[i];
        add_sweep_run(results, run);
    }
}

pl_sweep_analysis analysis_of(const json_t *results)
{
    pl_sweep_analysis analysis;
    pl_sweep_analyse(table_of(results), &analysis);
    return analysis;
}

char *document_of(const pl_sweep_analysis *analysis)
{
    json_t *json = pl_sweep_to_json(analysis);
    pl_document document = {.title = ""};
    pl_sweep_study.document(json, &document);
    char *text = pl_document_text(&document, 300);
    pl_document_free(&document);
    json_decref(json);
    return text;
}

json_t *losses_of(const pl_sweep_analysis *analysis)
{
    json_t *json = pl_sweep_to_json(analysis);
    json_t *losses = json_incref(json_object_get(json, "losses"));
    json_decref(json);
    return losses;
}

int engine_named(const pl_sweep_analysis *analysis, const char *name)
{
    for (int i = 0; i < analysis->engine_count; ++i) {
        if (strcmp(analysis->engines[i].name, name) == 0) {
            return i;
        }
    }
    fail_msg("no engine %s", name);
    return -1;
}

int pair_named(const pl_sweep_analysis *analysis, const char *ours, const char *other)
{
    for (int i = 0; i < analysis->pair_count; ++i) {
        if (analysis->pairs[i].first == engine_named(analysis, ours) &&
            analysis->pairs[i].second == engine_named(analysis, other)) {
            return i;
        }
    }
    fail_msg("no pair %s, %s", ours, other);
    return -1;
}

const pl_pairwise_comparison *comparison_with(const pl_sweep_analysis *analysis, const char *other)
{
    return &analysis->scenes[0].comparisons[pair_named(analysis, "plumb", other)];
}

json_t *crossing_sweep(void)
{
    json_t *results = json_array();
    add_sweep_run(results, (sweep_run){.scenario = "a", "plumb:p", 2, 1e-4});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 1, 1e-2, .iterations = 1});
    add_sweep_run(results, (sweep_run){.scenario = "a", "ode:q", 8, 1e-4, .iterations = 9});
    return results;
}

void finish_sweep(pl_sweep_analysis *analysis, json_t *results)
{
    free_table(analysis->results);
    pl_sweep_analysis_free(analysis);
    json_decref(results);
}
