/* The engines this build knows, and those loaded by path. */
#ifndef PLUMB_REGISTRY_H
#define PLUMB_REGISTRY_H

#include "plumb/engine_abi.h"

typedef struct pl_known_engine {
    const char *name;
    const char *package;     /* Debian packages that provide it; "" for our own */
    const pl_engine *engine; /* NULL: absent from this build */
} pl_known_engine;

/* Built-in engines in the order of reports, absent ones too. Static storage. */
const pl_known_engine *pl_known_engines(int *count);

/* An engine chosen with its settings, complete and in range. */
typedef struct pl_engine_choice {
    const pl_engine *engine; /* built in: static; loaded: valid until the process ends */
    int profile;
    double values[PL_ENGINE_MAX_OPTIONS]; /* (engine->option_count) */
    char spec[256];                       /* as the user wrote it */
} pl_engine_choice;

/* Parses `name[:profile][,option=value]...` where name is a built-in engine or the path of a shared
 * object (it has a '/' or ends in ".so"). A name without a profile is the first profile; one that
 * the engine has not itself is looked for in the files that PLUMB_PROFILES names
 * (tuned_profile.h), and stands for the values there.
 * PL_BAD_INPUT: unknown name, profile or option (the nearest one suggested), value out of range, a
 * shared object of another ABI. PL_UNSUPPORTED: an engine that this build lacks, with its Debian
 * package. */
pl_status pl_engine_choose(const char *spec, pl_engine_choice *choice, pl_error *error);

/* The index of the engine's option of that name; -1 when it has none. */
int pl_engine_option_index(const pl_engine *engine, const char *name);

/* "name:profile": how rows of a report name this choice. Options that differ from the profile's
 * default follow as ",option=value". */
void pl_engine_choice_label(const pl_engine_choice *choice, char label[128]);

#endif
