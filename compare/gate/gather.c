/* Reads files of results, and gathers the repeats of each run into a row. */
#include "gather.h"

#include "base/array.h"
#include "base/folding.h"
#include "base/statistics.h"
#include "plumb/scenario.h"
#include "ratio.h"
#include "results/result.h"
#include "results/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

pl_status pl_gate_file_read(const char *path, pl_gate_file *file, pl_error *error)
{
    struct stat found;
    long long whole = 0;
    char *inside = NULL;
    *file = (pl_gate_file){.path = path};
    if (stat(path, &found) == 0 && S_ISDIR(found.st_mode)) {
        if (asprintf(&inside, "%s/results.jsonl", path) < 0) {
            return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path);
        }
        path = inside;
    }
    pl_status status = pl_results_read(path, &file->results, &whole, error);
    if (status == PL_OK) {
        json_t *all = file->results;
        file->results = pl_results_of_study(all, NULL);
        json_decref(all);
    }
    if (status == PL_OK && stat(path, &found) == 0 && S_ISREG(found.st_mode) &&
        found.st_size > whole) {
        pl_print_line(stderr, "%s: the last line is not whole, and left out", path);
    }
    free(inside);
    return status;
}

static pl_status no_memory(pl_error *error)
{
    return pl_fail(error, PL_NO_MEMORY, "out of memory for the rows of results");
}

static pl_status check_result(const json_t *result, const char *path, size_t index, pl_error *error)
{
    static const char *const texts[] = {"scenario", "label", "outcome"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        if (!json_is_string(json_object_get(result, texts[i]))) {
            return pl_fail(error, PL_BAD_INPUT, "%s:%zu:1: %s: expected a string", path, index + 1,
                           texts[i]);
        }
    }
    const json_t *settings = json_object_get(result, "settings");
    if (!json_is_number(json_object_get(settings, "dt")) ||
        !json_is_object(json_object_get(result, "metrics"))) {
        return pl_fail(error, PL_BAD_INPUT, "%s:%zu:1: expected settings.dt and metrics", path,
                       index + 1);
    }
    const char *name;
    json_t *value;
    json_object_foreach(json_object_get(result, "params"), name, value)
    {
        if (!json_is_number(value)) {
            return pl_fail(error, PL_BAD_INPUT, "%s:%zu:1: params.%s: expected a number", path,
                           index + 1, name);
        }
    }
    return PL_OK;
}

/* Returns the parameters of a result that are off their defaults. */
static json_t *params_of(const json_t *result)
{
    json_t *params = json_object();
    const pl_scenario *scenario = pl_scenario_find(pl_json_get_text(result, "scenario"), NULL);
    const char *name;
    json_t *value;
    json_object_foreach(json_object_get(result, "params"), name, value)
    {
        bool is_default = false;
        for (int i = 0; scenario != NULL && i < scenario->param_count; ++i) {
            is_default |= strcmp(scenario->params[i].name, name) == 0 &&
                          scenario->params[i].value == json_number_value(value);
        }
        if (!is_default && json_object_set(params, name, value) != 0) {
            json_decref(params);
            return NULL;
        }
    }
    return params;
}

static json_t *row_json(const json_t *result)
{
    const json_t *settings = json_object_get(result, "settings");
    json_t *json = json_pack("{s:s, s:o, s:s, s:f, s:f, s:I, s:s, s:s, s:{}}", "scenario",
                             pl_json_get_text(result, "scenario"), "params", params_of(result),
                             "engine", pl_json_get_text(result, "label"), "dt",
                             json_number_value(json_object_get(settings, "dt")), "duration",
                             json_number_value(json_object_get(settings, "duration")), "seed",
                             json_integer_value(json_object_get(result, "seed")), "scene_hash",
                             pl_json_get_text(result, "scene_hash"), "outcome", "ok", "metrics");
    json_t *member = json_object_get(result, "member");
    if (json != NULL && member != NULL && json_object_set(json, "member", member) != 0) {
        json_decref(json);
        return NULL;
    }
    return json;
}

/* Keeps the worst verdict of the repeats; a row in which one was not judged has none. */
static bool add_verdict(pl_gate_row *row, const json_t *result)
{
    const pl_verdict verdict = pl_verdict_of(result);
    if (row->sample_count > 1 && verdict <= row->verdict) {
        return true;
    }
    row->verdict = verdict;
    row->verdict_reason = pl_json_get_text(result, "verdict_reason");
    if (verdict == PL_VERDICT_UNJUDGED) {
        json_object_del(row->json, "verdict");
        return true;
    }
    return json_object_set_new(row->json, "verdict", json_string(pl_verdict_name(verdict))) == 0;
}

