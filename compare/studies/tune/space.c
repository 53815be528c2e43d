/* Builds the space of tuned parameters from the table and the user's --vary and --fix. */
#include "space.h"

#include "studies/tunable.h"
#include "studies/vary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Steps per second. */
static const double lowest_rate = 30, highest_rate = 1920;

static int find_parameter(const pl_tune_space *space, const char *name)
{
    for (int i = 0; i < space->parameter_count; ++i) {
        if (strcmp(space->parameters[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

static pl_status unknown_key(const pl_engine_info *engine, const char *option, const char *key,
                             pl_error *error)
{
    const char *names[PL_TUNE_MAX_PARAMETERS] = {"dt"};
    for (int i = 0; i < engine->option_count; ++i) {
        names[i + 1] = engine->options[i].name;
    }
    char suggestion[PL_SUGGESTION_SIZE];
    return pl_fail(error, PL_BAD_INPUT, "%s: %s has no option %s%s", option, engine->name, key,
                   pl_did_you_mean(key, names, engine->option_count + 1, suggestion));
}

/* One --vary or --fix. */
typedef struct setting_text {
    const char *option; /* "--vary" or "--fix" */
    pl_vary vary;
    int index; /* of the engine's option; PL_TUNE_RATE: "dt" */
} setting_text;

/* Reads the text, finds the option, and checks that it is the first with this key. The caller frees s->vary. */
static pl_status read_setting(const pl_tune_space *space, const char *text, pl_vary_form form,
                              bool *given, setting_text *s, pl_error *error)
{
    const pl_engine_info *engine = space->base.engine;
    s->option = form == PL_VARY_FIX ? "--fix" : "--vary";
    const pl_status status = pl_vary_parse(text, form, &s->vary, error);
    if (status != PL_OK) {
        return status;
    }
    if (!pl_vary_is_of(&s->vary, engine->name)) {
        return pl_fail(error, PL_BAD_INPUT, "%s %s: the engine that is tuned is %s", s->option,
                       text, engine->name);
    }
    const bool is_rate = strcmp(s->vary.key, "dt") == 0;
    s->index = is_rate ? PL_TUNE_RATE : pl_engine_option_index(engine, s->vary.key);
    if (s->index < 0 && !is_rate) {
        return unknown_key(engine, s->option, s->vary.key, error);
    }
    if (given[s->index + 1]) {
        return pl_fail(error, PL_BAD_INPUT, "%s %s: %s is given twice", s->option, text,
                       s->vary.key);
    }
    given[s->index + 1] = true;
    return PL_OK;
}

/* The value must be in the range of the option; of dt, s. */
static pl_status check_value(const pl_tune_space *space, const setting_text *s, double value,
                             pl_error *error)
{
    const double shortest = 1e-6, longest = 1;
    const pl_engine_option *option = s->index < 0 ? NULL : &space->base.engine->options[s->index];
    const double low = option == NULL ? shortest : option->min;
    const double high = option == NULL ? longest : option->max;
    if (option != NULL && option->integer && value != floor(value)) {
        return pl_fail(error, PL_BAD_INPUT, "%s %s: expected whole numbers, found %g", s->option,
                       s->vary.key, value);
    }
    return value >= low && value <= high
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT, "%s %s: expected %g to %g, found %g", s->option,
                         s->vary.key, low, high, value);
}

/* The parameter of the setting, which is added where the space lacks it; *is_known: it had it. */
static pl_tune_parameter *place_parameter(pl_tune_space *space, const setting_text *s,
                                          bool *is_known)
{
    const int at = find_parameter(space, s->vary.key);
    *is_known = at >= 0;
    pl_tune_parameter *parameter = &space->parameters[*is_known ? at : space->parameter_count++];
    if (!*is_known) {
        *parameter = (pl_tune_parameter){.option = s->index};
        memcpy(parameter->name, s->vary.key, sizeof s->vary.key);
    }
    return parameter;
}

static pl_status vary(pl_tune_space *space, const setting_text *s, pl_error *error)
{
    const double wide = 20; /* a new range is logarithmic where its ends differ by more */
    const double low = s->vary.low, high = s->vary.high;
    bool is_known = false;
    pl_status status = check_value(space, s, low, error);
    if (status == PL_OK) {
        status = check_value(space, s, high, error);
    }
    if (status != PL_OK) {
        return status;
    }
    pl_tune_parameter *parameter = place_parameter(space, s, &is_known);
    if (s->index == PL_TUNE_RATE) {
        parameter->low = floor(1 / high + 0.5);
        parameter->high = floor(1 / low + 0.5);
        parameter->logarithmic = parameter->integer = true;
        parameter->start = isnan(space->dt) ? 60 : 1 / space->dt;
        return parameter->low >= 1 && parameter->low < parameter->high
                   ? PL_OK
                   : pl_fail(error, PL_BAD_INPUT, "--vary dt: no two whole rates lie in %g..%g",
                             low, high);
    }
    parameter->low = low;
    parameter->high = high;
    parameter->integer = space->base.engine->options[s->index].integer;
    parameter->logarithmic = low > 0 && (is_known ? parameter->logarithmic : high > wide * low);
    parameter->start = space->base.values[s->index];
    return PL_OK;
}

static pl_status fix(pl_tune_space *space, const setting_text *s, pl_error *error)
{
    const double value = s->vary.numbers[0];
    const pl_status status = check_value(space, s, value, error);
    if (status != PL_OK) {
        return status;
    }
    const int at = find_parameter(space, s->vary.key);
    if (at >= 0) {
        space->parameter_count -= 1;
        memmove(&space->parameters[at], &space->parameters[at + 1],
                (size_t)(space->parameter_count - at) * sizeof *space->parameters);
    }
    if (s->index == PL_TUNE_RATE) {
        space->dt = value;
    } else {
        space->base.values[s->index] = value;
    }
    return PL_OK;
}

/* Takes all texts of --vary, or of --fix. */
static pl_status take_settings(pl_tune_space *space, const char *const *texts, int count,
                               pl_vary_form form, bool *given, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        setting_text s = {.option = NULL};
        status = read_setting(space, texts[i], form, given, &s, error);
        if (status == PL_OK) {
            status = form == PL_VARY_FIX ? fix(space, &s, error) : vary(space, &s, error);
        }
        pl_vary_free(&s.vary);
    }
    return status;
}

static void add_rate(pl_tune_space *space, double dt)
{
    pl_tune_parameter *parameter = &space->parameters[space->parameter_count++];
    const double rate = isnan(dt) ? 60 : 1 / dt;
    *parameter = (pl_tune_parameter){.name = "dt",
                                     .option = PL_TUNE_RATE,
                                     .low = lowest_rate,
                                     .high = highest_rate,
                                     .logarithmic = true,
                                     .integer = true,
                                     .start = rate};
}

/* Adds the tunable options, except those that the user set. */
static void add_table(pl_tune_space *space)
{
    const pl_engine_info *engine = space->base.engine;
    const double *defaults = pl_engine_profile_values(engine, space->base.profile);
    for (int i = 0; i < engine->option_count; ++i) {
        const pl_engine_option *option = &engine->options[i];
        pl_tunable tunable;
        if (!pl_tunable_find(engine, space->base.profile, i, &tunable) ||
            space->base.values[i] != defaults[i]) {
            continue;
        }
        pl_tune_parameter *parameter = &space->parameters[space->parameter_count++];
        *parameter = (pl_tune_parameter){.option = i,
                                         .low = fmax(tunable.low, option->min),
                                         .high = fmin(tunable.high, option->max),
                                         .logarithmic = tunable.logarithmic,
                                         .integer = option->integer,
                                         .start = space->base.values[i]};
        snprintf(parameter->name, sizeof parameter->name, "%s", option->name);
    }
}

/* The settings that a search finds are given as a SPEC. */
static pl_status check_spec(const pl_tune_space *space, pl_error *error)
{
    bool varied[PL_ENGINE_MAX_OPTIONS] = {false};
    for (int i = 0; i < space->parameter_count; ++i) {
        if (space->parameters[i].option != PL_TUNE_RATE) {
            varied[space->parameters[i].option] = true;
        }
    }
    return pl_tune_spec_fits(&space->base, varied)
               ? PL_OK
               : pl_fail(
                     error, PL_BAD_INPUT,
                     "engine \"%.40s...\": with the options that are tuned it is longer than %d "
                     "characters; run it by a shorter path",
                     space->base.engine->spec, PL_SPEC_SIZE - 1);
}

pl_status pl_tune_space_make(const pl_tune_request *request, pl_tune_space *space, pl_error *error)
{
    bool given[PL_TUNE_MAX_PARAMETERS] = {false};
    *space = (pl_tune_space){.base = *request->engine, .dt = request->dt};
    add_rate(space, request->dt);
    add_table(space);
    pl_status status =
        take_settings(space, request->varied, request->varied_count, PL_VARY_RANGE, given, error);
    if (status == PL_OK) {
        status =
            take_settings(space, request->fixed, request->fixed_count, PL_VARY_FIX, given, error);
    }
    for (int i = 0; i < space->parameter_count; ++i) {
        pl_tune_parameter *parameter = &space->parameters[i];
        parameter->spends =
            parameter->option == PL_TUNE_RATE || strcmp(parameter->name, "iterations") == 0;
    }
    if (find_parameter(space, "dt") >= 0) {
        space->dt = (double)NAN;
    }
    return status == PL_OK ? check_spec(space, error) : status;
}

json_t *pl_tune_values(const pl_tune_space *space, const double *values)
{
    json_t *list = json_array();
    for (int i = 0; i < space->parameter_count; ++i) {
        const bool is_rate = space->parameters[i].option == PL_TUNE_RATE;
        json_array_append_new(list, json_real(is_rate ? 1 / values[i] : values[i]));
    }
    return list;
}

pl_setting pl_tune_setting(const pl_tune_space *space, const json_t *values)
{
    pl_setting setting = {space->base, space->dt};
    for (int i = 0; i < space->parameter_count; ++i) {
        const int option = space->parameters[i].option;
        *(option == PL_TUNE_RATE ? &setting.dt : &setting.choice.values[option]) =
            json_number_value(json_array_get(values, (size_t)i));
    }
    pl_tune_spec(&setting.choice, setting.choice.spec);
    return setting;
}
