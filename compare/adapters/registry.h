/* The engines of this build, those loaded by path, and the profiles that `plumb tune` saved. */
#ifndef PLUMB_REGISTRY_H
#define PLUMB_REGISTRY_H

#include "plumb/engine_abi.h"

/* The environment variable that names tuned profiles' files (plumb.profile/1), separated by ':'. */
#define PL_PROFILES_VARIABLE "PLUMB_PROFILES"

/* Our own engine. Static storage, never NULL, as all built-in engines. */
const pl_engine *pl_engine_plumb(void);

/* The adapter of ODE. It is not compiled when ODE is absent from this build. */
const pl_engine *pl_engine_ode(void);

/* The adapter of Bullet. It is not compiled when Bullet is absent from this build. */
const pl_engine *pl_engine_bullet(void);

/* An engine that the registry knows by name. */
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

/* Parses `name[:profile][,option=value]...`, where name is a built-in engine or the path of a
 * shared object (it has a '/' or ends in ".so"). The default profile is the engine's first. A
 * profile that the engine does not have itself is looked up in the files that PLUMB_PROFILES names.
 * PL_BAD_INPUT: an unknown name, profile or option (the nearest one is suggested), a value out of
 * range, a shared object of another ABI, or a file that is no plumb.profile/1. PL_UNSUPPORTED: an
 * engine that this build lacks, with its Debian package. PL_IO: a file cannot be read. */
pl_status pl_engine_choose(const char *spec, pl_engine_choice *choice, pl_error *error);

/* The index of the engine's option of that name; -1 when it has none. */
int pl_engine_option_index(const pl_engine *engine, const char *name);

/* Writes the label of the choice in reports: "name:profile", then ",option=value" for each option
 * that differs from the profile's default. */
void pl_engine_choice_label(const pl_engine_choice *choice, char label[128]);

#endif
