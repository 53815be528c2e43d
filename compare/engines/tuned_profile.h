/* The profiles that `plumb tune` saved (plumb.profile/1). */
#ifndef PLUMB_TUNED_PROFILE_H
#define PLUMB_TUNED_PROFILE_H

#include "engine_info.h"

/* The environment variable that names tuned profiles' files, separated by ':'. */
#define PL_PROFILES_VARIABLE "PLUMB_PROFILES"

/* A profile of a file. */
typedef struct pl_tuned_profile {
    char base[PL_NAME_SIZE];              /* the engine's own profile */
    double values[PL_ENGINE_MAX_OPTIONS]; /* (option_count) of the options in `given` */
    bool given[PL_ENGINE_MAX_OPTIONS];
} pl_tuned_profile;

/* Looks the profile `name` of an engine up in the files that PLUMB_PROFILES names. PL_BAD_INPUT: a
 * file is no plumb.profile/1, or sets what the engine does not have. PL_IO, PL_NO_MEMORY. */
pl_status pl_tuned_profile_find(const pl_engine_info *engine, const char *name,
                                pl_tuned_profile *profile, bool *found, pl_error *error);

#endif
