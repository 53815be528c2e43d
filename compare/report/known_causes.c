/* Reads known_causes.json, plumb.known-causes/2:
 *
 *     {"schema": "plumb.known-causes/2", "found_with": TEXT,
 *      "versions": {ENGINE: [OLDEST, NEWEST], ...}, "profiles": {ENGINE: [PROFILE, ...], ...}?,
 *      "causes": [{"id": TEXT, "engine": ENGINE, "profile": TEXT?, "outcome": TEXT?,
 *                  "versions": [OLDEST, NEWEST]?,
 *                  "scenarios": {SCENARIO: {PARAMETER: [LEAST, LARGEST], ...}, ...},
 *                  "cause": TEXT or null, "evidence": TEXT}, ...]}
 *
 * Each statement was found by experiments: an option of the engine, the time step or the scene was
 * varied, or the adapter was changed for the purpose. They are in
 * tests/compare/known_causes_experiments.json by the id of the statement, and
 * tests/compare/test_known_causes_slow.sh replays them. `h` in the texts is the scenario's time step. A number is given as such
 * or as a text with a fraction, "1/240". Statements without versions have those of the whole file,
 * and those without a profile are about all profiles that the file lists for the engine.
 *
 * ODE's two bounded directions and its implicit gyroscopic torque are in its manual. That dantzig
 * takes the bounds from the frictionless normal forces is inferred from the angle of `ladder`. */
#include "known_causes.h"

#include "base/heap.h"
#include "base/json_field.h"
#include "base/json_text.h"
#include "plumb/scenario.h"
#include "results/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BYTES = 1 << 20 };

/* The file, which compare/CMakeLists.txt builds into the program. */
extern const char pl_known_causes_json[];

static const char *const file_keys[] = {"schema", "found_with", "versions", "profiles", "causes"};
static const char *const cause_keys[] = {"id",       "engine",    "profile", "outcome",
                                         "versions", "scenarios", "cause",   "evidence"};
static const pl_key_set file_set = PL_KEY_SET("known causes", file_keys);
static const pl_key_set cause_set = PL_KEY_SET("known cause", cause_keys);

/* A bound of a range; NAN where it is neither a number nor a text with one. */
static double bound_of(const json_t *range, size_t index)
{
    const json_t *bound = json_array_get(range, index);
    double value = (double)NAN;
    if (json_is_string(bound) && !pl_parse_number(json_string_value(bound), &value)) {
        value = (double)NAN;
    }
    return json_is_number(bound) ? json_number_value(bound) : value;
}

/* ---- Reading ---- */

/* Returns false unless `pair` is the oldest and the newest version. */
static bool read_versions(const json_t *pair, pl_known_cause *cause)
{
    cause->oldest = json_string_value(json_array_get(pair, 0));
    cause->newest = json_string_value(json_array_get(pair, 1));
    return json_array_size(pair) == 2 && cause->oldest != NULL && cause->newest != NULL &&
           strverscmp(cause->oldest, cause->newest) <= 0;
}

static const pl_param *find_param(const pl_scenario *scenario, const char *name)
{
    for (int i = 0; i < scenario->param_count; ++i) {
        if (strcmp(scenario->params[i].name, name) == 0) {
            return &scenario->params[i];
        }
    }
    return NULL;
}

