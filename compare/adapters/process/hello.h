/* The answer to `hello` of the protocol plumb.engine/1: what an engine is, as the table of the engine
 * ABI. */
#ifndef PLUMB_HELLO_H
#define PLUMB_HELLO_H

#include "base/diagnostic.h"
#include "plumb/engine_abi.h"

#include <jansson.h>

/* What a process engine said of itself. Starts as {0}. */
typedef struct pl_hello {
    json_t *answer; /* holds the texts */
    pl_engine_profile profiles[PL_ENGINE_MAX_PROFILES];
    pl_engine_option options[PL_ENGINE_MAX_OPTIONS];
    pl_engine_source sources[PL_ENGINE_MAX_SOURCES];
    bool reads_settings, reads_pairs;
    pl_engine table; /* its data; the functions are not set */
} pl_hello;

/* Reads the answer. False with a diagnostic when a member has the wrong type or names what there is
 * not. Names and ranges are checked like those of any engine, when the table is loaded. */
bool pl_hello_read(const json_t *answer, pl_hello *hello, pl_diagnostic *diagnostic);

/* The values of a profile: overwrites values[option_count], which holds the defaults. */
void pl_hello_profile_values(const pl_hello *hello, int profile, double *values);

/* Releases the answer; texts of the table end with it. */
void pl_hello_free(pl_hello *hello);

#endif
