/* Groups rows of results into scenes, series and points by their keys, and finds the cost and the
 * error of each point. */
#include "analysis_parts.h"
#include "analysis_rows.h"

#include "base/hash.h"
#include "base/statistics.h"
#include "results/run_verdict.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Scenes ---- */

static void add_param(pl_sweep_scene *scene, const char *name, double value, const char *unit)
{
    const size_t used = strlen(scene->name);
    const bool bare = strcmp(unit, "1") == 0 || unit[0] == '\0';
    snprintf(scene->name + used, sizeof scene->name - used, " %s=%.6g%s%s", name, value,
             bare ? "" : " ", bare ? "" : unit);
}

/* The parameters that are not at their defaults; those of a scene file, whose defaults are not known,
 * all. The time step is no part of a scene. */
static void add_params(pl_sweep_scene *scene)
{
    const pl_scenario *catalogue = scene->catalogue;
    json_t *params = json_object_get(scene->row, "params");
    const char *name;
    json_t *value;
    for (int i = 0; catalogue != NULL && i < catalogue->param_count; ++i) {
        const pl_param *param = &catalogue->params[i];
        value = json_object_get(params, param->name);
        if (strcmp(param->name, "dt") != 0 && json_is_number(value) &&
            json_number_value(value) != param->value) {
            add_param(scene, param->name, json_number_value(value), param->unit);
        }
    }
    json_object_foreach(params, name, value)
    {
        if (catalogue == NULL && strcmp(name, "dt") != 0) {
            add_param(scene, name, json_number_value(value), "1");
        }
    }
}

/* The scenario with its parameters, the seed and the member. */
static void name_scene(pl_sweep_scene *scene)
{
    const json_int_t seed = json_integer_value(json_object_get(scene->row, "seed"));
    const json_t *member = json_object_get(scene->row, "member");
    const size_t size = sizeof scene->name;
    snprintf(scene->name, size, "%.120s", scene->scenario);
    add_params(scene);
    size_t used = strlen(scene->name);
    if (seed != 0) {
        snprintf(scene->name + used, size - used, " seed=%" JSON_INTEGER_FORMAT, seed);
    }
    used = strlen(scene->name);
    if (json_is_integer(member)) {
        snprintf(scene->name + used, size - used, " member=%" JSON_INTEGER_FORMAT,
                 json_integer_value(member));
    }
}

/* A scene without points; its texts are borrowed from the row. */
static pl_sweep_scene make_scene(const json_t *row, int first)
{
    pl_sweep_scene scene = {.row = row,
                            .scenario = pl_json_get_text(row, "scenario"),
                            .primary_error = pl_json_get_text(row, "primary_error"),
                            .unit = "",
                            .first = first};
    scene.catalogue = pl_scenario_find(scene.scenario, NULL);
    name_scene(&scene);
    return scene;
}

/* ---- Samples of a point ---- */

static int by_cost(const void *left, const void *right)
{
    const pl_sweep_sample *a = left, *b = right;
    if (a->cost != b->cost) {
        return a->cost < b->cost ? -1 : 1;
    }
    return (a->error > b->error) - (a->error < b->error);
}

static bool is_cost(double value)
{
    return isfinite(value) && value > 0;
}

static bool is_changed(const json_t *row)
{
    return pl_json_get_text(row, "change")[0] != '\0';
}

/* Why a point whose runs are all ok has no sample. */
static const char *what_is_missing(const json_t *row, int errors, int costs)
{
    if (pl_json_get_text(row, "primary_error")[0] == '\0') {
        return "the scenario has no primary error";
    }
    if (errors == 0) {
        return "the primary error has no value";
    }
    return costs == 0 ? "no time was measured" : "no repeat has both an error and a time";
}

/* The median of the samples' costs, or errors, of their deviations from `centre`. */
static double median_of(const pl_sweep_point *point, bool errors, double centre, double *scratch)
{
    for (int i = 0; i < point->sample_count; ++i) {
        const pl_sweep_sample *sample = &point->samples[i];
        scratch[i] = fabs((errors ? sample->error : sample->cost) - centre);
    }
    return pl_median(scratch, point->sample_count);
}