static bool check_scenario(const json_t *scenarios, const char *name, pl_diagnostic *diagnostic)
{
    const pl_scenario *scenario = pl_scenario_find(name, NULL);
    json_t *ranges = json_object_get(scenarios, name), *range;
    const char *key;
    if (scenario == NULL) {
        return pl_diagnose_field(diagnostic, name, "expected a scenario, found another name");
    }
    if (!json_is_object(ranges)) {
        return pl_diagnose_field(diagnostic, name, "expected an object of ranges");
    }
    pl_path_push_key(&diagnostic->path, name);
    json_object_foreach(ranges, key, range)
    {
        const pl_param *param = find_param(scenario, key);
        const double least = bound_of(range, 0), largest = bound_of(range, 1);
        if (param == NULL) {
            return pl_diagnose_field(diagnostic, key, "expected a parameter of %s", name);
        }
        if (json_array_size(range) != 2 || !(least <= largest) || least < param->min ||
            largest > param->max) {
            return pl_diagnose_field(diagnostic, key,
                                     "expected the least and the largest value, within %g to %g",
                                     param->min, param->max);
        }
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool read_scenarios(const json_t *json, pl_known_cause *cause, pl_diagnostic *diagnostic)
{
    const char *name;
    json_t *ranges;
    json_t *scenarios = json_object_get(json, "scenarios");
    cause->scenarios = scenarios;
    if (json_object_size(scenarios) == 0) {
        return pl_diagnose_field(diagnostic, "scenarios", "expected an object of scenarios");
    }
    pl_path_push_key(&diagnostic->path, "scenarios");
    json_object_foreach(scenarios, name, ranges)
    {
        if (!check_scenario(scenarios, name, diagnostic)) {
            return false;
        }
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool read_cause(const json_t *json, const json_t *file, pl_known_cause *cause,
                       pl_diagnostic *diagnostic)
{
    const json_t *versions = json_object_get(file, "versions");
    if (!pl_json_object(json, &cause_set, diagnostic) ||
        !pl_json_string(json, "id", PL_REQUIRED, "a name", &cause->id, diagnostic) ||
        !pl_json_string(json, "engine", PL_REQUIRED, "an engine", &cause->engine, diagnostic) ||
        !pl_json_string(json, "profile", PL_OPTIONAL, "a profile", &cause->profile, diagnostic) ||
        !pl_json_string(json, "outcome", PL_OPTIONAL, "an outcome", &cause->outcome, diagnostic) ||
        !pl_json_string(json, "evidence", PL_REQUIRED, "a text", &cause->evidence, diagnostic) ||
        !read_scenarios(json, cause, diagnostic)) {
        return false;
    }
    cause->profiles = json_object_get(json_object_get(file, "profiles"), cause->engine);
    if (!json_is_null(json_object_get(json, "cause")) &&
        !pl_json_string(json, "cause", PL_REQUIRED, "a text or null", &cause->cause, diagnostic)) {
        return false;
    }
    if (json_object_get(json, "versions") != NULL) {
        return read_versions(json_object_get(json, "versions"), cause) ||
               pl_diagnose_field(diagnostic, "versions",
                                 "expected the oldest and the newest version");
    }
    return read_versions(json_object_get(versions, cause->engine), cause) ||
           pl_diagnose_field(
               diagnostic, "engine",
               "expected an engine of the file's versions, each the oldest and newest");
}

static bool read_file(const json_t *json, void *user, pl_diagnostic *diagnostic)
{
    pl_known_causes *causes = user;
    const char *schema = NULL;
    const json_t *array = NULL;
    size_t index;
    json_t *item;
    if (!pl_json_object(json, &file_set, diagnostic) ||
        !pl_json_string(json, "schema", PL_REQUIRED, "a schema", &schema, diagnostic) ||
        !pl_json_string(json, "found_with", PL_REQUIRED, "a text", &causes->found_with,
                        diagnostic) ||
        !pl_json_array(json, "causes", PL_REQUIRED, &array, diagnostic)) {
        return false;
    }
    if (strcmp(schema, "plumb.known-causes/2") != 0) {
        return pl_diagnose_field(diagnostic, "schema", "expected \"plumb.known-causes/2\"");
    }
    causes->json = json_incref((json_t *)json);
    causes->items = pl_heap_new(json_array_size(array), sizeof *causes->items);
    pl_path_push_key(&diagnostic->path, "causes");
    json_array_foreach(array, index, item)
    {
        pl_path_push_index(&diagnostic->path, (int)index);
        if (!read_cause(item, json, &causes->items[causes->count++], diagnostic)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

pl_status pl_known_causes_read(const char *text, const char *label, pl_known_causes *causes,
                               pl_error *error)
{
    static const pl_json_kind kind = {
        .noun = "file of known causes", .most_bytes = MOST_BYTES, .read = read_file};
    *causes = (pl_known_causes){0};
    if (text == NULL) {
        text = pl_known_causes_json;
        label = "known_causes.json";
    }
    return pl_json_read_text(&kind, text, strlen(text), label, causes, error);
}

void pl_known_causes_free(pl_known_causes *causes)
{
    json_decref(causes->json);
    free(causes->items);
    *causes = (pl_known_causes){0};
}

/* ---- Matching ---- */

/* Whether every parameter of a run lies in its range, or has its default where there is none.
 * Bounds are met to rounding. */
static bool are_in_ranges(const json_t *ranges, const pl_scenario *scenario, const json_t *params)
{
    for (int i = 0; i < scenario->param_count; ++i) {
        const pl_param *param = &scenario->params[i];
        const json_t *range = json_object_get(ranges, param->name);
        const json_t *given = json_object_get(params, param->name);
        const double value = json_is_number(given) ? json_number_value(given) : param->value;
        const double least = range == NULL ? param->value : bound_of(range, 0);
        const double largest = range == NULL ? param->value : bound_of(range, 1);
        if (value < least - 1e-9 * fabs(least) || value > largest + 1e-9 * fabs(largest)) {
            return false;
        }
    }
    return true;
}

/* Whether a statement is about a profile of its engine. */
static bool is_about(const pl_known_cause *cause, const char *profile)
{
    size_t index;
    const json_t *item;
    if (cause->profile != NULL || cause->profiles == NULL) {
        return cause->profile == NULL || strcmp(cause->profile, profile) == 0;
    }
    json_array_foreach(cause->profiles, index, item)
    {
        if (json_is_string(item) && strcmp(json_string_value(item), profile) == 0) {
            return true;
        }
    }
    return false;
}

const pl_known_cause *pl_known_cause_find(const pl_known_causes *causes, const json_t *result)
{
    const char *engine = pl_json_get_text(result, "engine");
    const char *version = pl_json_get_text(result, "engine_version");
    const char *profile = pl_json_get_text(result, "profile");
    const char *name = pl_json_get_text(result, "scenario");
    const char *outcome = pl_json_get_text(result, "outcome");
    const pl_scenario *scenario = pl_scenario_find(name, NULL);
    const bool cut_off = strcmp(outcome, "crashed") == 0 || strcmp(outcome, "timeout") == 0;
    /* Another label is that of other options, or of a build that was given a name. */
    char plain[2 * PL_NAME_SIZE + 2];
    snprintf(plain, sizeof plain, "%.63s:%.63s", engine, profile);
    const bool is_plain = strcmp(pl_json_get_text(result, "label"), plain) == 0;
    for (int i = 0; scenario != NULL && is_plain && i < causes->count; ++i) {
        const pl_known_cause *cause = &causes->items[i];
        const json_t *ranges = json_object_get(cause->scenarios, name);
        if (ranges != NULL && strcmp(cause->engine, engine) == 0 &&
            strverscmp(cause->oldest, version) <= 0 && strverscmp(version, cause->newest) <= 0 &&
            is_about(cause, profile) &&
            (cause->outcome == NULL ? !cut_off : strcmp(cause->outcome, outcome) == 0) &&
            are_in_ranges(ranges, scenario, json_object_get(result, "params"))) {
            return cause;
        }
    }
    return NULL;
}
