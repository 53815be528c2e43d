/* Draws the settings of a Latin hypercube, dimension by dimension. */
#include "design.h"

#include "base/array.h"
#include "base/hash.h"
#include "base/random.h"
#include "studies/variant/tunable.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An engine whose settings are drawn. */
typedef struct drawn_engine {
    const pl_design_def *def;
    const pl_engine_info *engine;
    int base;                                         /* its first configuration in the plan */
    pl_engine_choice choices[PL_ENGINE_MAX_PROFILES]; /* (choice_count): the profiles */
    int choice_count;
    int *places; /* (settings): the stratum of each setting in the present dimension */
} drawn_engine;

/* Orders the strata of one dimension at random, by a seed that is the engine's and the key's. */
static void draw_places(const drawn_engine *e, const char *key)
{
    const char *name = e->engine->name;
    pl_random random = {.state = pl_hash_text(pl_hash_text(PL_HASH_START, name), key)};
    for (int i = 0; i < e->def->settings; ++i) {
        const int other = (int)(pl_random_unit(&random) * (i + 1));
        e->places[i] = e->places[other];
        e->places[other] = i;
    }
}

/* The middle of a setting's stratum, 0 .. 1. */
static double place_of(const drawn_engine *e, int setting)
{
    return (e->places[setting] + 0.5) / e->def->settings;
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

/* Sets an option of all the engine's settings whose profile is tuned by it. */
static void vary_option(const drawn_engine *e, int option, pl_design_setting *settings)
{
    const pl_engine_option *varied = &e->engine->options[option];
    draw_places(e, varied->name);
    for (int i = 0; i < e->def->settings; ++i) {
        pl_engine_choice *choice = &settings[i].choice;
        pl_tunable tunable;
        if (pl_tunable_find(choice->engine, choice->profile, option, &tunable) &&
            !is_set(choice, option)) {
            choice->values[option] = value_at(varied, &tunable, place_of(e, i));
        }
    }
}

/* Fills settings (def->settings) of one engine. */
static void draw_settings(const drawn_engine *e, pl_design_setting *settings)
{
    draw_places(e, "profile");
    for (int i = 0; i < e->def->settings; ++i) {
        const int profile = (int)(place_of(e, i) * e->choice_count);
        settings[i] = (pl_design_setting){.base = e->base, .choice = e->choices[profile]};
    }
    draw_places(e, "dt");
    for (int i = 0; i < e->def->settings; ++i) {
        settings[i].dt = e->def->steps[(int)(place_of(e, i) * e->def->step_count)];
    }
    for (int i = 0; i < e->engine->option_count; ++i) {
        vary_option(e, i, settings);
    }
}

/* The engine that configuration number `index` begins, with the profiles to draw from. False where
 * it was begun before, or cannot be asked. */
static bool begin_engine(drawn_engine *e, int index)
{
    const pl_plan *plan = e->def->plan;
    const pl_engine_choice *first = &plan->configurations[index].choice;
    const bool is_labelled = first->label[0] != '\0';
    e->engine = first->engine;
    e->base = index;
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

pl_status pl_design_make(const pl_design_def *def, pl_design *design, pl_error *error)
{
    const size_t most = (size_t)def->plan->configuration_count * (size_t)def->settings;
    drawn_engine e = {.def = def, .places = calloc((size_t)def->settings + 1, sizeof *e.places)};
    pl_design_setting *drawn = calloc(most + 1, sizeof *drawn);
    int engines = 0;
    *design = (pl_design){.items = calloc(most + 1, sizeof *design->items)};
    const bool made = e.places != NULL && drawn != NULL && design->items != NULL;
    for (int i = 0; i < def->plan->configuration_count && made; ++i) {
        if (begin_engine(&e, i)) {
            draw_settings(&e, drawn + (size_t)engines++ * (size_t)def->settings);
        }
    }
    for (int i = 0; i < def->settings && made; ++i) {
        for (int k = 0; k < engines; ++k) {
            design->items[design->count++] = drawn[(size_t)k * (size_t)def->settings + (size_t)i];
        }
    }
    free(e.places);
    free(drawn);
    return made ? PL_OK : pl_fail(error, PL_NO_MEMORY, "out of memory for %zu settings", most);
}

void pl_design_free(pl_design *design)
{
    free(design->items);
    *design = (pl_design){.count = 0};
}
