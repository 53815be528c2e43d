/* Results made by hand, and what the report says of them. */
#include "report_rows.h"

#include "report/page_data.h"
#include "report/report.h"

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char hostile_text[] =
    "<script>alert(\"x\")</script>, 'a'|b\r\nhttps://x.y & `Grüße` \\ ]]> -->";

json_t *metric_value(double value)
{
    return json_pack("{s:f}", "value", value);
}

/* A run whose engine is the part of `label` before its colon. */
static json_t *run_of(const char *scenario, const char *label, const char *outcome)
{
    json_t *row = json_pack(
        "{s:s, s:s, s:s, s:{}, s:s, s:s, s:s%, s:s, s:s, s:s, s:{s:f, s:f, s:i, s:f}, s:i, s:i, "
        "s:s, s:n, "
        "s:{s:i, s:i}, s:{}, s:n, s:n, s:{s:s, s:s, s:s, s:s}, s:{s:s, s:s}, s:[s, s], s:s}",
        "schema", "plumb.result/1", "run", "00", "scenario", scenario, "params", "scene_hash",
        "cafe", "primary_error", "drift", "engine", label, strcspn(label, ":"), "profile", "p",
        "engine_version", "1.0", "label", label, "settings", "dt", 0.01, "duration", 0.1,
        "iterations", 2000000, "erp", 0.2, "seed", 0, "repeat", 0, "outcome", outcome, "reason",
        "steps", "asked", 10, "done", 10, "metrics", "final_poses", "output", "host", "cpu", "one",
        "os", "linux", "compiler", "gcc", "flags", "-O2", "plumb", "version", "0.1.0", "git", "abc",
        "command", "plumb", "compare", "started", "2026-01-01T00:00:00Z");
    assert_non_null(row);
    return row;
}

void set_metric(json_t *row, const char *metric, json_t *value)
{
    int failed = json_object_set_new(json_object_get(row, "metrics"), metric, value);
    assert_int_equal(failed, 0);
}

json_t *add_run(json_t *results, const char *scenario, const char *label, const char *outcome)
{
    json_t *row = run_of(scenario, label, outcome);
    json_array_append_new(results, row);
    return row;
}

void set_verdict(json_t *row, const char *verdict, const char *reason)
{
    json_object_set_new(row, "verdict", verdict == NULL ? json_null() : json_string(verdict));
    json_object_set_new(row, "verdict_reason", json_string(reason));
}

json_t *two_runs(const char *metric, double ours, double theirs)
{
    json_t *results = json_array();
    set_metric(add_run(results, "pair", "plumb:fast", "ok"), metric, metric_value(ours));
    set_metric(add_run(results, "pair", "ode:quick", "ok"), metric, metric_value(theirs));
    return results;
}

json_t *runs_of_every_kind(void)
{
    static const char *const outcomes[] = {"ok",      "collapsed", "diverged",   "nonfinite",
                                           "crashed", "timeout",   "unsupported"};
    json_t *results = json_array();
    for (int i = 0; i < 7; ++i) {
        char label[32];
        snprintf(label, sizeof label, "%s", i == 0 ? "plumb:fast" : "");
        if (i > 0) {
            snprintf(label, sizeof label, "engine%d:p", i);
        }
        json_t *row = add_run(results, "kinds", label, outcomes[i]);
        if (i == 0) {
            json_object_set_new(row, "engine_version", json_string(hostile_text));
        }
        if (i > 0) {
            json_object_set_new(row, "reason", json_string(hostile_text));
        }
        if (i == 4) {
            json_object_set_new(row, "output", json_string(hostile_text));
        }
        if (i < 4) {
            set_metric(row, "drift", metric_value(1e-3 * (i + 1)));
        }
        if (i < 4) {
            set_metric(row, "reference_error", metric_value(1e-3 * (i + 1)));
        }
    }
    json_t *row = add_run(results, hostile_text, "plumb:fast", "ok");
    json_object_set_new(row, "engine_version", json_string(hostile_text));
    set_metric(
        row, "settle_time",
        json_pack("{s:n, s:s, s:s}", "value", "unit", "s", "reason", "moves to the end <&>"));
    row = add_run(results, hostile_text, hostile_text, "ok");
    json_object_set_new(json_object_get(row, "host"), "cpu", json_string(hostile_text));
    set_metric(row, "settle_time", metric_value(0.5));
    return results;
}

made_report make_report(json_t *results)
{
    made_report made = {.results = results, .table = table_of(results)};
    made.report = pl_report_build(made.table);
    json_t *data = pl_page_data(&made.report);
    made.data = json_dumps(data, JSON_COMPACT | JSON_REAL_PRECISION(17));
    assert_non_null(made.data);
    json_decref(data);
    pl_document document = {0};
    pl_report_document(&made.report, PL_READER_SUMMARY, &document);
    made.markdown = pl_document_markdown(&document);
    pl_document_free(&document);
    return made;
}

void free_report(made_report *made)
{
    pl_report_free(&made->report);
    free_table(made->table);
    free(made->data);
    free(made->markdown);
    json_decref(made->results);
}

char *printed_table(const json_t *results, bool colour, int width)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    pl_result_table *made = table_of(results);
    pl_report_print(out, made, colour, width);
    free_table(made);
    fclose(out);
    return text;
}
