/* Makes points of the cells of a table, and finds the cost and the error of each. */
#include "analysis.h"

#include "base/hash.h"
#include "base/heap.h"
#include "base/program_name.h"
#include "base/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static bool is_changed(const pl_result_row *row)
{
    return row->change[0] != '\0';
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

/* Notes the row that a point has its outcome from. */
static void take_row(const pl_result_row *row, const char *reason, pl_sweep_point *point)
{
    point->row = row;
    point->change = row->change;
    point->reason = reason;
}

/* Sets the state of a point to that of the worst of its rows. A point that is unsupported on a changed scene only has
 * failed there. */
static void judge_outcomes(const pl_result_row *const *rows, int count, pl_sweep_point *point)
{
    const pl_result_row *worst = rows[0];
    for (int i = 1; i < count; ++i) {
        worst = pl_result_row_is_worse(rows[i], worst) ? rows[i] : worst;
    }
    const bool is_ok = worst->outcome == PL_OUTCOME_OK;
    if (worst->outcome == PL_OUTCOME_UNSUPPORTED && !is_changed(worst)) {
        point->state = PL_SWEEP_UNSUPPORTED;
        take_row(worst, worst->reason, point);
    } else if (!is_ok || worst->verdict == PL_VERDICT_FAILED) {
        point->state = PL_SWEEP_FAILED;
        take_row(worst, is_ok ? pl_json_get_text(worst->result, "verdict_reason") : worst->reason,
                 point);
    } else {
        take_row(rows[0], rows[0]->reason, point);
    }
}

static double error_of(const pl_result_row *row)
{
    return fabs(pl_result_metric(row->result, row->primary_error));
}

/* Takes the samples of the runs on the scene itself, which are all ok. `scratch` has three numbers a
 * row. Returns why there are none; NULL: there are. */
static const char *take_samples(const pl_result_row *const *rows, int count, double *scratch,
                                pl_sweep_point *point)
{
    double *raw = scratch + count, *instructions = raw + count;
    int errors = 0, costs = 0, counted = 0;
    if (count == 0) {
        return "only changes of the scene were run";
    }
    if (pl_result_runtime(rows[0]->result) != NULL) {
        return "the engine is not native: its times are not ranked";
    }
    for (int i = 0; i < count; ++i) {
        const double found = error_of(rows[i]);
        const double cost = pl_result_row_metric(rows[i], PL_METRIC_TIME_PER_STEP) / point->dt;
        const double counts =
            pl_result_row_metric(rows[i], PL_METRIC_INSTRUCTIONS_PER_STEP) / point->dt;
        errors += isfinite(found);
        costs += is_cost(cost);
        if (isfinite(found) && is_cost(cost)) {
            raw[point->sample_count] = found;
            point->samples[point->sample_count++] =
                (pl_sweep_sample){cost, fmax(found, pl_sweep_error_floor)};
            instructions[counted] = counts;
            counted += is_cost(counts);
        }
    }
    if (point->sample_count == 0) {
        return rows[0]->primary_error[0] == '\0' ? "the scenario has no primary error"
               : errors == 0                     ? "the primary error has no value"
               : costs == 0                      ? "no time was measured"
                                                 : "no repeat has both an error and a time";
    }
    qsort(point->samples, (size_t)point->sample_count, sizeof *point->samples, by_cost);
    point->raw_error = pl_median(raw, point->sample_count);
    point->instructions = pl_median(instructions, counted);
    point->cost = median_of(point, false, 0, scratch);
    point->cost_mad = median_of(point, false, point->cost, scratch);
    return NULL;
}

/* Raises the errors of a point to the largest of its changes. Returns the change without an error; NULL: all have
 * one. */
static const pl_result_row *apply_changes(const pl_result_row *const *changed, int count,
                                          pl_sweep_point *point)
{
    for (int i = 0; i < count; ++i) {
        const double found = error_of(changed[i]);
        if (!isfinite(found)) {
            return changed[i];
        }
        if (found > point->raw_error) {
            point->raw_error = found;
            point->change = changed[i]->change;
        }
        for (int k = 0; k < point->sample_count; ++k) {
            point->samples[k].error = fmax(point->samples[k].error, found);
        }
    }
    return NULL;
}

/* Fills the numbers of a point from its rows: first those of the scene itself, then those of its
 * changes. The cost is that of the scene itself; the error is the largest of all. */
static void measure(const pl_result_row *const *rows, int count, pl_sweep_point *point)
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
    if (point->state != PL_SWEEP_OK) {
        return;
    }
    point->samples = pl_heap_new((size_t)own, sizeof *point->samples);
    double *scratch = pl_heap_new(3 * (size_t)own, sizeof *scratch);
    const pl_result_row *lacking = NULL;
    const char *reason = take_samples(rows, own, scratch, point);
    if (reason == NULL) {
        lacking = apply_changes(rows + own, point->changes, point);
    }
    if (lacking != NULL) {
        take_row(lacking, "the primary error has no value", point);
    }
    point->reason = reason != NULL ? reason : point->reason;
    point->state = reason != NULL || lacking != NULL ? PL_SWEEP_UNMEASURED : PL_SWEEP_OK;
    if (point->state == PL_SWEEP_OK) {
        point->error = median_of(point, true, 0, scratch);
    }
    free(scratch);
}

