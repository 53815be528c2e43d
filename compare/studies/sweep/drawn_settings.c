#include "drawn_settings.h"

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

/* Whether the user gave the option another value than the profile's. */
static bool is_set(const pl_engine_choice *choice, int option)
{
    const double *defaults = pl_engine_profile_values(choice->engine, choice->profile);
    return choice->values[option] != defaults[option];
}

/* Draws the options that the setting's profile is tuned by. */
static void draw_options(const drawn_engine *e, int number, pl_engine_choice *choice)
{
    for (int i = 0; i < e->engine->option_count; ++i) {
        const pl_engine_option *option = &e->engine->options[i];
        pl_tunable tunable;
        if (pl_tunable_find(choice->engine, choice->profile, i, &tunable) && !is_set(choice, i)) {
            choice->values[i] = value_at(option, &tunable, place_of(e, option->name, number));
        }
    }
}

static pl_setting draw_setting(const drawn_engine *e, int number)
{
    const int profile = (int)(place_of(e, "profile", number) * e->choice_count);
    const int step = (int)(place_of(e, "dt", number) * e->def->step_count);
    pl_setting setting = {e->choices[profile], e->def->steps[step]};
    draw_options(e, number, &setting.choice);
    return setting;
}

/* The engine that configuration number `index` begins, with the profiles to draw from. False where
 * it was begun before, or cannot be asked. */
static bool begin_engine(drawn_engine *e, int index)
{
    const pl_plan *plan = e->def->plan;
    const pl_engine_choice *first = &plan->configurations[index].choice;
    const bool is_labelled = first->label[0] != '\0';
    e->engine = first->engine;
    e->choice_count = 0;
    if (first->engine->fault.is_fault) {
        return false;
    }
    for (int i = 0; i < plan->configuration_count && !is_labelled; ++i) {
        const pl_engine_choice *choice = &plan->configurations[i].choice;
        if (choice->engine != first->engine || choice->label[0] != '\0') {
            continue;
        }
        if (i < index) {
            return false;
        }
        if (e->choice_count < PL_ENGINE_MAX_PROFILES && !e->def->all_profiles) {
            e->choices[e->choice_count++] = *choice;
        }
    }
    for (int i = 0; i < first->engine->profile_count && !is_labelled && e->def->all_profiles; ++i) {
        const pl_engine_choice of_profile = {.engine = first->engine, .profile = i};
        e->choices[e->choice_count++] = pl_tune_defaults(&of_profile);
    }
    if (is_labelled) {
        e->choices[e->choice_count++] = *first;
    }
    return e->choice_count > 0;
}

pl_drawn_settings pl_draw_settings(const pl_draw_def *def)
{
    const int most = def->plan->configuration_count;
    drawn_engine *engines = pl_heap_new((size_t)most + 1, sizeof *engines);
    pl_drawn_settings drawn = {.count = 0};
    int count = 0;
    for (int i = 0; i < most; ++i) {
        engines[count].def = def;
        count += begin_engine(&engines[count], i);
    }
    for (int i = 0; i < def->settings; ++i) {
        for (int k = 0; k < count; ++k) {
            const pl_setting setting = draw_setting(&engines[k], i);
            pl_push(&drawn.items, &drawn.count, &setting, sizeof setting);
        }
    }
    free(engines);
    return drawn;
}

const pl_configuration *pl_drawn_from(const pl_plan *plan, const pl_setting *setting)
{
    const pl_configuration *from = plan->configurations;
    while (from->choice.engine != setting->choice.engine ||
           strcmp(from->choice.label, setting->choice.label) != 0) {
        ++from;
    }
    return from;
}

void pl_drawn_settings_free(pl_drawn_settings *drawn)
{
    free(drawn->items);
    *drawn = (pl_drawn_settings){.count = 0};
}
