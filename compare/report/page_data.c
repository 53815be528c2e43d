#include "page_data.h"

#include "base/heap.h"
#include "base/number_format.h"
#include "base/program_name.h"
#include "results/result.h"
#include "sections.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The file of words, which compare/CMakeLists.txt builds into the program. */
extern const char pl_engines_json[];

enum { MOST_BODIES = 2000, MOST_OUTPUT = 4000 };

static json_t *text_or_null(const char *text)
{
    return text == NULL ? json_null() : pl_json_text(text);
}

/* Sets a text, which may be any bytes; nothing where it is NULL or empty. */
static void set_text(json_t *object, const char *key, const char *text)
{
    if (text != NULL && text[0] != '\0') {
        json_object_set_new(object, key, text_or_null(text));
    }
}

/* ---- What does not belong to one case ---- */

/* Where and when the results were made: each value is the key of an object. */
static json_t *provenance_json(const pl_result_table *results)
{
    static const char *const facts[][3] = {
        {"Processor", "host", "cpu"},     {"System", "host", "os"},
        {"Compiler", "host", "compiler"}, {"Flags", "host", "flags"},
        {"Plumb", PL_PROGRAM, "version"}, {"Commit", PL_PROGRAM, "git"}};
    const char *first = "", *last = "";
    json_t *object = json_object();
    for (size_t k = 0; k < sizeof facts / sizeof facts[0]; ++k) {
        json_t *seen = json_object();
        for (int i = 0; i < results->row_count; ++i) {
            json_object_set_new(seen,
                                pl_result_text(results->rows[i].result, facts[k][1], facts[k][2]),
                                json_true());
        }
        json_object_set_new(object, facts[k][0], seen);
    }
    for (int i = 0; i < results->row_count; ++i) {
        const char *started = pl_json_get_text(results->rows[i].result, "started");
        first = first[0] == '\0' || (started[0] != '\0' && strcmp(started, first) < 0) ? started
                                                                                       : first;
        last = strcmp(started, last) > 0 ? started : last;
    }
    set_text(object, "first", first);
    set_text(object, "last", last);
    return object;
}

/* The engine configurations in the report's order. */
static json_t *engines_json(const pl_result_table *results)
{
    json_t *array = json_array();
    for (int i = 0; i < results->configuration_count; ++i) {
        const pl_result_configuration *configuration = &results->configurations[i];
        json_t *object = json_pack("{s:i}", "threads", configuration->threads);
        set_text(object, "name", configuration->name);
        set_text(object, "engine", configuration->engine);
        set_text(object, "runtime", configuration->runtime);
        json_array_append_new(array, object);
    }
    return array;
}

/* What the page does not draw in its own way. */
static json_t *document_json(const pl_report *report)
{
    pl_document document = {0};
    pl_report_document(report, PL_READER_PAGE, &document);
    json_t *json = pl_document_json(&document);
    pl_document_free(&document);
    return json;
}

json_t *pl_engine_words(void)
{
    json_t *engines = json_loads(pl_engines_json, JSON_REJECT_DUPLICATES, NULL);
    json_t *words = json_object();
    size_t i;
    const json_t *engine;
    json_array_foreach(engines, i, engine)
    {
        json_object_set(words, pl_json_get_text(engine, "name"), json_object_get(engine, "words"));
    }
    json_decref(engines);
    return words;
}

json_t *pl_page_data_metrics(void)
{
    static const char *const directions[] = {"lower is better", "higher is better", "no direction"};
    json_t *array = json_array();
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        const pl_metric_info *info = &pl_metric_table[id];
        json_array_append_new(
            array, json_pack("{s:s, s:s, s:s, s:b, s:s}", "name", info->name, "unit", info->unit,
                             "direction", directions[info->direction], "measured",
                             pl_metric_is(id, PL_TRAIT_MEASURED), "definition", info->definition));
    }
    return array;
}

/* ---- Cases ---- */

static void set_catalogue(const pl_scenario *scenario, json_t *object)
{
    set_text(object, "title", scenario->title);
    set_text(object, "description", scenario->description);
    set_text(object, "reference", scenario->reference);
    set_text(object, "source", scenario->source);
    set_text(object, "expected", scenario->expected);
    set_text(object, "validity", scenario->validity);
    set_text(object, "provokes", scenario->provokes);
    set_text(object, "symptom", scenario->symptom);
    set_text(object, "threads", scenario->threads);
}