static pl_status add_sample(pl_gate_row *row, const json_t *result, int file, pl_error *error)
{
    const pl_gate_sample sample = {.file = file,
                                   .repeat = json_integer_value(json_object_get(result, "repeat")),
                                   .metrics = json_object_get(result, "metrics")};
    if (pl_array_push(&row->samples, &row->sample_count, &sample, sizeof sample, error) != PL_OK) {
        return PL_NO_MEMORY;
    }
    const char *outcome = pl_json_get_text(result, "outcome");
    if (pl_gate_row_is_ok(row) && strcmp(outcome, "ok") != 0) {
        row->reason = pl_json_get_text(result, "reason");
        if (json_object_set_new(row->json, "outcome", json_string(outcome)) != 0) {
            return no_memory(error);
        }
        row->outcome = pl_json_get_text(row->json, "outcome");
    }
    return add_verdict(row, result) ? PL_OK : no_memory(error);
}

/* Makes an empty row of the result's run. False: out of memory. */
static bool begin_row(const json_t *result, pl_gate_row *row)
{
    *row = (pl_gate_row){.json = row_json(result),
                         .reason = "",
                         .verdict_reason = "",
                         .reasons = json_object(),
                         .spread = json_object(),
                         .measured = json_object()};
    return row->json != NULL && row->reasons != NULL && row->spread != NULL &&
           row->measured != NULL && pl_gate_row_identify(row);
}

/* Adds the result to the row of its key, which is made where it is missing. */
static pl_status add_result(pl_gate_rows *rows, json_t *indices, const json_t *result, int file,
                            pl_error *error)
{
    pl_gate_row row;
    bool begun = begin_row(result, &row);
    json_t *known = begun ? json_object_get(indices, row.key) : NULL;
    int index = known == NULL ? rows->count : (int)json_integer_value(known);
    if (begun && known == NULL && json_object_set_new(indices, row.key, json_integer(index)) == 0) {
        rows->items[rows->count++] = row;
    } else {
        pl_gate_row_free(&row);
    }
    return index < rows->count ? add_sample(&rows->items[index], result, file, error)
                               : no_memory(error);
}

/* Summarises a metric over the repeats: of numbers the median, with their range where they should
 * be equal and are not; of texts the first; null as soon as one repeat has no value. */
static json_t *summarise(const pl_gate_row *row, const char *name, bool deterministic,
                         double *numbers)
{
    int count = 0;
    for (int i = 0; i < row->sample_count; ++i) {
        const json_t *metric = json_object_get(row->samples[i].metrics, name);
        json_t *value = json_object_get(metric, "value");
        if (json_is_string(value)) {
            return json_incref(value);
        }
        if (json_is_null(value)) {
            const char *reason = pl_json_get_text(metric, "reason");
            json_object_set_new(row->reasons, name, json_string(reason));
            return json_null();
        }
        if (json_is_number(value)) {
            numbers[count++] = json_number_value(value);
        }
    }
    if (count == 0) {
        return json_null();
    }
    const double median = pl_median(numbers, count);
    double least = numbers[0], largest = numbers[count - 1];
    if (deterministic && least != largest) {
        json_object_set_new(row->spread, name, json_pack("[f, f]", least, largest));
    }
    return json_real(median);
}

/* Summarises every metric of a row; `numbers` has room for a number of each sample. A baseline
 * keeps metrics that differ from run to run only where a tolerance is given. */
static bool summarise_all(const pl_gate_row *row, const pl_gate_tolerances *tolerances,
                          double *numbers)
{
    bool is_ok = pl_gate_row_is_ok(row);
    json_t *kept = json_object_get(row->json, "metrics");
    for (int i = 0; i < row->sample_count; ++i) {
        const char *name;
        json_t *metric;
        json_object_foreach((json_t *)row->samples[i].metrics, name, metric)
        {
            if (json_object_get(kept, name) != NULL ||
                json_object_get(row->measured, name) != NULL) {
                continue;
            }
            int id = pl_metric_by_name(name);
            bool deterministic = pl_metric_is_deterministic(metric, id);
            bool asked = id >= 0 && tolerances->of[id].given && !tolerances->of[id].off;
            bool is_kept = is_ok && pl_gate_cost_of(name) < 0 && (deterministic || asked);
            if (json_object_set_new(is_kept ? kept : row->measured, name,
                                    summarise(row, name, deterministic, numbers)) != 0) {
                return false;
            }
        }
    }
    return true;
}