/* ---- Engines ---- */

/* The engine, or with its profile; one with a label of its own goes by that. */
static void name_engine(const pl_result_row *row, pl_sweep_kind kind, char name[128])
{
    const bool whole = kind == PL_SWEEP_WHOLE;
    const size_t length = strcspn(row->label, ",");
    snprintf(name, 128, "%.60s:%.60s", row->engine, row->profile);
    if (strlen(name) != length || memcmp(name, row->label, length) != 0) {
        snprintf(name, 128, "%.*s", (int)(whole ? strcspn(row->label, ":,") : length), row->label);
    } else if (whole || row->profile[0] == '\0') {
        snprintf(name, 128, "%.60s", row->engine);
    }
}

static int compare_listed(const void *left, const void *right)
{
    const pl_sweep_engine *a = left, *b = right;
    if (a->kind != b->kind) {
        return a->kind < b->kind ? -1 : 1;
    }
    if (a->is_home != b->is_home) {
        return a->is_home ? -1 : 1;
    }
    return strcmp(a->name, b->name);
}

/* The engine of a row, of that kind; -1: it is not listed. */
static int find_engine(const pl_sweep_analysis *analysis, const pl_result_row *row,
                       pl_sweep_kind kind)
{
    char name[128];
    name_engine(row, kind, name);
    int i = analysis->engine_count - 1;
    while (i >= 0 &&
           (analysis->engines[i].kind != kind || strcmp(analysis->engines[i].name, name) != 0)) {
        --i;
    }
    return i;
}

static bool is_listed_as(const pl_result_row *row, pl_sweep_kind kind)
{
    return kind != PL_SWEEP_SHIPPED || json_is_true(json_object_get(row->result, "as_shipped"));
}

/* Adds the engine of a row, of one of its kinds, unless it is there. */
static void list_engine(const pl_result_row *row, pl_sweep_kind kind, pl_sweep_analysis *analysis)
{
    const bool is_home = analysis->results->configurations[row->configuration].is_home;
    const json_t *record = json_object_get(row->result, "conformance");
    int place = find_engine(analysis, row, kind);
    if (place < 0) {
        pl_sweep_engine engine = {.is_home = is_home, .kind = kind};
        name_engine(row, kind, engine.name);
        place = analysis->engine_count;
        pl_push(&analysis->engines, &analysis->engine_count, &engine, sizeof engine);
    }
    analysis->engines[place].is_home &= is_home;
    if (kind == PL_SWEEP_PROFILE && strcmp(pl_json_get_text(record, "outcome"), "passed") != 0) {
        analysis->engines[place].unverified = row->spec;
    }
}

static void list_engines(pl_sweep_analysis *analysis)
{
    bool has_home[PL_SWEEP_KINDS] = {false};
    for (int i = 0; i < PL_SWEEP_KINDS * analysis->results->row_count; ++i) {
        const pl_result_row *row = &analysis->results->rows[i / PL_SWEEP_KINDS];
        const pl_sweep_kind kind = (pl_sweep_kind)(i % PL_SWEEP_KINDS);
        if (is_listed_as(row, kind)) {
            list_engine(row, kind, analysis);
        }
    }
    if (analysis->engine_count > 0) {
        qsort(analysis->engines, (size_t)analysis->engine_count, sizeof *analysis->engines,
              compare_listed);
    }
    for (int i = 0; i < analysis->engine_count; ++i) {
        has_home[analysis->engines[i].kind] |= analysis->engines[i].is_home;
    }
    for (int i = 0; i < analysis->engine_count; ++i) {
        pl_sweep_engine *engine = &analysis->engines[i];
        engine->is_first = engine->is_home || !has_home[engine->kind];
    }
    analysis->shown =
        has_home[PL_SWEEP_PROFILE] && !has_home[PL_SWEEP_WHOLE] ? PL_SWEEP_PROFILE : PL_SWEEP_WHOLE;
}

/* Whether results come from several builds of plumb, or of an engine. */
static bool has_several_builds(const pl_result_table *results)
{
    bool several = false;
    for (int i = 0; i < results->row_count && !several; ++i) {
        const pl_result_row *row = &results->rows[i], *first = results->rows;
        const char *version = pl_result_text(row->result, PL_PROGRAM, "version");
        several = strcmp(row->git, first->git) != 0 ||
                  strcmp(version, pl_result_text(first->result, PL_PROGRAM, "version")) != 0;
    }
    /* Configurations are by label, so that those of one profile are neighbours. */
    for (int i = 1; i < results->configuration_count && !several; ++i) {
        const pl_result_configuration *a = &results->configurations[i - 1], *b = a + 1;
        const size_t length = strcspn(a->label, ",");
        several = length == strcspn(b->label, ",") && memcmp(a->label, b->label, length) == 0 &&
                  (strcmp(a->version, b->version) != 0 || strcmp(a->binary, b->binary) != 0);
    }
    return several;
}