/* A parameter of a case. */
typedef struct given {
    pl_param param;
    const json_t *value;
    bool is_time; /* of a scene file: the time step or the duration, no parameters of its own */
} given;

static void add_given(const pl_param *param, const json_t *values, bool is_time, given **list,
                      int *count)
{
    const given item = {*param, json_object_get(values, param->name), is_time};
    pl_push(list, count, &item, sizeof item);
}

/* The parameters of a case; of a scene file its own, whose meaning is not known, then its time step and duration. The
 * caller frees. */
static given *list_given(const pl_result_case *test_case, int *count)
{
    static const pl_param times[2] = {
        {.name = "dt", .unit = "s", .help = "time step", .value = (double)NAN},
        {.name = "duration", .unit = "s", .help = "simulated time", .value = (double)NAN}};
    const pl_scenario *scenario = test_case->row->catalogue;
    const json_t *params = test_case->row->params;
    const json_t *settings = json_object_get(test_case->row->result, "settings");
    given *list = NULL;
    const char *name;
    json_t *value;
    *count = 0;
    for (int i = 0; scenario != NULL && i < scenario->param_count; ++i) {
        add_given(&scenario->params[i], params, false, &list, count);
    }
    json_object_foreach((json_t *)params, name, value)
    {
        const pl_param own = {.name = name, .unit = "1", .help = "", .value = (double)NAN};
        if (scenario == NULL && strcmp(name, "dt") != 0 && strcmp(name, "duration") != 0) {
            add_given(&own, params, false, &list, count);
        }
    }
    for (int i = 0; scenario == NULL && i < 2; ++i) {
        add_given(&times[i], settings, true, &list, count);
    }
    return list;
}

/* Parameters as [name, value, meaning]. */
static json_t *params_json(const given *list, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; ++i) {
        char number[PL_QUANTITY_SIZE];
        pl_format_given(json_is_number(list[i].value) ? json_number_value(list[i].value)
                                                      : (double)NAN,
                        list[i].param.unit, number);
        json_array_append_new(array, json_pack("[s, s, o]", list[i].param.name, number,
                                               text_or_null(list[i].param.help)));
    }
    return array;
}

/* The command that makes the runs of a case again. */
static json_t *again_json(const pl_result_case *test_case, const given *list, int count)
{
    pl_text_buffer line = {0};
    pl_text_add(&line, PL_PROGRAM " compare ");
    pl_text_add_shell(&line, test_case->row->scenario);
    for (int i = 0; i < count; ++i) {
        const double value = json_number_value(list[i].value);
        if (json_is_number(list[i].value) && value != list[i].param.value) {
            pl_text_format(&line, list[i].is_time ? " --%s %.17g" : " --set %s=%.17g",
                           list[i].param.name, value);
        }
    }
    if (test_case->row->seed != 0) {
        pl_text_format(&line, " --seed %" JSON_INTEGER_FORMAT, test_case->row->seed);
    }
    json_t *text = text_or_null(line.data);
    pl_text_free(&line);
    return text;
}

/* The poses at the end, 7 numbers a body, to six digits; null where there are none. */
static json_t *final_json(const json_t *result)
{
    const json_t *poses = json_object_get(result, "final_poses");
    json_t *array = json_array();
    for (size_t i = 0; i < 7 * json_array_size(poses); ++i) {
        const json_t *item = json_array_get(json_array_get(poses, i / 7), i % 7);
        json_array_append_new(
            array, pl_rounded_json(item == NULL ? (double)NAN : json_number_value(item)));
    }
    return array;
}

/* A metric as [value, text, note]: a number, a text or null; as people read it; spread and
 * percentiles, or why there is no value. */
static json_t *metric_json(const pl_metric_summary *summary)
{
    char text[PL_METRIC_TEXT_SIZE], *note = pl_metric_note(summary);
    pl_metric_text(summary, text);
    json_t *value = summary->state == PL_METRIC_VALUE  ? pl_json_number_or_null(summary->value)
                    : summary->state == PL_METRIC_TEXT ? text_or_null(summary->text)
                                                       : json_null();
    json_t *whole = json_pack("[o, o, o]", value, text_or_null(text), text_or_null(note));
    free(note);
    return whole;
}

