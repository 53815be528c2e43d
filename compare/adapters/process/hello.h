/* The answer to `hello` of the protocol plumb.engine/1, which says what an engine is. A process engine
 * gives it, and so does the process that describes an engine of any kind (engines/engine_info.c). */
#ifndef PLUMB_HELLO_H
#define PLUMB_HELLO_H

#include "base/diagnostic.h"
#include "plumb/engine_abi.h"

#include <jansson.h>

/* What an engine said of itself. Starts as {0}. */
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

/* The answer of an engine, of whose profiles defaults[profile_count x option_count] are the values: a new
 * reference. NULL when out of memory. */
json_t *pl_hello_write(const pl_engine *engine, const double *defaults);

/* The word of an answer for a precision. */
const char *pl_hello_precision(pl_precision precision);

/* The word of an answer for an integrator. */
const char *pl_hello_integrator(pl_integrator integrator);

/* The words of an answer for PL_CONTACTS_* bits, a new array. */
json_t *pl_hello_contacts(uint32_t reported);

/* The member `tune` of an option, a new reference: the range in which plumb tune varies it, and in which
 * of profiles[count]; NULL: in none. */
json_t *pl_hello_tune(const pl_engine_option *option, const pl_engine_profile *profiles, int count);

/* Releases the answer; texts of the table end with it. */
void pl_hello_free(pl_hello *hello);

#endif
