/* The document of a tuning. */
#include "base/heap.h"
#include "base/json_field.h"
#include "results/result.h"
#include "tune_search.h"
#include "tuner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_true(const json_t *object, const char *key)
{
    return json_is_true(json_object_get(object, key));
}

/* A step as a user writes it, "1/240". */
static void write_step(double dt, char text[32])
{
    const double rate = 1 / dt;
    const bool is_whole = fabs(rate - nearbyint(rate)) < 1e-9 * rate;
    snprintf(text, 32, is_whole ? "1/%.0f" : "%.9g", is_whole ? nearbyint(rate) : dt);
}

static void add_margin(pl_table *table, double excess)
{
    const double clear = 1e6, ratio = exp(fabs(excess));
    if (excess >= PL_SEARCH_WORST || isnan(excess)) {
        pl_table_add(table, "no value");
    } else if (ratio >= clear) {
        pl_table_add(table, excess <= 0 ? "clear of the target" : "far from the target");
    } else {
        pl_table_format_cell(table, "%.3g x %s the target", ratio, excess <= 0 ? "below" : "above");
    }
}

/* The metrics of the targets, each once. */
static json_t *metrics_of(const json_t *conclusion)
{
    json_t *names = json_object(), *target;
    size_t index;
    json_array_foreach(json_object_get(conclusion, "targets"), index, target)
    {
        const char *text = json_string_value(target);
        char *name = pl_heap_format("%.*s", text == NULL ? 0 : (int)strcspn(text, "<"), text);
        json_object_set_new(names, name, json_null());
        free(name);
    }
    return names;
}

static void add_metric_columns(pl_table *table, const json_t *metrics, const char *prefix)
{
    const char *name;
    json_t *unused;
    json_object_foreach((json_t *)metrics, name, unused)
    {
        pl_table_column(table, PL_RIGHT, "%s%s", prefix, name);
    }
}

static void add_metrics(pl_table *table, const json_t *metrics, const json_t *values)
{
    const char *name;
    json_t *unused;
    json_object_foreach((json_t *)metrics, name, unused)
    {
        pl_table_number(table, pl_study_number(values, name), 3);
    }
}

static void add_settings(pl_document *document, const json_t *conclusion)
{
    const json_t *setting = json_object_get(conclusion, "setting");
    const json_t *api = json_object_get(setting, "api");
    const double dt = pl_study_number(setting, "dt");
    char step[32];
    write_step(dt, step);
    pl_document_paragraph(document, "--engine %s --dt %s", pl_study_text(setting, "spec"), step);
    if (json_array_size(api) > 0) {
        size_t index;
        json_t *line;
        pl_document_paragraph(document, "In its own API:");
        json_array_foreach((json_t *)api, index, line)
        {
            const char *text = json_string_value(line);
            pl_document_item(document, "%s", text == NULL ? "" : text);
        }
    }
}

static void add_scores(pl_document *document, const json_t *conclusion, const json_t *metrics)
{
    pl_table table = {.keys = 1};
    size_t index;
    json_t *score;
    pl_document_paragraph(
        document,
        is_true(conclusion, "cost_is_ratio")
            ? "Cost: %.3g x that of the default settings at the scenarios' own step."
            : "Cost: %.3g s of CPU time per simulated second; the default settings have none.",
        pl_study_number(conclusion, "cost"));
    pl_table_columns(&table, "scenario|>cost x|>s per simulated s|outcome");
    add_metric_columns(&table, metrics, "");
    pl_table_columns(&table, "margin|by default");
    add_metric_columns(&table, metrics, "default ");
    json_array_foreach(json_object_get(conclusion, "on"), index, score)
    {
        pl_table_add(&table, pl_study_text(score, "scenario"));
        pl_table_number(&table, pl_study_number(score, "cost_ratio"), 3);
        pl_table_number(&table, pl_study_number(score, "seconds"), 3);
        pl_table_add(&table, pl_study_text(score, "outcome"));
        add_metrics(&table, metrics, json_object_get(score, "metrics"));
        add_margin(&table, pl_study_number(score, "excess"));
        pl_table_add(&table, pl_study_text(score, "shipped_outcome"));
        add_metrics(&table, metrics, json_object_get(score, "shipped_metrics"));
    }
    pl_document_table(document, "The scenarios as asked for", &table);
}

static void add_value(pl_table *table, const char *key, double value)
{
    char text[32];
    if (strcmp(key, "dt") == 0) {
        write_step(value, text);
        pl_table_add(table, text);
    } else {
        pl_table_number(table, value, 6);
    }
}

static void add_sensitivities(pl_document *document, const json_t *conclusion)
{
    pl_table table = {.keys = 1};
    size_t index;
    json_t *moved;
    pl_table_columns(&table, "parameter|>from|>to|>cost x|margin");
    json_array_foreach(json_object_get(conclusion, "sensitivity"), index, moved)
    {
        const char *key = pl_study_text(moved, "key");
        pl_table_add(&table, key);
        add_value(&table, key, pl_study_number(moved, "from"));
        add_value(&table, key, pl_study_number(moved, "to"));
        pl_table_number(&table, pl_study_number(moved, "cost_ratio"), 3);
        add_margin(&table, pl_study_number(moved, "excess"));
    }
    if (pl_table_rows(&table) > 0) {
        pl_document_heading(document, "Each parameter moved by 10 %% or one step");
    }
    pl_document_table(document, "Sensitivity, on the scenarios as asked for", &table);
}

