#include "grid_configurations.h"

#include "grid_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

double pl_grid_contender_count(const pl_grid_def *def)
{
    double count = 0;
    for (int i = 0; i < def->base->configuration_count; ++i) {
        pl_grid_keys keys = pl_grid_keys_of_contender(def, &def->base->configurations[i]);
        count += pl_grid_combinations(&keys);
    }
    return count;
}

/* Changes the profile: options that were not asked for by name become those it ships. */
static void set_profile(pl_engine_choice *choice, int profile)
{
    const pl_engine *engine = choice->engine;
    double shipped[PL_ENGINE_MAX_OPTIONS];
    for (int i = 0; i < engine->option_count; ++i) {
        shipped[i] = engine->options[i].value;
    }
    if (engine->profile_defaults != NULL) {
        engine->profile_defaults(profile, shipped);
    }
    for (int i = 0; i < engine->option_count; ++i) {
        char asked[PL_NAME_SIZE + 3];
        snprintf(asked, sizeof asked, ",%s=", engine->options[i].name);
        if (strstr(choice->spec, asked) == NULL) {
            choice->values[i] = shipped[i];
        }
    }
    choice->profile = profile;
}

/* The profile that is number `place` among those named that the engine has. */
static int named_profile(const pl_engine *engine, const pl_vary *vary, int place)
{
    for (int i = 0; i < vary->count; ++i) {
        const int profile = pl_grid_profile(engine, vary->names[i]);
        if (profile >= 0 && place-- == 0) {
            return profile;
        }
    }
    return 0;
}

static pl_status set_option(pl_engine_choice *choice, const char *name, double value,
                            pl_error *error)
{
    const pl_engine *engine = choice->engine;
    const int index = pl_grid_option(engine, name);
    const pl_engine_option *option = &engine->options[index];
    if (!(value >= option->min && value <= option->max)) {
        return pl_fail(error, PL_BAD_INPUT, "--vary %s: %s takes %g to %g, found %.17g", name,
                       engine->name, option->min, option->max, value);
    }
    if (option->integer && value != floor(value)) {
        return pl_fail(error, PL_BAD_INPUT, "--vary %s: %s takes an integer, found %.17g", name,
                       engine->name, value);
    }
    choice->values[index] = value;
    return PL_OK;
}

static pl_status vary_choice(const pl_grid_def *def, const pl_grid_keys *keys, long combination,
                             pl_engine_choice *choice, pl_error *error)
{
    pl_status status = PL_OK;
    for (int k = 0; k < keys->count; ++k) {
        const pl_vary *vary = &def->varied[keys->items[k]];
        if (vary->names != NULL) {
            const int place = pl_grid_digit(keys, combination, k);
            set_profile(choice, named_profile(choice->engine, vary, place));
        }
    }
    for (int k = 0; k < keys->count && status == PL_OK; ++k) {
        const pl_vary *vary = &def->varied[keys->items[k]];
        if (vary->names == NULL) {
            status = set_option(choice, vary->key,
                                vary->numbers[pl_grid_digit(keys, combination, k)], error);
        }
    }
    return status;
}

static bool are_equal(const pl_engine_choice *a, const pl_engine_choice *b)
{
    return a->engine == b->engine && a->profile == b->profile &&
           memcmp(a->values, b->values, (size_t)a->engine->option_count * sizeof *a->values) == 0;
}

/* Adds the engine unless it is there. `labels` maps labels to the plan's indices. */
static pl_status add(const pl_engine_choice *choice, json_t *labels, pl_plan *plan, pl_error *error)
{
    char label[sizeof plan->configurations->label];
    int index = 0;
    pl_engine_choice_label(choice, label);
    const json_t *known = json_object_get(labels, label);
    if (known != NULL) {
        const pl_engine_choice *other = &plan->configurations[json_integer_value(known)].choice;
        return are_equal(choice, other)
                   ? PL_OK
                   : pl_fail(error, PL_BAD_INPUT,
                             "two engines would both be called %s: vary fewer options, or give "
                             "shared objects names of their own",
                             label);
    }
    pl_status status = pl_plan_add_choice(plan, choice, label, &index, error);
    if (status == PL_OK && json_object_set_new_nocheck(labels, label, json_integer(index)) != 0) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for %s", label);
    }
    return status;
}

pl_status pl_grid_add_contenders(const pl_grid_def *def, pl_plan *plan, pl_error *error)
{
    json_t *labels = json_object();
    pl_status status = labels == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory") : PL_OK;
    bool more = true;
    for (long number = 0; more && status == PL_OK; ++number) {
        more = false;
        for (int i = 0; i < def->base->configuration_count && status == PL_OK; ++i) {
            const pl_configuration *asked = &def->base->configurations[i];
            pl_grid_keys keys = pl_grid_keys_of_contender(def, asked);
            if ((double)number < pl_grid_combinations(&keys)) {
                pl_engine_choice choice = asked->choice;
                more = true;
                status = vary_choice(def, &keys, number, &choice, error);
                if (status == PL_OK) {
                    status = add(&choice, labels, plan, error);
                }
            }
        }
    }
    json_decref(labels);
    return status;
}
