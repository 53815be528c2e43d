#include "tunable.h"

#include "base/heap.h"
#include "base/json_field.h"
#include "base/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool names_any(const pl_engine_info *engine)
{
    for (int i = 0; i < engine->option_count; ++i) {
        if (engine->options[i].tune_profiles != 0) {
            return true;
        }
    }
    return false;
}

bool pl_tunable_find(const pl_engine_info *engine, int profile, int option, pl_tunable *tunable)
{
    const pl_engine_option *o = &engine->options[option];
    if (profile < 32 && (o->tune_profiles >> profile & 1u) != 0) {
        *tunable = (pl_tunable){o->tune_min, o->tune_max, o->tune_logarithmic};
        return true;
    }
    *tunable = (pl_tunable){1, 300, true};
    return strcmp(o->name, "iterations") == 0 && !names_any(engine);
}

pl_engine_choice pl_tune_defaults(const pl_engine_choice *choice)
{
    const pl_engine_info *engine = choice->engine;
    pl_engine_choice defaults = {.engine = engine, .profile = choice->profile};
    memcpy(defaults.values, pl_engine_profile_values(engine, choice->profile),
           (size_t)engine->option_count * sizeof *defaults.values);
    snprintf(defaults.spec, sizeof defaults.spec, "%s:%s", engine->spec,
             engine->profiles[choice->profile].name);
    return defaults;
}

void pl_tune_spec(const pl_engine_choice *choice, char spec[PL_SPEC_SIZE])
{
    const pl_engine_choice defaults = pl_tune_defaults(choice);
    const pl_engine_info *engine = choice->engine;
    int used = snprintf(spec, PL_SPEC_SIZE, "%s", defaults.spec);
    for (int i = 0; i < engine->option_count && used < PL_SPEC_SIZE; ++i) {
        if (choice->values[i] != defaults.values[i]) {
            used += snprintf(spec + used, PL_SPEC_SIZE - (size_t)used, ",%s=%.15g",
                             engine->options[i].name, choice->values[i]);
        }
    }
}

bool pl_tune_spec_fits(const pl_engine_choice *choice, const bool *varied)
{
    static const char longest[] = ",=-1.23456789012345e-308";
    const pl_engine_info *engine = choice->engine;
    const double *defaults = pl_engine_profile_values(engine, choice->profile);
    size_t size = strlen(engine->spec) + 1 + strlen(engine->profiles[choice->profile].name) + 1;
    for (int i = 0; i < engine->option_count; ++i) {
        if (varied[i] || choice->values[i] != defaults[i]) {
            size += strlen(engine->options[i].name) + strlen(longest);
        }
    }
    return size <= PL_SPEC_SIZE;
}

/* Adds `code` with `value` in place of {}. */
static void add_code(json_t *lines, const char *code, const char *value)
{
    const char *place = strstr(code, "{}");
    char *line = place == NULL
                     ? pl_heap_copy(code)
                     : pl_heap_format("%.*s%s%s", (int)(place - code), code, value, place + 2);
    json_array_append_new(lines, pl_json_text(line));
    free(line);
}

static void add_step(json_t *lines, const char *code, double dt)
{
    char text[48];
    const double rate = 1 / dt;
    const bool whole = fabs(rate - nearbyint(rate)) < 1e-9 * rate;
    snprintf(text, sizeof text, whole ? "1.0 / %.0f" : "%.9g", whole ? nearbyint(rate) : dt);
    add_code(lines, code, text);
}

json_t *pl_tune_api(const pl_engine_choice *choice, double dt)
{
    const pl_engine_info *engine = choice->engine;
    const double *defaults = pl_engine_profile_values(engine, choice->profile);
    const char *step_code = engine->profiles[choice->profile].step_code;
    json_t *lines = json_array();
    for (int i = 0; i < engine->option_count; ++i) {
        if (engine->options[i].code != NULL && choice->values[i] != defaults[i]) {
            char value[32];
            snprintf(value, sizeof value, "%.15g", choice->values[i]);
            add_code(lines, engine->options[i].code, value);
        }
    }
    if (step_code != NULL) {
        add_step(lines, step_code, dt);
    }
    return lines;
}

double pl_design_place(uint64_t seed, int point)
{
    enum { BITS = 31 };
    double place = 0x1p-32;
    for (int bit = BITS - 1; bit >= 0; --bit) {
        /* Whether a digit is flipped depends on those above it, and on how many they are. */
        const uint64_t above = UINT64_C(1) << (BITS - 1 - bit) | (uint64_t)point >> (bit + 1);
        pl_random random = {.state = seed ^ above};
        const int flip = (int)(pl_random_bits(&random) >> 63);
        place += ldexp((point >> bit & 1) ^ flip, -(bit + 1));
    }
    return place;
}