/* Sets the state of a point to that of its rows, and its row to the first that is not ok. */
static void judge_outcomes(const json_t *const *rows, int count, pl_sweep_point *point)
{
    point->row = rows[0];
    point->state = PL_SWEEP_OK;
    for (int i = 0; i < count && point->state == PL_SWEEP_OK; ++i) {
        const char *outcome = pl_json_get_text(rows[i], "outcome");
        if (strcmp(outcome, "ok") != 0 || pl_verdict_of(rows[i]) == PL_VERDICT_FAILED) {
            /* What is unsupported on a changed scene only has failed there. */
            point->state = strcmp(outcome, "unsupported") == 0 && !is_changed(rows[i])
                               ? PL_SWEEP_UNSUPPORTED
                               : PL_SWEEP_FAILED;
            point->row = rows[i];
        }
    }
    point->change = pl_json_get_text(point->row, "change");
    point->outcome = pl_json_get_text(point->row, "outcome");
    const bool jumped = point->state == PL_SWEEP_FAILED && strcmp(point->outcome, "ok") == 0;
    point->reason = pl_json_get_text(point->row, jumped ? "verdict_reason" : "reason");
    point->label = pl_json_get_text(point->row, "label");
}

static double error_of(const json_t *row)
{
    return fabs(pl_result_metric(row, pl_json_get_text(row, "primary_error")));
}

/* Raises the errors of a point to the largest of its changes. A change without one leaves it
 * unmeasured. */
static void apply_changes(const json_t *const *changed, int count, pl_sweep_point *point)
{
    for (int i = 0; i < count && point->state == PL_SWEEP_OK; ++i) {
        const double found = error_of(changed[i]);
        if (!isfinite(found)) {
            point->state = PL_SWEEP_UNMEASURED;
            point->row = changed[i];
            point->change = pl_json_get_text(changed[i], "change");
            point->reason = "the primary error has no value";
        } else if (found > point->raw_error) {
            point->raw_error = found;
            point->change = pl_json_get_text(changed[i], "change");
        }
        for (int k = 0; k < point->sample_count && isfinite(found); ++k) {
            point->samples[k].error = fmax(point->samples[k].error, found);
        }
    }
}

/* Takes the samples of the runs on the scene itself, which are all ok. `scratch` has three numbers a
 * row. */
static void take_samples(const json_t *const *rows, int count, double *scratch,
                         pl_sweep_point *point)
{
    if (pl_result_runtime(rows[0]) != NULL) {
        point->state = PL_SWEEP_UNMEASURED;
        point->reason = "the engine is not native: its times are not ranked";
        return;
    }
    double *raw = scratch + count, *instructions = raw + count;
    int errors = 0, costs = 0, counted = 0;
    for (int i = 0; i < count; ++i) {
        double found = error_of(rows[i]);
        double cost = pl_result_metric(rows[i], "time_per_step") / point->dt;
        double counts = pl_result_metric(rows[i], "instructions_per_step") / point->dt;
        errors += isfinite(found);
        costs += is_cost(cost);
        if (!isfinite(found) || !is_cost(cost)) {
            continue;
        }
        raw[point->sample_count] = found;
        point->samples[point->sample_count++] =
            (pl_sweep_sample){cost, fmax(found, pl_sweep_error_floor)};
        if (is_cost(counts)) {
            instructions[counted++] = counts;
        }
    }
    if (point->sample_count == 0) {
        point->state = PL_SWEEP_UNMEASURED;
        point->reason = what_is_missing(rows[0], errors, costs);
        return;
    }
    qsort(point->samples, (size_t)point->sample_count, sizeof *point->samples, by_cost);
    point->raw_error = pl_median(raw, point->sample_count);
    point->instructions = pl_median(instructions, counted);
    point->cost = median_of(point, false, 0, scratch);
    point->cost_mad = median_of(point, false, point->cost, scratch);
}

/* Fills the numbers of a point from its rows: first those of the scene itself, then those of its
 * changes. The cost is that of the scene itself; the error is the largest of all. */
static pl_status measure(const json_t *const *rows, int count, pl_sweep_point *point,
                         pl_error *error)
{
    int own = 0;
    while (own < count && !is_changed(rows[own])) {
        ++own;
    }
    point->repeats = own;
    point->changes = count - own;
    point->cost = point->cost_mad = point->error = point->raw_error = point->instructions =
        (double)NAN;
    judge_outcomes(rows, count, point);
    if (point->state == PL_SWEEP_OK && own == 0) {
        point->state = PL_SWEEP_UNMEASURED;
        point->reason = "only changes of the scene were run";
    }
    if (point->state != PL_SWEEP_OK) {
        return PL_OK;
    }
    point->samples = calloc((size_t)own, sizeof *point->samples);
    double *scratch = calloc(3 * (size_t)own, sizeof *scratch);
    if (point->samples == NULL || scratch == NULL) {
        free(scratch);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d repeats", own);
    }
    take_samples(rows, own, scratch, point);
    apply_changes(rows + own, point->changes, point);
    if (point->state == PL_SWEEP_OK) {
        point->error = median_of(point, true, 0, scratch);
    }
    free(scratch);
    return PL_OK;
}

