#include "grid.h"

#include "base/hash.h"
#include "base/heap.h"
#include "studies/tunable.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An engine whose settings are drawn. */
typedef struct drawn_engine {
    const pl_draw_def *def;
    const pl_engine_info *engine;
    pl_engine_choice choices[PL_ENGINE_MAX_PROFILES]; /* (choice_count): the profiles */
    int choice_count;
} drawn_engine;

/* The place of a setting along the dimension of a key, 0 .. 1: each key of each engine has an order of its own. */
static double place_of(const drawn_engine *e, const char *key, int setting)
{
    return pl_design_place(pl_hash_text(pl_hash_text(PL_HASH_START, e->engine->name), key),
                           setting);
}

/* The value of an option at a place of its range, 0 .. 1. */
static double value_at(const pl_engine_option *option, const pl_tunable *tunable, double place)
{
    const double low = fmax(tunable->low, option->min), high = fmin(tunable->high, option->max);
    const double end = option->integer ? high + 1 : high; /* whole numbers have equal shares */
    const bool by_ratio = tunable->logarithmic && low > 0;
    const double value = by_ratio ? low * pow(end / low, place) : low + (end - low) * place;
    char text[32];
    snprintf(text, sizeof text, "%.3g", option->integer ? floor(value) : value);
    return fmin(fmax(strtod(text, NULL), low), high);
}

/* Draws the profile, the step, and the options that the profile is tuned by, unless the user gave them another value. */
static pl_setting draw_setting(const drawn_engine *e, int number)
{
    const int profile = (int)(place_of(e, "profile", number) * e->choice_count);
    const int step = (int)(place_of(e, "dt", number) * e->def->step_count);
    pl_setting setting = {e->choices[profile], e->def->steps[step]};
    pl_engine_choice *choice = &setting.choice;
    const double *defaults = pl_engine_profile_values(e->engine, choice->profile);
    for (int i = 0; i < e->engine->option_count; ++i) {
        const pl_engine_option *option = &e->engine->options[i];
        pl_tunable tunable;
        if (pl_tunable_find(e->engine, choice->profile, i, &tunable) &&
            choice->values[i] == defaults[i]) {
            choice->values[i] = value_at(option, &tunable, place_of(e, option->name, number));
        }
    }
    return setting;
}

/* A configuration with a label is an engine for itself. */
static bool is_alike(const pl_engine_choice *a, const pl_engine_choice *b)
{
    return a->engine == b->engine && strcmp(a->label, b->label) == 0;
}

const pl_configuration *pl_drawn_from(const pl_plan *plan, const pl_setting *setting)
{
    const pl_configuration *from = plan->configurations;
    while (!is_alike(&from->choice, &setting->choice)) {
        ++from;
    }
    return from;
}

/* The engine that configuration number `index` begins, with the profiles to draw from; without any where it was begun
 * before, or cannot be asked. */
static drawn_engine begin_engine(const pl_draw_def *def, int index)
{
    const pl_plan *plan = def->plan;
    const pl_engine_choice *first = &plan->configurations[index].choice;
    const bool all_profiles = def->all_profiles && first->label[0] == '\0';
    drawn_engine e = {.def = def, .engine = first->engine};
    const int most = all_profiles ? e.engine->profile_count : plan->configuration_count;
    if (pl_drawn_from(plan, &(pl_setting){.choice = *first}) != &plan->configurations[index] ||
        e.engine->fault.is_fault) {
        return e;
    }
    for (int i = 0; i < most && e.choice_count < PL_ENGINE_MAX_PROFILES; ++i) {
        const pl_engine_choice of_profile = {.engine = e.engine, .profile = i};
        if (all_profiles) {
            e.choices[e.choice_count++] = pl_tune_defaults(&of_profile);
        } else if (is_alike(&plan->configurations[i].choice, first)) {
            e.choices[e.choice_count++] = plan->configurations[i].choice;
        }
    }
    return e;
}

pl_setting *pl_draw_settings(const pl_draw_def *def, int *count)
{
    pl_setting *drawn = NULL;
    drawn_engine *engines = NULL;
    int engine_count = 0;
    *count = 0;
    for (int i = 0; i < def->plan->configuration_count; ++i) {
        const drawn_engine e = begin_engine(def, i);
        if (e.choice_count > 0) {
            pl_push(&engines, &engine_count, &e, sizeof e);
        }
    }
    for (int i = 0; i < def->settings * engine_count; ++i) {
        const pl_setting setting = draw_setting(&engines[i % engine_count], i / engine_count);
        pl_push(&drawn, count, &setting, sizeof setting);
    }
    free(engines);
    return drawn;
}
