/* The options of the engines known that are worth tuning, each with a sensible range, and how the
 * engine's own API writes it. */
#ifndef PLUMB_TUNE_TUNABLE_H
#define PLUMB_TUNE_TUNABLE_H

#include "adapters/registry.h"

#include <stdio.h>

typedef struct pl_tunable {
    const char *engine, *option;
    unsigned profiles; /* bits 1 << profile that it acts on; 0: none, it is only written */
    double low, high;
    bool logarithmic;
    const char *before, *after; /* the API's text around the value */
} pl_tunable;

/* NULL where the option is not to be tuned by itself. Of an engine that is not in the table,
 * `iterations` is. */
const pl_tunable *pl_tunable_find(const pl_engine *engine, int profile, const char *option);

/* The same profile as it ships. */
pl_status pl_tune_shipped(const pl_engine_choice *choice, pl_engine_choice *shipped,
                          pl_error *error);

/* "name:profile,option=value...": with each option that differs from what the profile ships. */
void pl_tune_spec(const pl_engine_choice *choice, char spec[256]);

/* Prints the settings as a program that uses the engine writes them, a line each, every option that
 * the engine's table has a text for and that differs from what is shipped; then the step, unless dt
 * (s) is NAN. */
void pl_tune_print_api(FILE *out, const pl_engine_choice *choice, double dt);

#endif
