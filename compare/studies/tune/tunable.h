/* The options of known engines that are worth tuning, each with a sensible range and the call that
 * sets it in the engine's own API. */
#ifndef PLUMB_TUNE_TUNABLE_H
#define PLUMB_TUNE_TUNABLE_H

#include "adapters/registry.h"

#include <stdio.h>

/* An option that is worth tuning. The strings are static. */
typedef struct pl_tunable {
    const char *engine, *option;
    unsigned profiles; /* bits 1 << profile that it acts on; 0: none, it is only printed */
    double low, high;
    bool logarithmic;
    const char *before, *after; /* the API's text around the value */
} pl_tunable;

/* The entry of an option; NULL where it is not tuned unless asked for. For an engine that is not in
 * the table, only `iterations` is tuned. */
const pl_tunable *pl_tunable_find(const pl_engine *engine, int profile, const char *option);

/* The same profile with default settings. */
pl_status pl_tune_defaults(const pl_engine_choice *choice, pl_engine_choice *defaults,
                           pl_error *error);

/* "name:profile,option=value...", with each option that differs from the profile's default. */
void pl_tune_spec(const pl_engine_choice *choice, char spec[256]);

/* Prints the settings as a program that uses the engine writes them: a line for every option that
 * differs from its default and has an entry in the table; then the step, unless dt (s) is NAN. */
void pl_tune_print_api(FILE *out, const pl_engine_choice *choice, double dt);

#endif
