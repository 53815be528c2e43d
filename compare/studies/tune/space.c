/* Builds the space of tuned parameters from the table and the user's --vary and --fix. */
#include "tune.h"

#include "studies/tunable.h"
#include "studies/vary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* All that can be tuned of an engine: "dt" at place 0, which counts steps per second, then its options. */
typedef struct table {
    pl_tune_space *space;
    pl_tune_parameter items[PL_TUNE_MAX_PARAMETERS];
    bool is_tuned[PL_TUNE_MAX_PARAMETERS], is_given[PL_TUNE_MAX_PARAMETERS];
} table;

/* Tunes the step, and the tunable options but those that the user set. */
static void fill(table *t)
{
    const pl_engine_choice *base = &t->space->base;
    const double *defaults = pl_engine_profile_values(base->engine, base->profile);
    t->is_tuned[0] = true;
    t->items[0] = (pl_tune_parameter){.name = "dt",
                                      .option = PL_TUNE_RATE,
                                      .low = 30,
                                      .high = 1920,
                                      .logarithmic = true,
                                      .integer = true,
                                      .spends = true,
                                      .start = isnan(t->space->dt) ? 60 : 1 / t->space->dt};
    for (int i = 0; i < base->engine->option_count; ++i) {
        const pl_engine_option *option = &base->engine->options[i];
        pl_tune_parameter *parameter = &t->items[i + 1];
        pl_tunable tunable;
        *parameter = (pl_tune_parameter){.option = i,
                                         .integer = option->integer,
                                         .spends = strcmp(option->name, "iterations") == 0,
                                         .start = base->values[i]};
        snprintf(parameter->name, sizeof parameter->name, "%s", option->name);
        if (pl_tunable_find(base->engine, base->profile, i, &tunable) &&
            base->values[i] == defaults[i]) {
            t->is_tuned[i + 1] = true;
            parameter->low = fmax(tunable.low, option->min);
            parameter->high = fmin(tunable.high, option->max);
            parameter->logarithmic = tunable.logarithmic;
        }
    }
}

/* The place of what is called so in the table, the first time; -1: an error. */
static int place_of(table *t, const char *option, const char *text, const pl_vary *v,
                    pl_error *error)
{
    const pl_engine_info *engine = t->space->base.engine;
    const char *names[PL_TUNE_MAX_PARAMETERS];
    char suggestion[PL_SUGGESTION_SIZE];
    int place = -1;
    for (int i = 0; i <= engine->option_count; ++i) {
        names[i] = t->items[i].name;
        place = strcmp(names[i], v->key) == 0 ? i : place;
    }
    if (!pl_vary_is_of(v, engine->name)) {
        pl_fail(error, PL_BAD_INPUT, "%s %s: the engine that is tuned is %s", option, text,
                engine->name);
        return -1;
    }
    if (place < 0) {
        pl_fail(error, PL_BAD_INPUT, "%s: %s has no option %s%s", option, engine->name, v->key,
                pl_did_you_mean(v->key, names, engine->option_count + 1, suggestion));
    } else if (t->is_given[place]) {
        pl_fail(error, PL_BAD_INPUT, "%s %s: %s is given twice", option, text, v->key);
        return -1;
    }
    return place;
}

/* The value must be in the range of the option; of dt, s. */
static pl_status check_value(const table *t, int place, const char *option, double value,
                             pl_error *error)
{
    const pl_engine_option step = {.name = "dt", .min = 1e-6, .max = 1};
    const pl_engine_option *of = place == 0 ? &step : &t->space->base.engine->options[place - 1];
    if (of->integer && value != floor(value)) {
        return pl_fail(error, PL_BAD_INPUT, "%s %s: expected whole numbers, found %g", option,
                       of->name, value);
    }
    return value >= of->min && value <= of->max
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT, "%s %s: expected %g to %g, found %g", option,
                         of->name, of->min, of->max, value);
}

static pl_status vary(table *t, int place, double low, double high, pl_error *error)
{
    const double wide = 20; /* a new range is logarithmic where its ends differ by more */
    pl_tune_parameter *parameter = &t->items[place];
    if (place == 0) {
        parameter->low = floor(1 / high + 0.5);
        parameter->high = floor(1 / low + 0.5);
        return parameter->low >= 1 && parameter->low < parameter->high
                   ? PL_OK
                   : pl_fail(error, PL_BAD_INPUT, "--vary dt: no two whole rates lie in %g..%g",
                             low, high);
    }
    parameter->low = low;
    parameter->high = high;
    parameter->logarithmic =
        low > 0 && (t->is_tuned[place] ? parameter->logarithmic : high > wide * low);
    t->is_tuned[place] = true;
    return PL_OK;
}

static void fix(table *t, int place, double value)
{
    *(place == 0 ? &t->space->dt : &t->space->base.values[place - 1]) = value;
    t->is_tuned[place] = false;
}

/* Takes one --vary or --fix. */
static pl_status take_setting(table *t, const char *text, pl_vary_form form, pl_error *error)
{
    const bool fixes = form == PL_VARY_FIX;
    const char *option = fixes ? "--fix" : "--vary";
    pl_vary v;
    pl_status status = pl_vary_parse(text, form, &v, error);
    const int place = status == PL_OK ? place_of(t, option, text, &v, error) : -1;
    if (place < 0) {
        pl_vary_free(&v);
        return PL_BAD_INPUT;
    }
    t->is_given[place] = true;
    const double low = fixes ? v.numbers[0] : v.low, high = fixes ? low : v.high;
    status = check_value(t, place, option, low, error);
    if (status == PL_OK) {
        status = check_value(t, place, option, high, error);
    }
    if (status == PL_OK && fixes) {
        fix(t, place, low);
    } else if (status == PL_OK) {
        status = vary(t, place, low, high, error);
    }
    pl_vary_free(&v);
    return status;
}

/* Makes the space of what the table tunes. Settings that a search finds are given as a SPEC, which must have room. */
static pl_status finish(const table *t, pl_error *error)
{
    pl_tune_space *space = t->space;
    for (int i = 0; i <= space->base.engine->option_count; ++i) {
        if (t->is_tuned[i]) {
            space->parameters[space->parameter_count++] = t->items[i];
        }
    }
    space->dt = t->is_tuned[0] ? (double)NAN : space->dt;
    return pl_tune_spec_fits(&space->base, &t->is_tuned[1])
               ? PL_OK
               : pl_fail(
                     error, PL_BAD_INPUT,
                     "engine \"%.40s...\": with the options that are tuned it is longer than %d "
                     "characters; run it by a shorter path",
                     space->base.engine->spec, PL_SPEC_SIZE - 1);
}

pl_status pl_tune_space_make(const pl_tune_request *request, pl_tune_space *space, pl_error *error)
{
    table t = {.space = space};
    pl_status status = PL_OK;
    *space = (pl_tune_space){.base = *request->engine, .dt = request->dt};
    fill(&t);
    for (int i = 0; i < request->varied_count && status == PL_OK; ++i) {
        status = take_setting(&t, request->varied[i], PL_VARY_RANGE, error);
    }
    for (int i = 0; i < request->fixed_count && status == PL_OK; ++i) {
        status = take_setting(&t, request->fixed[i], PL_VARY_FIX, error);
    }
    return status == PL_OK ? finish(&t, error) : status;
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
