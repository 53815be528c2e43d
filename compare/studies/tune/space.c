#include "space.h"

#include "tunable.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Steps a second. */
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

static void remove_parameter(pl_tune_space *space, int index)
{
    space->parameter_count -= 1;
    for (int i = index; i < space->parameter_count; ++i) {
        space->parameters[i] = space->parameters[i + 1];
    }
}

static pl_status unknown_key(const pl_engine *engine, const char *option, const char *key,
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

/* Splits KEY=REST, finds the option, and sees that it has not come before. */
static pl_status read_key(const pl_tune_space *space, const char *option, const char *text,
                          char key[PL_NAME_SIZE], int *index, const char **rest, bool *given,
                          pl_error *error)
{
    const size_t length = strcspn(text, "=");
    if (text[length] != '=' || length == 0 || length >= PL_NAME_SIZE) {
        return pl_fail(error, PL_BAD_INPUT, "%s takes KEY=%s; found \"%.200s\"", option,
                       strcmp(option, "--fix") == 0 ? "VALUE" : "LOW..HIGH", text);
    }
    memcpy(key, text, length);
    key[length] = '\0';
    *rest = text + length + 1;
    *index =
        strcmp(key, "dt") == 0 ? PL_TUNE_RATE : pl_engine_option_index(space->base.engine, key);
    if (*index < 0 && strcmp(key, "dt") != 0) {
        return unknown_key(space->base.engine, option, key, error);
    }
    bool *mine = &given[*index + 1];
    if (*mine) {
        return pl_fail(error, PL_BAD_INPUT, "%s %s: %s is given twice", option, text, key);
    }
    *mine = true;
    return PL_OK;
}

/* A value of the option in its range; of dt, s. */
static pl_status read_value(const pl_tune_space *space, int index, const char *what,
                            const char *text, double *value, pl_error *error)
{
    const double shortest = 1e-6, longest = 1;
    const pl_engine_option *option = index < 0 ? NULL : &space->base.engine->options[index];
    const double low = index < 0 ? shortest : option->min;
    const double high = index < 0 ? longest : option->max;
    if (!pl_parse_number(text, value)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: \"%.60s\" is no number", what, text);
    }
    if (index >= 0 && option->integer && *value != floor(*value)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected whole numbers, found %s", what, text);
    }
    return *value >= low && *value <= high
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT, "%s: expected %g to %g, found %s", what, low, high,
                         text);
}

static pl_status read_range(const pl_tune_space *space, int index, const char *what,
                            const char *text, double range[2], pl_error *error)
{
    char low[PL_NAME_SIZE];
    const char *dots = strstr(text, "..");
    if (dots == NULL || (size_t)(dots - text) >= sizeof low) {
        return pl_fail(error, PL_BAD_INPUT, "%s takes KEY=LOW..HIGH", what);
    }
    memcpy(low, text, (size_t)(dots - text));
    low[dots - text] = '\0';
    pl_status status = read_value(space, index, what, low, &range[0], error);
    if (status == PL_OK) {
        status = read_value(space, index, what, dots + 2, &range[1], error);
    }
    return status != PL_OK || range[0] < range[1]
               ? status
               : pl_fail(error, PL_BAD_INPUT, "%s: the range is empty", what);
}