/* ---- Engines ---- */

static int find_engine(const pl_sweep_analysis *analysis, const char *name, pl_sweep_kind kind)
{
    for (int i = 0; i < analysis->engine_count; ++i) {
        if (analysis->engines[i].kind == kind && strcmp(analysis->engines[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

/* The engine, or with its profile; one with a label of its own goes by that. */
static void name_engine(const json_t *row, pl_sweep_kind kind, char name[128])
{
    const bool whole = kind == PL_SWEEP_WHOLE;
    const char *engine = pl_json_get_text(row, "engine");
    const char *profile = pl_json_get_text(row, "profile");
    const char *label = pl_json_get_text(row, "label");
    const size_t length = strcspn(label, ",");
    snprintf(name, 128, "%.60s:%.60s", engine, profile);
    if (strlen(name) != length || memcmp(name, label, length) != 0) {
        snprintf(name, 128, "%.*s", (int)(whole ? strcspn(label, ":,") : length), label);
    } else if (whole || profile[0] == '\0') {
        snprintf(name, 128, "%.60s", engine);
    }
}

static int compare_listed(const void *left, const void *right)
{
    const pl_sweep_engine *a = left, *b = right;
    if (a->kind != b->kind) {
        return a->kind < b->kind ? -1 : 1;
    }
    if (a->ours != b->ours) {
        return a->ours ? -1 : 1;
    }
    return strcmp(a->name, b->name);
}

/* Adds the engine of a row, in one of its kinds, unless it is there. */
static void list_engine(const json_t *row, pl_sweep_kind kind, pl_sweep_analysis *analysis)
{
    pl_sweep_engine engine = {.ours = pl_engine_is_ours(pl_json_get_text(row, "engine")),
                              .kind = kind};
    name_engine(row, kind, engine.name);
    if (find_engine(analysis, engine.name, kind) < 0) {
        analysis->engines[analysis->engine_count++] = engine;
    }
    const json_t *record = json_object_get(row, "conformance");
    if (kind == PL_SWEEP_PROFILE && strcmp(pl_json_get_text(record, "outcome"), "passed") != 0) {
        const char *spec = pl_json_get_text(row, "engine_spec");
        analysis->engines[find_engine(analysis, engine.name, kind)].unverified = spec;
    }
}

static bool is_as_shipped(const json_t *row)
{
    return json_is_true(json_object_get(row, "as_shipped"));
}

static void list_engines(const pl_keyed_row *rows, size_t count, pl_sweep_analysis *analysis)
{
    for (size_t i = 0; i < count; ++i) {
        list_engine(rows[i].row, PL_SWEEP_WHOLE, analysis);
        list_engine(rows[i].row, PL_SWEEP_PROFILE, analysis);
        if (is_as_shipped(rows[i].row)) {
            list_engine(rows[i].row, PL_SWEEP_SHIPPED, analysis);
        }
    }
    qsort(analysis->engines, (size_t)analysis->engine_count, sizeof *analysis->engines,
          compare_listed);
}

/* ---- Points ---- */

static uint64_t hash_of(const pl_keyed_row *row)
{
    char dt[40];
    snprintf(dt, sizeof dt, "%.17g", row->dt);
    return pl_hash_text(pl_hash_text(pl_hash_text(PL_HASH_START, row->scene), row->series), dt);
}

static bool differ_in(const pl_keyed_row *a, const pl_keyed_row *b, const char *object,
                      const char *key)
{
    const json_t *in_a = object == NULL ? a->row : json_object_get(a->row, object);
    const json_t *in_b = object == NULL ? b->row : json_object_get(b->row, object);
    return strcmp(pl_json_get_text(in_a, key), pl_json_get_text(in_b, key)) != 0;
}

static void note_origins(const pl_keyed_row *rows, size_t index, pl_sweep_analysis *analysis)
{
    const pl_keyed_row *row = &rows[index];
    size_t alike = 0;
    char name[128], other[128];
    name_engine(row->row, PL_SWEEP_PROFILE, name);
    do {
        name_engine(rows[alike].row, PL_SWEEP_PROFILE, other);
    } while (strcmp(name, other) != 0 && ++alike < index);
    analysis->several_hosts |= differ_in(row, &rows[0], "host", "cpu");
    analysis->several_builds |= differ_in(row, &rows[0], "plumb", "version") ||
                                differ_in(row, &rows[0], "plumb", "git") ||
                                differ_in(row, &rows[alike], NULL, "engine_version") ||
                                differ_in(row, &rows[alike], NULL, "engine_binary");
}

/* Adds the point whose repeats and changes are the sorted rows [first, next). */
static pl_status add_point(const pl_keyed_row *rows, size_t first, size_t next,
                           const json_t **repeats, pl_sweep_analysis *analysis, pl_error *error)
{
    const pl_keyed_row *row = &rows[first];
    bool new_scene = first == 0 || strcmp(rows[first - 1].scene, row->scene) != 0;
    bool new_series = new_scene || strcmp(rows[first - 1].series, row->series) != 0;
    int place = analysis->point_count, count = 0;
    char name[128];
    if (new_scene) {
        analysis->scenes[analysis->scene_count++] = make_scene(row->row, place);
    }
    for (size_t i = first; i < next; ++i) {
        bool again = false;
        for (int k = 0; k < count && !again; ++k) {
            again = json_equal(repeats[k], rows[i].row);
        }
        if (!again) {
            repeats[count++] = rows[i].row;
        }
        pl_sweep_scene *scene = &analysis->scenes[analysis->scene_count - 1];
        if (scene->unit[0] == '\0') {
            const json_t *metrics = json_object_get(rows[i].row, "metrics");
            scene->unit = pl_json_get_text(json_object_get(metrics, scene->primary_error), "unit");
        }
        note_origins(rows, i, analysis);
    }
    pl_sweep_point *point = &analysis->points[analysis->point_count++];
    point->scene = analysis->scene_count - 1;
    point->series = place == 0 ? 0 : analysis->points[place - 1].series + new_series;
    point->dt = row->dt;
    point->hash = hash_of(row);
    for (int kind = 0; kind < PL_SWEEP_KINDS; ++kind) {
        name_engine(row->row, (pl_sweep_kind)kind, name);
        point->engines[kind] = kind == PL_SWEEP_SHIPPED && !is_as_shipped(row->row)
                                   ? -1
                                   : find_engine(analysis, name, (pl_sweep_kind)kind);
    }
    ++analysis->scenes[point->scene].count;
    analysis->run_count += count;
    return measure(repeats, count, point, error);
}

static pl_status add_points(pl_keyed_row *rows, size_t count, pl_sweep_analysis *analysis,
                            pl_error *error)
{
    pl_status status = PL_OK;
    const json_t **repeats = calloc(count + 1, sizeof(const json_t *));
    if (repeats == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu results", count);
    }
    pl_keyed_rows_sort(rows, count);
    for (size_t first = 0, next; first < count && status == PL_OK; first = next) {
        for (next = first + 1;
             next < count && pl_keyed_row_is_same_point(&rows[first], &rows[next]);) {
            ++next;
        }
        status = add_point(rows, first, next, repeats, analysis, error);
    }
    free(repeats);
    return status;
}

pl_status pl_sweep_gather(const json_t *results, pl_sweep_analysis *analysis, pl_error *error)
{
    if (!json_is_array(results)) {
        return pl_fail(error, PL_BAD_INPUT, "results: expected an array");
    }
    size_t count = json_array_size(results);
    pl_status status = PL_OK;
    pl_keyed_row *rows = calloc(count + 1, sizeof *rows);
    analysis->points = calloc(count + 1, sizeof *analysis->points);
    analysis->scenes = calloc(count + 1, sizeof *analysis->scenes);
    analysis->engines = calloc(PL_SWEEP_KINDS * count + 1, sizeof *analysis->engines);
    if (rows == NULL || analysis->points == NULL || analysis->scenes == NULL ||
        analysis->engines == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for %zu results", count);
    }
    for (size_t i = 0; i < count && status == PL_OK; ++i) {
        status = pl_keyed_row_make(json_array_get(results, i), i, &rows[i], error);
    }
    if (status == PL_OK) {
        list_engines(rows, count, analysis);
        status = add_points(rows, count, analysis, error);
    }
    for (size_t i = 0; i < count && rows != NULL; ++i) {
        pl_keyed_row_free(&rows[i]);
    }
    free(rows);
    return status;
}
