/* Profiles from files: the settings that `plumb tune` saved, under a name of their own. */
#ifndef PLUMB_TUNED_PROFILE_H
#define PLUMB_TUNED_PROFILE_H

#include "plumb/engine_abi.h"

/* The environment variable that names the files, separated by ':'. */
#define PL_PROFILES_VARIABLE "PLUMB_PROFILES"

typedef struct pl_tuned_profile {
    char base[PL_NAME_SIZE];              /* the engine's own profile */
    double values[PL_ENGINE_MAX_OPTIONS]; /* (option_count) of the options in `given` */
    bool given[PL_ENGINE_MAX_OPTIONS];
} pl_tuned_profile;

/* Looks for the profile `name` of the engine in the files that PLUMB_PROFILES names; *found is
 * false when none has it. PL_BAD_INPUT: a file is no plumb.profile/1, or has an option that the
 * engine has not or a value out of its range; PL_IO: one cannot be read. */
pl_status pl_tuned_profile_find(const pl_engine *engine, const char *name,
                                pl_tuned_profile *profile, bool *found, pl_error *error);

#endif