static pl_status vary(pl_tune_space *space, const char *text, bool *given, pl_error *error)
{
    const double wide = 20;
    char key[PL_NAME_SIZE], what[300];
    int index = 0;
    double range[2] = {0, 0};
    const char *rest = "";
    snprintf(what, sizeof what, "--vary %.250s", text);
    pl_status status = read_key(space, "--vary", text, key, &index, &rest, given, error);
    if (status == PL_OK) {
        status = read_range(space, index, what, rest, range, error);
    }
    if (status != PL_OK) {
        return status;
    }
    int at = find_parameter(space, key);
    const bool is_known = at >= 0;
    if (!is_known) {
        at = space->parameter_count++;
        space->parameters[at] = (pl_tune_parameter){.option = index};
        memcpy(space->parameters[at].name, key, sizeof key);
    }
    pl_tune_parameter *parameter = &space->parameters[at];
    if (index == PL_TUNE_RATE) {
        parameter->low = floor(1 / range[1] + 0.5);
        parameter->high = floor(1 / range[0] + 0.5);
        parameter->logarithmic = parameter->integer = true;
        parameter->start = isnan(space->dt) ? 60 : 1 / space->dt;
        space->keeps_dt = false;
        if (parameter->low < 1 || parameter->low >= parameter->high) {
            return pl_fail(error, PL_BAD_INPUT, "%s: no two whole rates lie in it", what);
        }
        return PL_OK;
    }
    parameter->low = range[0];
    parameter->high = range[1];
    parameter->integer = space->base.engine->options[index].integer;
    parameter->logarithmic =
        range[0] > 0 && (is_known ? parameter->logarithmic : range[1] > wide * range[0]);
    parameter->start = space->base.values[index];
    return PL_OK;
}

static pl_status fix(pl_tune_space *space, const char *text, bool *given, pl_error *error)
{
    char key[PL_NAME_SIZE], what[300];
    int index = 0;
    double value = 0;
    const char *rest = "";
    snprintf(what, sizeof what, "--fix %.250s", text);
    pl_status status = read_key(space, "--fix", text, key, &index, &rest, given, error);
    if (status == PL_OK) {
        status = read_value(space, index, what, rest, &value, error);
    }
    if (status != PL_OK) {
        return status;
    }
    const int at = find_parameter(space, key);
    if (at >= 0) {
        remove_parameter(space, at);
    }
    if (index == PL_TUNE_RATE) {
        space->dt = value;
        space->keeps_dt = false;
    } else {
        space->base.values[index] = value;
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

/* The table's parameters but those of options that the user set. */
static pl_status add_table(pl_tune_space *space, pl_error *error)
{
    const pl_engine *engine = space->base.engine;
    pl_engine_choice shipped;
    pl_status status = pl_tune_shipped(&space->base, &shipped, error);
    for (int i = 0; i < engine->option_count && status == PL_OK; ++i) {
        const pl_engine_option *option = &engine->options[i];
        const pl_tunable *tunable = pl_tunable_find(engine, space->base.profile, option->name);
        if (tunable == NULL || space->base.values[i] != shipped.values[i]) {
            continue;
        }
        pl_tune_parameter *parameter = &space->parameters[space->parameter_count++];
        *parameter = (pl_tune_parameter){.option = i,
                                         .low = fmax(tunable->low, option->min),
                                         .high = fmin(tunable->high, option->max),
                                         .logarithmic = tunable->logarithmic,
                                         .integer = option->integer,
                                         .start = space->base.values[i]};
        snprintf(parameter->name, sizeof parameter->name, "%s", option->name);
    }
    return status;
}

pl_status pl_tune_space_make(const pl_engine_choice *engine, double dt, const char *const *varied,
                             int varied_count, const char *const *fixed, int fixed_count,
                             pl_tune_space *space, pl_error *error)
{
    bool given[PL_TUNE_MAX_PARAMETERS] = {false};
    *space = (pl_tune_space){.base = *engine, .dt = dt};
    add_rate(space, dt);
    pl_status status = add_table(space, error);
    for (int i = 0; i < varied_count && status == PL_OK; ++i) {
        status = vary(space, varied[i], given, error);
    }
    for (int i = 0; i < fixed_count && status == PL_OK; ++i) {
        status = fix(space, fixed[i], given, error);
    }
    for (int i = 0; i < space->parameter_count; ++i) {
        pl_tune_parameter *parameter = &space->parameters[i];
        parameter->spends =
            parameter->option == PL_TUNE_RATE || strcmp(parameter->name, "iterations") == 0;
    }
    if (find_parameter(space, "dt") >= 0) {
        space->dt = (double)NAN;
    }
    return status;
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