static pl_status fill_rows(pl_gate_rows *rows, const pl_gate_tolerances *tolerances,
                           pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < rows->count && status == PL_OK; ++i) {
        pl_gate_row *row = &rows->items[i];
        double *numbers = calloc((size_t)row->sample_count + 1, sizeof *numbers);
        row->metrics = json_object_get(row->json, "metrics");
        if (numbers == NULL || !summarise_all(row, tolerances, numbers)) {
            status = no_memory(error);
        }
        free(numbers);
    }
    return status;
}

/* Whether an equal result came before, in this file or an earlier one. */
static bool came_before(const pl_gate_file *files, int file, size_t index)
{
    const json_t *result = json_array_get(files[file].results, index);
    const char *run = pl_json_get_text(result, "run");
    for (int f = 0; f <= file; ++f) {
        size_t end = f == file ? index : json_array_size(files[f].results);
        for (size_t i = 0; i < end; ++i) {
            const json_t *other = json_array_get(files[f].results, i);
            if (strcmp(pl_json_get_text(other, "run"), run) == 0 && json_equal(other, result)) {
                return true;
            }
        }
    }
    return false;
}

/* Notes of each label the build of the engine that ran last: label -> [binary, time]. */
static bool note_newest_builds(const pl_gate_file *files, int count, json_t *builds)
{
    bool noted = true;
    for (int f = 0; f < count; ++f) {
        size_t index;
        json_t *result;
        json_array_foreach(files[f].results, index, result)
        {
            const char *label = pl_json_get_text(result, "label");
            const char *binary = pl_json_get_text(result, "engine_binary");
            const char *started = pl_json_get_text(result, "started");
            const json_t *known = json_array_get(json_object_get(builds, label), 1);
            if (binary[0] != '\0' &&
                (known == NULL || strcmp(json_string_value(known), started) < 0)) {
                noted = noted && json_object_set_new(builds, label,
                                                     json_pack("[s, s]", binary, started)) == 0;
            }
        }
    }
    return noted;
}

/* Whether another build of the engine ran later under the same label. */
static bool is_outdated(const json_t *builds, const json_t *result)
{
    const json_t *newest =
        json_array_get(json_object_get(builds, pl_json_get_text(result, "label")), 0);
    const char *binary = pl_json_get_text(result, "engine_binary");
    return newest != NULL && binary[0] != '\0' && strcmp(json_string_value(newest), binary) != 0;
}

pl_status pl_gate_gather(const pl_gate_file *files, int count, const pl_gate_tolerances *tolerances,
                         pl_gate_rows *rows, pl_error *error)
{
    size_t most = 0;
    for (int f = 0; f < count; ++f) {
        most += json_array_size(files[f].results);
    }
    size_t outdated = 0;
    json_t *indices = json_object();
    json_t *builds = json_object();
    *rows = (pl_gate_rows){.items = calloc(most + 1, sizeof *rows->items)};
    const bool has_memory = indices != NULL && builds != NULL && rows->items != NULL &&
                            note_newest_builds(files, count, builds);
    pl_status status = has_memory ? PL_OK : no_memory(error);
    for (int f = 0; f < count; ++f) {
        for (size_t i = 0; status == PL_OK && i < json_array_size(files[f].results); ++i) {
            const json_t *result = json_array_get(files[f].results, i);
            status = check_result(result, files[f].path, i, error);
            if (is_outdated(builds, result)) {
                ++outdated;
            } else if (status == PL_OK && json_object_get(result, "change") == NULL &&
                       !came_before(files, f, i)) {
                status = add_result(rows, indices, result, f, error);
            }
        }
    }
    json_decref(indices);
    json_decref(builds);
    if (outdated > 0) {
        pl_print_line(stderr, "%zu %s of engines that were rebuilt since left out", outdated,
                      outdated == 1 ? "result is" : "results are");
    }
    if (status == PL_OK) {
        status = fill_rows(rows, tolerances, error);
    }
    pl_gate_rows_sort(rows);
    return status;
}