static json_t *cell_json(const pl_result_case *test_case, const pl_result_cell *cell)
{
    char verdict[PL_CELL_VERDICT_SIZE], output[MOST_OUTPUT + 1];
    if (cell == NULL) {
        return json_null();
    }
    json_t *object = json_object(), *metrics = json_object();
    pl_cell_verdict(cell, verdict);
    set_text(object, "style", pl_cell_style(cell));
    set_text(object, "verdict", verdict);
    set_text(object, "why", pl_cell_why(cell));
    set_text(object, "outcome", pl_outcome_name(cell->worst->outcome));
    set_text(object, "note", pl_json_get_text(cell->worst->result, "note"));
    set_text(object, "spec", pl_json_get_text(cell->worst->result, "engine_spec"));
    set_text(object, "run", pl_json_get_text(cell->worst->result, "run"));
    snprintf(output, sizeof output, "%s", pl_json_get_text(cell->worst->result, "output"));
    set_text(object, "output", output);
    if (cell->count > 1) {
        json_object_set_new(object, "repeats", json_integer(cell->count));
        json_object_set_new(object, "ok_repeats", json_integer(cell->ok_count));
    }
    if (cell->disagrees) {
        json_object_set_new(object, "disagrees", json_true());
    }
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        const pl_metric_summary summary = pl_result_cell_metric(cell, id);
        if (summary.state != PL_METRIC_ABSENT && !pl_case_primary_is(test_case, id)) {
            json_object_set_new(metrics, pl_metric_table[id].name, metric_json(&summary));
        }
    }
    json_object_set_new(object, "metrics", metrics);
    if (json_array_size(json_object_get(cell->worst->result, "final_poses")) <= MOST_BODIES) {
        json_object_set_new(object, "final", final_json(cell->worst->result));
    }
    return object;
}

static void set_bound(const pl_result_case *test_case, json_t *object)
{
    char text[PL_QUANTITY_SIZE];
    const pl_scenario *scenario = test_case->row->catalogue;
    const double bound = pl_case_bound(test_case, text);
    const int id = pl_metric_by_name(test_case->row->primary_error);
    set_text(object, "primary_error", test_case->row->primary_error);
    set_text(object, "unit", id < 0 ? "" : pl_metric_table[id].unit);
    if (isfinite(bound)) {
        set_text(object, "bound_text", text);
        json_object_set_new(object, "bound", json_real(bound));
    }
    if (scenario != NULL && scenario->acceptance == bound) {
        set_text(object, "bound_reason", scenario->acceptance_reason);
    }
}

static json_t *case_json(const pl_result_table *results, const pl_result_case *test_case)
{
    json_t *object = json_object(), *cells = json_array();
    int count = 0;
    given *list = list_given(test_case, &count);
    pl_scene scene;
    pl_error error = {PL_OK, ""};
    const pl_status built = pl_case_scene_build(test_case, &scene, &error);
    set_text(object, "name", test_case->name);
    set_text(object, "scenario", test_case->row->scenario);
    if (test_case->row->catalogue != NULL) {
        set_catalogue(test_case->row->catalogue, object);
    }
    set_bound(test_case, object);
    json_object_set_new(object, "params", params_json(list, count));
    json_object_set_new(object, "again", again_json(test_case, list, count));
    free(list);
    if (built == PL_OK) {
        json_object_set_new(object, "scene", pl_case_scene_json(&scene));
    } else {
        set_text(object, "scene_error", error.message);
    }
    for (int i = 0; i < results->configuration_count; ++i) {
        json_array_append_new(cells, cell_json(test_case, pl_result_case_cell(test_case, i)));
    }
    json_object_set_new(object, "cells", cells);
    pl_scene_free(&scene);
    return object;
}

json_t *pl_page_data(const pl_report *report)
{
    const pl_result_table *results = report->results;
    json_t *cases = json_array();
    json_t *command =
        results->case_count == 0 ? NULL : json_object_get(results->cases[0].row->result, "command");
    for (int i = 0; i < results->case_count; ++i) {
        json_array_append_new(cases, case_json(results, &results->cases[i]));
    }
    return json_pack("{s:s, s:i, s:b, s:b, s:o, s:O?, s:o, s:o, s:o, s:o, s:o}", "kind", "report",
                     "runs", results->row_count, "several_hosts", (int)results->several_hosts,
                     "disagrees", (int)results->disagrees, "provenance", provenance_json(results),
                     "command", command, "engines", engines_json(results), "cases", cases,
                     "document", document_json(report), "metrics", pl_page_data_metrics(), "words",
                     pl_engine_words());
}