/* ---- Points ---- */

/* A new reference to a value; null where it is absent. */
static json_t *same(const json_t *object, const char *key)
{
    json_t *value = json_object_get(object, key);
    return value == NULL ? json_null() : json_incref(value);
}

static json_t *without_dt(const json_t *row, const char *object)
{
    json_t *copy = json_copy(json_object_get(row, object));
    json_object_del(copy, "dt");
    return copy != NULL ? copy : json_object();
}

static uint64_t hash_json(uint64_t hash, json_t *value)
{
    char *text = pl_result_to_line(value);
    hash = pl_hash_text(hash, text);
    free(text);
    json_decref(value);
    return hash;
}

/* Of what identifies the point, so that its random numbers do not depend on other points. */
static uint64_t hash_of(const pl_result_row *row)
{
    const json_t *json = row->result, *settings = json_object_get(json, "settings");
    const bool has_duration = json_object_get(row->params, "duration") != NULL;
    char dt[40];
    json_t *scene =
        json_pack("[o, o, o, o, o, o]", same(json, "scenario"), without_dt(json, "params"),
                  same(json, "seed"), same(json, "member"),
                  same(has_duration ? NULL : settings, "duration"), same(json, "primary_error"));
    json_t *series =
        json_pack("[o, o, o, o, o, o]", same(json, "engine"), same(json, "profile"),
                  same(json, "label"), without_dt(json, "settings"), same(json, "engine_version"),
                  same(json_object_get(json, PL_PROGRAM), "git"));
    if (row->binary[0] != '\0') {
        json_array_append_new(series, json_string(row->binary));
    }
    snprintf(dt, sizeof dt, "%.17g", row->dt);
    return pl_hash_text(hash_json(hash_json(PL_HASH_START, scene), series), dt);
}

/* Adds the point of a configuration on the cases [first, end): the scene itself, then its changes. */
static void add_point(const pl_result_scene *scene, int first, int end, int configuration,
                      pl_sweep_analysis *analysis)
{
    const pl_result_row **rows = NULL;
    int count = 0;
    for (int i = first; i < end; ++i) {
        const pl_result_cell *cell = pl_result_case_cell(&scene->cases[i], configuration);
        for (int k = 0; cell != NULL && k < cell->count; ++k) {
            const pl_result_row *row = &cell->rows[k];
            pl_push(&rows, &count, &row, sizeof(const pl_result_row *));
        }
    }
    if (count == 0) {
        return;
    }
    pl_sweep_point point = {.scene = analysis->scene_count - 1,
                            .configuration = configuration,
                            .dt = rows[0]->dt,
                            .hash = hash_of(rows[0])};
    for (int kind = 0; kind < PL_SWEEP_KINDS; ++kind) {
        point.engines[kind] = is_listed_as(rows[0], (pl_sweep_kind)kind)
                                  ? find_engine(analysis, rows[0], (pl_sweep_kind)kind)
                                  : -1;
    }
    measure(rows, count, &point);
    pl_push(&analysis->points, &analysis->point_count, &point, sizeof point);
    ++analysis->scenes[point.scene].count;
    free(rows);
}

static void add_points(const pl_result_scene *scene, pl_sweep_analysis *analysis)
{
    for (int c = 0; c < analysis->results->configuration_count; ++c) {
        for (int first = 0, end; first < scene->count; first = end) {
            const pl_result_case *cases = scene->cases;
            for (end = first + 1; end < scene->count && is_changed(cases[end].row) &&
                                  cases[end].row->dt == cases[first].row->dt;) {
                ++end;
            }
            add_point(scene, first, end, c, analysis);
        }
    }
}

/* The unit of the primary error, as the first result that has one states it. */
static const char *unit_of(const pl_result_scene *scene)
{
    const char *unit = "";
    for (int i = 0; i < scene->count; ++i) {
        for (int k = 0; k < scene->cases[i].count && unit[0] == '\0'; ++k) {
            const pl_result_cell *cell = &scene->cases[i].cells[k];
            unit = pl_json_get_text(json_object_get(cell->rows->metrics, scene->row->primary_error),
                                    "unit");
        }
    }
    return unit;
}

void pl_sweep_gather(pl_sweep_analysis *analysis)
{
    const pl_result_table *results = analysis->results;
    analysis->scenes = pl_heap_new((size_t)results->scene_count, sizeof *analysis->scenes);
    analysis->several_builds = has_several_builds(results);
    list_engines(analysis);
    for (int i = 0; i < results->scene_count; ++i) {
        const pl_result_scene *scene = &results->scenes[i];
        analysis->scenes[analysis->scene_count++] =
            (pl_sweep_scene){scene, unit_of(scene), .first = analysis->point_count};
        add_points(scene, analysis);
    }
}
