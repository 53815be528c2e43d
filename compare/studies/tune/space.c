/* Builds the space of tuned parameters from the table and the user's --vary and --fix. */
#include "space.h"

#include "studies/variant/tunable.h"

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
    char what[300];     /* the option with its text, for messages */
    char key[PL_NAME_SIZE];
    int index;        /* of the engine's option; PL_TUNE_RATE: "dt" */
    const char *rest; /* after the '=' */
} setting_text;

/* Splits KEY=REST, finds the option, and checks that it is the first with this key. */
static pl_status read_key(const pl_tune_space *space, const char *option, const char *text,
                          bool *given, setting_text *s, pl_error *error)
{
    const size_t length = strcspn(text, "=");
    s->option = option;
    snprintf(s->what, sizeof s->what, "%s %.250s", option, text);
    if (text[length] != '=' || length == 0 || length >= PL_NAME_SIZE) {
        return pl_fail(error, PL_BAD_INPUT, "%s takes KEY=%s; found \"%.200s\"", option,
                       strcmp(option, "--fix") == 0 ? "VALUE" : "LOW..HIGH", text);
    }
    memcpy(s->key, text, length);
    s->key[length] = '\0';
    s->rest = text + length + 1;
    const bool is_rate = strcmp(s->key, "dt") == 0;
    s->index = is_rate ? PL_TUNE_RATE : pl_engine_option_index(space->base.engine, s->key);
    if (s->index < 0 && !is_rate) {
        return unknown_key(space->base.engine, option, s->key, error);
    }
    if (given[s->index + 1]) {
        return pl_fail(error, PL_BAD_INPUT, "%s %s: %s is given twice", option, text, s->key);
    }
    given[s->index + 1] = true;
    return PL_OK;
}

/* A value of the option in its range; of dt, s. */
static pl_status read_value(const pl_tune_space *space, const setting_text *s, const char *text,
                            double *value, pl_error *error)
{
    const double shortest = 1e-6, longest = 1;
    const pl_engine_option *option = s->index < 0 ? NULL : &space->base.engine->options[s->index];
    const double low = option == NULL ? shortest : option->min;
    const double high = option == NULL ? longest : option->max;
    if (!pl_parse_number(text, value)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: \"%.60s\" is no number", s->what, text);
    }
    if (option != NULL && option->integer && *value != floor(*value)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected whole numbers, found %s", s->what, text);
    }
    return *value >= low && *value <= high
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT, "%s: expected %g to %g, found %s", s->what, low, high,
                         text);
}

static pl_status read_range(const pl_tune_space *space, const setting_text *s, double range[2],
                            pl_error *error)
{
    char low[PL_NAME_SIZE];
    const char *dots = strstr(s->rest, "..");
    if (dots == NULL || (size_t)(dots - s->rest) >= sizeof low) {
        return pl_fail(error, PL_BAD_INPUT, "%s takes KEY=LOW..HIGH", s->what);
    }
    memcpy(low, s->rest, (size_t)(dots - s->rest));
    low[dots - s->rest] = '\0';
    pl_status status = read_value(space, s, low, &range[0], error);
    if (status == PL_OK) {
        status = read_value(space, s, dots + 2, &range[1], error);
    }
    return status != PL_OK || range[0] < range[1]
               ? status
               : pl_fail(error, PL_BAD_INPUT, "%s: the range is empty", s->what);
}

static pl_status vary(pl_tune_space *space, const char *text, bool *given, pl_error *error)
{
    const double wide = 20; /* a new range is logarithmic where its ends differ by more */
    setting_text s;
    double range[2] = {0, 0};
    pl_status status = read_key(space, "--vary", text, given, &s, error);
    if (status == PL_OK) {
        status = read_range(space, &s, range, error);
    }
    if (status != PL_OK) {
        return status;
    }
    int at = find_parameter(space, s.key);
    const bool is_known = at >= 0;
    if (!is_known) {
        at = space->parameter_count++;
        space->parameters[at] = (pl_tune_parameter){.option = s.index};
        memcpy(space->parameters[at].name, s.key, sizeof s.key);
    }
    pl_tune_parameter *parameter = &space->parameters[at];
    if (s.index == PL_TUNE_RATE) {
        parameter->low = floor(1 / range[1] + 0.5);
        parameter->high = floor(1 / range[0] + 0.5);
        parameter->logarithmic = parameter->integer = true;
        parameter->start = isnan(space->dt) ? 60 : 1 / space->dt;
        space->keeps_dt = false;
        return parameter->low >= 1 && parameter->low < parameter->high
                   ? PL_OK
                   : pl_fail(error, PL_BAD_INPUT, "%s: no two whole rates lie in it", s.what);
    }
    parameter->low = range[0];
    parameter->high = range[1];
    parameter->integer = space->base.engine->options[s.index].integer;
    parameter->logarithmic =
        range[0] > 0 && (is_known ? parameter->logarithmic : range[1] > wide * range[0]);
    parameter->start = space->base.values[s.index];
    return PL_OK;
}

static pl_status fix(pl_tune_space *space, const char *text, bool *given, pl_error *error)
{
    setting_text s;
    double value = 0;
    pl_status status = read_key(space, "--fix", text, given, &s, error);
    if (status == PL_OK) {
        status = read_value(space, &s, s.rest, &value, error);
    }
    if (status != PL_OK) {
        return status;
    }
    const int at = find_parameter(space, s.key);
    if (at >= 0) {
        space->parameter_count -= 1;
        memmove(&space->parameters[at], &space->parameters[at + 1],
                (size_t)(space->parameter_count - at) * sizeof *space->parameters);
    }
    if (s.index == PL_TUNE_RATE) {
        space->dt = value;
        space->keeps_dt = false;
    } else {
        space->base.values[s.index] = value;
    }
    return PL_OK;
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
    pl_status status = PL_OK;
    add_table(space);
    for (int i = 0; i < request->varied_count && status == PL_OK; ++i) {
        status = vary(space, request->varied[i], given, error);
    }
    for (int i = 0; i < request->fixed_count && status == PL_OK; ++i) {
        status = fix(space, request->fixed[i], given, error);
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

pl_engine_choice pl_tune_choice(const pl_tune_space *space, const double *values, double *dt)
{
    pl_engine_choice choice = space->base;
    *dt = space->dt;
    for (int i = 0; i < space->parameter_count; ++i) {
        const pl_tune_parameter *parameter = &space->parameters[i];
        if (parameter->option == PL_TUNE_RATE) {
            *dt = 1 / values[i];
        } else {
            choice.values[parameter->option] = values[i];
        }
    }
    pl_tune_spec(&choice, choice.spec);
    return choice;
}

void pl_tune_value_text(const pl_tune_parameter *parameter, double value, char text[32])
{
    snprintf(text, 32, "%s%.6g", parameter->option == PL_TUNE_RATE ? "1/" : "", value);
}