static void add_checks(pl_document *document, const json_t *conclusion, const json_t *metrics)
{
    const json_t *checks = json_object_get(conclusion, "validation");
    const size_t count = json_array_size(checks);
    const int passed_over = (int)pl_study_number(conclusion, "passed_over");
    pl_table table = {.keys = 2};
    size_t index;
    int missed = 0;
    json_t *check;
    pl_table_columns(&table, "scenario|changed by|outcome");
    add_metric_columns(&table, metrics, "");
    pl_table_columns(&table, "margin");
    json_array_foreach((json_t *)checks, index, check)
    {
        pl_table_add(&table, pl_study_text(check, "scenario"));
        pl_table_add(&table, pl_study_text(check, "variant"));
        pl_table_add(&table, pl_study_text(check, "outcome"));
        add_metrics(&table, metrics, json_object_get(check, "metrics"));
        add_margin(&table, pl_study_number(check, "excess"));
        missed += pl_study_number(check, "excess") > 0;
    }
    pl_document_heading(document, "Validation");
    if (count == 0) {
        pl_document_paragraph(document,
                              "Not validated: the scenarios have no parameters to change.");
    } else if (missed == 0) {
        pl_document_paragraph(document, "All of %zu runs that were not tuned on meet the target.",
                              count);
    } else {
        pl_document_paragraph(
            document,
            "%d of %zu runs that were not tuned on miss the target: these settings "
            "are fitted to the scenarios as asked for.",
            missed, count);
    }
    if (passed_over > 0) {
        pl_document_paragraph(
            document, "%d settings that are cheaper, or nearer to a margin, missed it there.",
            passed_over);
    }
    pl_document_table(document, "Runs on changed scenarios", &table);
}

/* Cost against excess of all trials. */
static void add_plot(pl_document *document, const json_t *conclusion)
{
    json_t *trial, *plot = pl_plot_make(PL_PLOT_POINTS, "Settings tried",
                                        is_true(conclusion, "cost_is_ratio")
                                            ? "cost, over that of the default settings"
                                            : "cost (s per simulated second)",
                                        "largest value over its target: met at 1 and below");
    const json_t *trials = json_object_get(conclusion, "trials");
    pl_document_heading(document, "The search");
    double *numbers = pl_heap_new(2 * json_array_size(trials) + 1, sizeof *numbers);
    for (int met = 1; met >= 0; --met) {
        size_t index;
        int count = 0;
        json_array_foreach((json_t *)trials, index, trial)
        {
            const double cost = pl_study_number(trial, "cost"),
                         excess = pl_study_number(trial, "excess");
            if (isfinite(cost) && excess < PL_SEARCH_WORST && (excess <= 0) == met) {
                numbers[count++] = cost;
                numbers[count++] = exp(excess);
            }
        }
        if (count > 0) {
            pl_plot_row(plot, met ? "meets the targets" : "misses them", numbers, count);
        }
    }
    free(numbers);
    pl_document_plot(document, plot);
}

void pl_tune_fill_document(const json_t *conclusion, pl_document *document)
{
    const bool met = is_true(conclusion, "met");
    json_t *metrics = metrics_of(conclusion), *target;
    pl_text_buffer targets = {0};
    size_t index;
    json_array_foreach(json_object_get(conclusion, "targets"), index, target)
    {
        const char *text = json_string_value(target);
        pl_text_format(&targets, "%s%s", index == 0 ? "" : " and ", text == NULL ? "" : text);
    }
    char *all = pl_text_take(&targets);
    document->title = "Settings found by tuning";
    pl_document_heading(
        document,
        met ? "%s:%s, the cheapest found for %s" : "%s:%s: no settings found meet %s; the nearest",
        pl_study_text(conclusion, "engine"), pl_study_text(conclusion, "profile"), all);
    if (json_is_false(json_object_get(conclusion, "finished"))) {
        pl_document_paragraph(document,
                              "The tuning has not come to its end: this follows from its runs so "
                              "far, and plumb tune --resume goes on.");
    }
    add_settings(document, conclusion);
    add_scores(document, conclusion, metrics);
    add_sensitivities(document, conclusion);
    if (met && !is_true(conclusion, "has_margin")) {
        pl_document_paragraph(
            document, "The errors of the runs tuned on scatter so much that another may miss the "
                      "target: no settings found have two standard deviations to spare.");
    }
    if (met) {
        add_checks(document, conclusion, metrics);
    }
    add_plot(document, conclusion);
    pl_document_paragraph(
        document, "%zu settings were tried in %d runs. The search measured cost as %s.",
        json_array_size(json_object_get(conclusion, "trials")),
        (int)pl_study_number(conclusion, "runs"),
        strcmp(pl_study_text(conclusion, "search_cost"), "instructions") == 0
            ? "instructions per step"
            : "CPU time, in turns with the default settings, because instructions are not counted "
              "here");
    free(all);
    json_decref(metrics);
}
