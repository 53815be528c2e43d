#include "tunable.h"

#include <math.h>
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

/* Prints `code` with `value` in place of {}. */
static void print_code(FILE *out, const char *code, const char *value)
{
    const char *place = strstr(code, "{}");
    if (place == NULL) {
        fprintf(out, "    %s\n", code);
    } else {
        fprintf(out, "    %.*s%s%s\n", (int)(place - code), code, value, place + 2);
    }
}

static void print_step(FILE *out, const char *code, double dt)
{
    char text[48];
    const double rate = 1 / dt;
    const bool whole = fabs(rate - nearbyint(rate)) < 1e-9 * rate;
    snprintf(text, sizeof text, whole ? "1.0 / %.0f" : "%.9g", whole ? nearbyint(rate) : dt);
    print_code(out, code, text);
}

static bool is_printed(const pl_engine_choice *choice, int option)
{
    const double *defaults = pl_engine_profile_values(choice->engine, choice->profile);
    return choice->engine->options[option].code != NULL &&
           choice->values[option] != defaults[option];
}

bool pl_tune_has_api(const pl_engine_choice *choice, double dt)
{
    bool any = !isnan(dt) && choice->engine->profiles[choice->profile].step_code != NULL;
    for (int i = 0; i < choice->engine->option_count; ++i) {
        any = any || is_printed(choice, i);
    }
    return any;
}

void pl_tune_print_api(FILE *out, const pl_engine_choice *choice, double dt)
{
    const pl_engine_info *engine = choice->engine;
    for (int i = 0; i < engine->option_count; ++i) {
        if (is_printed(choice, i)) {
            char value[32];
            snprintf(value, sizeof value, "%.15g", choice->values[i]);
            print_code(out, engine->options[i].code, value);
        }
    }
    const char *step_code = engine->profiles[choice->profile].step_code;
    if (!isnan(dt) && step_code != NULL) {
        print_step(out, step_code, dt);
    }
}
