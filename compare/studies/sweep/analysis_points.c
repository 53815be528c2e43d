/* Groups rows of results into scenes, series and points by keys: canonical JSON of the fields that
 * identify a scene, and those that identify a series, which are all except the time step. */
#include "analysis_parts.h"

#include "base/hash.h"
#include "base/statistics.h"
#include "results/result.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Scenes ---- */

/* The scenario, with the parameters that are not at their defaults, the seed and the member. */
static void name_scene(pl_sweep_scene *scene)
{
    const json_t *params = json_object_get(scene->row, "params");
    const json_int_t seed = json_integer_value(json_object_get(scene->row, "seed"));
    const json_t *member = json_object_get(scene->row, "member");
    const size_t size = sizeof scene->name;
    size_t used = (size_t)snprintf(scene->name, size, "%.120s", scene->scenario);
    for (int i = 0; scene->catalogue != NULL && i < scene->catalogue->param_count && used < size;
         ++i) {
        const pl_param *param = &scene->catalogue->params[i];
        const json_t *value = json_object_get(params, param->name);
        bool bare = strcmp(param->unit, "1") == 0 || param->unit[0] == '\0';
        if (strcmp(param->name, "dt") != 0 && json_is_number(value) &&
            json_number_value(value) != param->value) {
            used += (size_t)snprintf(scene->name + used, size - used, " %s=%.6g%s%s", param->name,
                                     json_number_value(value), bare ? "" : " ",
                                     bare ? "" : param->unit);
        }
    }
    if (seed != 0 && used < size) {
        used +=
            (size_t)snprintf(scene->name + used, size - used, " seed=%" JSON_INTEGER_FORMAT, seed);
    }
    if (json_is_integer(member) && used < size) {
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

/* Fills the numbers of a point from its repeats. */
static pl_status pl_sweep_measure(const json_t *const *rows, int count, pl_sweep_point *point,
                                  pl_error *error)
{
    point->row = rows[0];
    point->repeats = count;
    point->state = PL_SWEEP_OK;
    point->cost = point->cost_mad = point->error = point->raw_error = point->instructions =
        (double)NAN;
    for (int i = 0; i < count && point->state == PL_SWEEP_OK; ++i) {
        if (strcmp(pl_json_get_text(rows[i], "outcome"), "ok") != 0) {
            point->state = strcmp(pl_json_get_text(rows[i], "outcome"), "unsupported") == 0
                               ? PL_SWEEP_UNSUPPORTED
                               : PL_SWEEP_FAILED;
            point->row = rows[i];
        }
    }
    point->outcome = pl_json_get_text(point->row, "outcome");
    point->reason = pl_json_get_text(point->row, "reason");
    point->label = pl_json_get_text(point->row, "label");
    if (point->state != PL_SWEEP_OK) {
        return PL_OK;
    }
    point->samples = calloc((size_t)count, sizeof *point->samples);
    double *scratch = calloc(3 * (size_t)count, sizeof *scratch);
    if (point->samples == NULL || scratch == NULL) {
        free(scratch);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d repeats", count);
    }
    double *raw = scratch + count, *instructions = raw + count;
    int errors = 0, costs = 0, counted = 0;
    for (int i = 0; i < count; ++i) {
        double found = fabs(pl_result_metric(rows[i], pl_json_get_text(rows[i], "primary_error")));
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
    } else {
        qsort(point->samples, (size_t)point->sample_count, sizeof *point->samples, by_cost);
        point->raw_error = pl_median(raw, point->sample_count);
        point->instructions = pl_median(instructions, counted);
        point->cost = median_of(point, false, 0, scratch);
        point->cost_mad = median_of(point, false, point->cost, scratch);
        point->error = median_of(point, true, 0, scratch);
    }
    free(scratch);
    return PL_OK;
}

/* ---- Rows and their keys ---- */

/* A row with its keys. */
typedef struct keyed_row {
    const json_t *row;
    char *scene, *series; /* owned */
    double dt;
    size_t index;
} keyed_row;

static pl_status check_row(const json_t *row, size_t index, pl_error *error)
{
    static const char *const texts[] = {"scenario", "engine",  "profile",
                                        "label",    "outcome", "primary_error"};
    static const char *const objects[] = {"params", "settings", "metrics"};
    if (!json_is_object(row)) {
        return pl_fail(error, PL_BAD_INPUT, "results[%zu]: expected an object", index);
    }
    if (strcmp(pl_json_get_text(row, "schema"), "plumb.result/1") != 0) {
        return pl_fail(error, PL_BAD_INPUT,
                       "results[%zu].schema: expected \"plumb.result/1\", found \"%.40s\"", index,
                       pl_json_get_text(row, "schema"));
    }
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        if (!json_is_string(json_object_get(row, texts[i]))) {
            return pl_fail(error, PL_BAD_INPUT, "results[%zu].%s: expected a string", index,
                           texts[i]);
        }
    }
    for (size_t i = 0; i < sizeof objects / sizeof objects[0]; ++i) {
        if (!json_is_object(json_object_get(row, objects[i]))) {
            return pl_fail(error, PL_BAD_INPUT, "results[%zu].%s: expected an object", index,
                           objects[i]);
        }
    }
    const json_t *dt = json_object_get(json_object_get(row, "settings"), "dt");
    if (!json_is_number(dt) || !(json_number_value(dt) > 0)) {
        return pl_fail(error, PL_BAD_INPUT,
                       "results[%zu].settings.dt: expected a time step above 0", index);
    }
    return PL_OK;
}

static json_t *without_dt(const json_t *row, const char *object)
{
    json_t *copy = json_copy(json_object_get(row, object));
    json_object_del(copy, "dt");
    return copy;
}

/* A new reference to a value; null where it is absent. */
static json_t *same(const json_t *object, const char *key)
{
    json_t *value = json_object_get(object, key);
    return value == NULL ? json_null() : json_incref(value);
}

static char *to_text(json_t *value)
{
    char *text = value == NULL
                     ? NULL
                     : json_dumps(value, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
    json_decref(value);
    return text;
}

static pl_status make_keys(const json_t *row, size_t index, keyed_row *keyed, pl_error *error)
{
    const json_t *settings = json_object_get(row, "settings"),
                 *plumb = json_object_get(row, "plumb");
    /* A scene file has no parameters; its duration may still have been replaced. */
    bool is_file = json_object_size(json_object_get(row, "params")) == 0;
    keyed->row = row;
    keyed->index = index;
    keyed->dt = json_number_value(json_object_get(settings, "dt"));
    keyed->scene =
        to_text(json_pack("[o, o, o, o, o, o]", same(row, "scenario"), without_dt(row, "params"),
                          same(row, "seed"), same(row, "member"),
                          same(is_file ? settings : NULL, "duration"), same(row, "primary_error")));
    json_t *series = json_pack("[o, o, o, o, o, o]", same(row, "engine"), same(row, "profile"),
                               same(row, "label"), without_dt(row, "settings"),
                               same(row, "engine_version"), same(plumb, "git"));
    json_t *binary = json_object_get(row, "engine_binary");
    if (binary != NULL) { /* results of earlier versions have none */
        json_array_append(series, binary);
    }
    keyed->series = to_text(series);
    if (keyed->scene == NULL || keyed->series == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory at result %zu", index);
    }
    return PL_OK;
}

/* ---- Orders ---- */

static int catalogue_index(const char *scenario)
{
    int count = 0, i = 0;
    const pl_scenario *const *all = pl_scenarios(&count);
    while (i < count && strcmp(all[i]->name, scenario) != 0) {
        ++i;
    }
    return i;
}

static bool is_ours(const char *engine)
{
    return strcmp(engine, "plumb") == 0;
}

static int compare_scenes(const keyed_row *a, const keyed_row *b)
{
    if (strcmp(a->scene, b->scene) == 0) {
        return 0;
    }
    const char *scenario_a = pl_json_get_text(a->row, "scenario");
    const char *scenario_b = pl_json_get_text(b->row, "scenario");
    int order = catalogue_index(scenario_a) - catalogue_index(scenario_b);
    order = order != 0 ? order : strcmp(scenario_a, scenario_b);
    const pl_scenario *scenario = order == 0 ? pl_scenario_find(scenario_a, NULL) : NULL;
    for (int i = 0; order == 0 && scenario != NULL && i < scenario->param_count; ++i) {
        const char *name = scenario->params[i].name;
        double x = json_number_value(json_object_get(json_object_get(a->row, "params"), name));
        double y = json_number_value(json_object_get(json_object_get(b->row, "params"), name));
        order = strcmp(name, "dt") == 0 ? 0 : (x > y) - (x < y);
    }
    return order != 0 ? order : strcmp(a->scene, b->scene);
}

static int compare_engines(const json_t *a, const json_t *b)
{
    const char *name_a = pl_json_get_text(a, "engine"), *name_b = pl_json_get_text(b, "engine");
    if (is_ours(name_a) != is_ours(name_b)) {
        return is_ours(name_a) ? -1 : 1;
    }
    int order = strcmp(name_a, name_b);
    return order != 0 ? order
                      : strcmp(pl_json_get_text(a, "profile"), pl_json_get_text(b, "profile"));
}

/* By scene, engine, series and falling dt; 0 for repeats of one point. */
static int compare_rows(const void *left, const void *right)
{
    const keyed_row *a = left, *b = right;
    int order = compare_scenes(a, b);
    order = order != 0 ? order : compare_engines(a->row, b->row);
    order = order != 0 ? order : strcmp(a->series, b->series);
    return order != 0 ? order : (a->dt < b->dt) - (a->dt > b->dt);
}

/* The same, with repeats ordered too, so that the order of the rows has no effect. */
static int compare_repeats(const void *left, const void *right)
{
    const keyed_row *a = left, *b = right;
    int order = compare_rows(a, b);
    if (order != 0) {
        return order;
    }
    json_int_t repeat_a = json_integer_value(json_object_get(a->row, "repeat"));
    json_int_t repeat_b = json_integer_value(json_object_get(b->row, "repeat"));
    if (repeat_a != repeat_b) {
        return repeat_a < repeat_b ? -1 : 1;
    }
    order = strcmp(pl_json_get_text(a->row, "started"), pl_json_get_text(b->row, "started"));
    return order != 0 ? order : (a->index > b->index) - (a->index < b->index);
}

/* ---- Engines ---- */

static int find_engine(const pl_sweep_analysis *analysis, const char *name, bool whole)
{
    for (int i = 0; i < analysis->engine_count; ++i) {
        if (analysis->engines[i].whole == whole && strcmp(analysis->engines[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

/* The engine, or with its profile; one with a label of its own goes by that. */
static void name_engine(const json_t *row, bool whole, char name[128])
{
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
    if (a->whole != b->whole) {
        return a->whole ? -1 : 1;
    }
    if (a->ours != b->ours) {
        return a->ours ? -1 : 1;
    }
    return strcmp(a->name, b->name);
}

static void list_engines(const keyed_row *rows, size_t count, pl_sweep_analysis *analysis)
{
    for (size_t i = 0; i < 2 * count; ++i) {
        const json_t *row = rows[i / 2].row;
        pl_sweep_engine engine = {.ours = is_ours(pl_json_get_text(row, "engine")),
                                  .whole = i % 2 == 0};
        name_engine(row, engine.whole, engine.name);
        if (find_engine(analysis, engine.name, engine.whole) < 0) {
            analysis->engines[analysis->engine_count++] = engine;
        }
        const json_t *record = json_object_get(row, "conformance");
        if (!engine.whole && strcmp(pl_json_get_text(record, "outcome"), "passed") != 0) {
            const char *spec = pl_json_get_text(row, "engine_spec");
            analysis->engines[find_engine(analysis, engine.name, false)].unverified = spec;
        }
    }
    qsort(analysis->engines, (size_t)analysis->engine_count, sizeof *analysis->engines,
          compare_listed);
}

/* ---- Points ---- */

static uint64_t hash_of(const keyed_row *row)
{
    char dt[40];
    snprintf(dt, sizeof dt, "%.17g", row->dt);
    return pl_hash_text(pl_hash_text(pl_hash_text(PL_HASH_START, row->scene), row->series), dt);
}

static bool differ_in(const keyed_row *a, const keyed_row *b, const char *object, const char *key)
{
    const json_t *in_a = object == NULL ? a->row : json_object_get(a->row, object);
    const json_t *in_b = object == NULL ? b->row : json_object_get(b->row, object);
    return strcmp(pl_json_get_text(in_a, key), pl_json_get_text(in_b, key)) != 0;
}

static void note_origins(const keyed_row *rows, size_t index, pl_sweep_analysis *analysis)
{
    const keyed_row *row = &rows[index];
    size_t alike = 0;
    char name[128], other[128];
    name_engine(row->row, false, name);
    do {
        name_engine(rows[alike].row, false, other);
    } while (strcmp(name, other) != 0 && ++alike < index);
    analysis->several_hosts |= differ_in(row, &rows[0], "host", "cpu");
    analysis->several_builds |= differ_in(row, &rows[0], "plumb", "version") ||
                                differ_in(row, &rows[0], "plumb", "git") ||
                                differ_in(row, &rows[alike], NULL, "engine_version") ||
                                differ_in(row, &rows[alike], NULL, "engine_binary");
}

/* Adds the point whose repeats are the sorted rows [first, next). */
static pl_status add_point(const keyed_row *rows, size_t first, size_t next, const json_t **repeats,
                           pl_sweep_analysis *analysis, pl_error *error)
{
    const keyed_row *row = &rows[first];
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
    for (int i = 0; i < 2; ++i) {
        name_engine(row->row, i == 0, name);
        point->engines[i] = find_engine(analysis, name, i == 0);
    }
    ++analysis->scenes[point->scene].count;
    analysis->run_count += count;
    return pl_sweep_measure(repeats, count, point, error);
}

static pl_status add_points(keyed_row *rows, size_t count, pl_sweep_analysis *analysis,
                            pl_error *error)
{
    pl_status status = PL_OK;
    const json_t **repeats = calloc(count + 1, sizeof(const json_t *));
    if (repeats == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu results", count);
    }
    qsort(rows, count, sizeof *rows, compare_repeats);
    for (size_t first = 0, next; first < count && status == PL_OK; first = next) {
        for (next = first + 1; next < count && compare_rows(&rows[first], &rows[next]) == 0;) {
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
    keyed_row *rows = calloc(count + 1, sizeof *rows);
    analysis->points = calloc(count + 1, sizeof *analysis->points);
    analysis->scenes = calloc(count + 1, sizeof *analysis->scenes);
    analysis->engines = calloc(2 * count + 1, sizeof *analysis->engines);
    if (rows == NULL || analysis->points == NULL || analysis->scenes == NULL ||
        analysis->engines == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for %zu results", count);
    }
    for (size_t i = 0; i < count && status == PL_OK; ++i) {
        const json_t *row = json_array_get(results, i);
        status = check_row(row, i, error);
        if (status == PL_OK) {
            status = make_keys(row, i, &rows[i], error);
        }
    }
    if (status == PL_OK) {
        list_engines(rows, count, analysis);
        status = add_points(rows, count, analysis, error);
    }
    for (size_t i = 0; i < count && rows != NULL; ++i) {
        free(rows[i].scene);
        free(rows[i].series);
    }
    free(rows);
    return status;
}
