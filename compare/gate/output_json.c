/* plumb.gate/1. */
#include "output.h"
#include "results/result.h"

#include <stdlib.h>
#include <string.h>

static json_t *text_or_null(const char *text)
{
    return text[0] == '\0' ? json_null() : pl_json_text(text, strlen(text));
}

static json_t *finding_json(const pl_gate_finding *finding)
{
    json_t *json =
        json_pack("{s:s, s:o, s:o, s:o, s:o}", "metric", finding->metric, "before",
                  text_or_null(finding->before), "after", text_or_null(finding->after), "allowed",
                  text_or_null(finding->limit), "what", text_or_null(finding->what));
    int failed = json == NULL;
    if (!failed && finding->row != NULL) {
        const json_t *row = finding->row->json;
        static const char *const keys[] = {"scenario", "params", "engine", "dt",
                                           "duration", "seed",   "member"};
        for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
            json_t *value = json_object_get(row, keys[i]);
            failed |= value != NULL && json_object_set(json, keys[i], value) != 0;
        }
    } else if (!failed) {
        failed |= json_object_set_new(json, "rows", json_integer(finding->row_count)) != 0;
    }
    if (failed) {
        json_decref(json);
        return NULL;
    }
    return json;
}

/* NULL: out of memory. */
static json_t *findings_json(const pl_gate_report *report, bool is_failure)
{
    json_t *array = json_array();
    for (int i = 0; i < report->count; ++i) {
        if (report->items[i].is_failure == is_failure &&
            json_array_append_new(array, finding_json(&report->items[i])) != 0) {
            json_decref(array);
            return NULL;
        }
    }
    return array;
}

void pl_gate_write_json(const pl_gate_report *report, pl_text_buffer *buffer)
{
    const char *verdict = report->failures > 0       ? "failed"
                          : report->comparisons == 0 ? "nothing compared"
                                                     : "passed";
    json_t *json =
        json_pack("{s:s, s:s, s:i, s:i, s:o, s:o}", "schema", "plumb.gate/1", "verdict", verdict,
                  "rows", report->now->count, "comparisons", report->comparisons, "failures",
                  findings_json(report, true), "notices", findings_json(report, false));
    char *text = json == NULL
                     ? NULL
                     : json_dumps(json, JSON_INDENT(1) | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
    if (text == NULL) {
        buffer->failed = true;
    } else {
        pl_text_add(buffer, text);
        pl_text_add(buffer, "\n");
    }
    free(text);
    json_decref(json);
}
