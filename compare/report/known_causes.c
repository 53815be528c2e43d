/* Searches known_causes.json, plumb.known-causes/2:
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
 * The file is part of the program; tests/compare/test_report_findings.c checks it.
 *
 * ODE's two bounded directions and its implicit gyroscopic torque are in its manual. That dantzig
 * takes the bounds from the frictionless normal forces is inferred from the angle of `ladder`. */
#include "report_document.h"

#include "base/json_text.h"
#include "plumb/scenario.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The file, which compare/CMakeLists.txt builds into the program. */
extern const char pl_known_causes_json[];

json_t *pl_known_causes(void)
{
    return json_loads(pl_known_causes_json, JSON_REJECT_DUPLICATES, NULL);
}

/* A bound of a range: a number, or a text with one. */
static double bound_of(const json_t *range, size_t index)
{
    const json_t *bound = json_array_get(range, index);
    double value = (double)NAN;
    if (json_is_string(bound)) {
        (void)pl_parse_number(json_string_value(bound), &value);
        return value;
    }
    return json_number_value(bound);
}

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

static bool has_text(const json_t *array, const char *text)
{
    size_t index;
    const json_t *item;
    json_array_foreach(array, index, item)
    {
        if (strcmp(json_string_value(item), text) == 0) {
            return true;
        }
    }
    return false;
}

/* The value of a key of a statement, else that of its engine in the file. */
static const json_t *of_engine(const json_t *causes, const json_t *cause, const char *key)
{
    const json_t *own = json_object_get(cause, key);
    return own != NULL
               ? own
               : json_object_get(json_object_get(causes, key), pl_json_get_text(cause, "engine"));
}

static bool is_of_version(const json_t *causes, const json_t *cause, const char *version)
{
    const json_t *range = of_engine(causes, cause, "versions");
    return strverscmp(json_string_value(json_array_get(range, 0)), version) <= 0 &&
           strverscmp(version, json_string_value(json_array_get(range, 1))) <= 0;
}

static bool is_of_profile(const json_t *causes, const json_t *cause, const char *profile)
{
    const char *own = pl_json_get_text(cause, "profile");
    const json_t *profiles = of_engine(causes, cause, "profiles");
    return own[0] != '\0' ? strcmp(own, profile) == 0
                          : profiles == NULL || has_text(profiles, profile);
}

/* A statement without an outcome is not about runs that were cut off. */
static bool is_of_outcome(const json_t *cause, const char *outcome)
{
    const char *own = pl_json_get_text(cause, "outcome");
    return own[0] != '\0' ? strcmp(own, outcome) == 0
                          : strcmp(outcome, "crashed") != 0 && strcmp(outcome, "timeout") != 0;
}

/* Whether a run has no options other than its profile's, and no label of its own. */
static bool is_plain(const json_t *result)
{
    char label[2 * PL_NAME_SIZE + 2];
    snprintf(label, sizeof label, "%.63s:%.63s", pl_json_get_text(result, "engine"),
             pl_json_get_text(result, "profile"));
    return strcmp(pl_json_get_text(result, "label"), label) == 0;
}

const json_t *pl_known_cause_find(const json_t *causes, const json_t *result)
{
    const char *name = pl_json_get_text(result, "scenario");
    const pl_scenario *scenario = pl_scenario_find(name, NULL);
    size_t index;
    const json_t *cause;
    if (scenario == NULL || !is_plain(result)) {
        return NULL;
    }
    json_array_foreach(json_object_get(causes, "causes"), index, cause)
    {
        const json_t *ranges = json_object_get(json_object_get(cause, "scenarios"), name);
        if (ranges != NULL &&
            strcmp(pl_json_get_text(cause, "engine"), pl_json_get_text(result, "engine")) == 0 &&
            is_of_version(causes, cause, pl_json_get_text(result, "engine_version")) &&
            is_of_profile(causes, cause, pl_json_get_text(result, "profile")) &&
            is_of_outcome(cause, pl_json_get_text(result, "outcome")) &&
            are_in_ranges(ranges, scenario, json_object_get(result, "params"))) {
            return cause;
        }
    }
    return NULL;
}
