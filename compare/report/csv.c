/* Results as CSV, RFC 4180 (Shafranovich 2005). */
#include "csv.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Keys of a row; "a.b" is key b of the object a. */
static const char *const run_columns[] = {
    "run",        "scenario",      "params",         "scene_hash", "seed",     "repeat",
    "engine",     "profile",       "engine_version", "label",      "settings", "outcome",
    "reason",     "steps.asked",   "steps.done",     "host.cpu",   "host.os",  "host.compiler",
    "host.flags", "plumb.version", "plumb.git",      "started"};
static const char *const metric_columns[] = {"value", "unit", "direction",  "deterministic", "p50",
                                             "p95",   "p99",  "worst_step", "reason"};
enum {
    RUN_COLUMNS = sizeof run_columns / sizeof run_columns[0],
    METRIC_COLUMNS = sizeof metric_columns / sizeof metric_columns[0]
};

static void add_value(const json_t *value, pl_text_buffer *out)
{
    char *text = NULL;
    switch (value == NULL ? JSON_NULL : json_typeof(value)) {
    case JSON_NULL:
        return;
    case JSON_STRING:
        pl_text_add_csv(out, json_string_value(value));
        return;
    case JSON_REAL:
        pl_text_format(out, "%.17g", json_real_value(value));
        return;
    case JSON_INTEGER:
        pl_text_format(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        return;
    case JSON_TRUE:
    case JSON_FALSE:
        pl_text_add(out, json_is_true(value) ? "true" : "false");
        return;
    case JSON_OBJECT:
    case JSON_ARRAY:
        text = json_dumps(value, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
        if (text == NULL)
            out->failed = true;
        else
            pl_text_add_csv(out, text);
        free(text);
        return;
    }
}

static const json_t *value_at(const json_t *row, const char *column)
{
    const char *dot = strchr(column, '.');
    if (dot == NULL)
        return json_object_get(row, column);
    char object[32];
    snprintf(object, sizeof object, "%.*s", (int)(dot - column), column);
    return json_object_get(json_object_get(row, object), dot + 1);
}

/* `name` and `metric` are NULL for a run without metrics. */
static void add_line(const json_t *row, const char *name, const json_t *metric, pl_text_buffer *out)
{
    for (int i = 0; i < RUN_COLUMNS; i++) {
        add_value(value_at(row, run_columns[i]), out);
        pl_text_add(out, ",");
    }
    if (name != NULL)
        pl_text_add_csv(out, name);
    for (int i = 0; i < METRIC_COLUMNS; i++) {
        pl_text_add(out, ",");
        add_value(json_object_get(metric, metric_columns[i]), out);
    }
    pl_text_add(out, "\r\n");
}

static void add_header(pl_text_buffer *out)
{
    for (int i = 0; i < RUN_COLUMNS; i++) {
        for (const char *c = run_columns[i]; *c != '\0'; c++)
            pl_text_format(out, "%c", *c == '.' ? '_' : *c);
        pl_text_add(out, ",");
    }
    pl_text_add(out, "metric");
    for (int i = 0; i < METRIC_COLUMNS; i++) /* "reason" is the run's */
        pl_text_format(out, ",%s%s", strcmp(metric_columns[i], "reason") == 0 ? "metric_" : "",
                       metric_columns[i]);
    pl_text_add(out, "\r\n");
}

void pl_csv_write(json_t *results, pl_text_buffer *out)
{
    add_header(out);
    size_t index;
    json_t *row;
    json_array_foreach(results, index, row)
    {
        json_t *metrics = json_object_get(row, "metrics");
        if (json_object_size(metrics) == 0)
            add_line(row, NULL, NULL, out);
        const char *name;
        json_t *metric;
        json_object_foreach(metrics, name, metric)
        {
            add_line(row, name, metric, out);
        }
    }
}
