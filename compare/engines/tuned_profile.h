/* The profiles that `plumb tune` saved (plumb.profile/1): those of the user's files, and those that
 * come with Plumb (tuned_profiles.json). */
#ifndef PLUMB_TUNED_PROFILE_H
#define PLUMB_TUNED_PROFILE_H

#include "engine_info.h"

#include <jansson.h>

/* The environment variable that names tuned profiles' files, separated by ':'. */
#define PL_PROFILES_VARIABLE "PLUMB_PROFILES"

/* A profile of a file. */
typedef struct pl_tuned_profile {
    char base[PL_NAME_SIZE];              /* the engine's own profile */
    double values[PL_ENGINE_MAX_OPTIONS]; /* (option_count) of the options in `given` */
    bool given[PL_ENGINE_MAX_OPTIONS];
} pl_tuned_profile;

/* The tuned profiles of an engine as a JSON array, which the caller releases: the objects of the
 * files that PLUMB_PROFILES names, in their order, and then those that come with Plumb for its
 * built-in engines. Each has the key "from": the path of its file, or "plumb". Of several of one
 * name only the first is listed. PL_BAD_INPUT: a file is no plumb.profile/1. PL_IO. */
pl_status pl_tuned_profiles(const pl_engine_info *engine, json_t **list, pl_error *error);

/* Looks the profile `name` up in pl_tuned_profiles. PL_BAD_INPUT also: the file sets what the engine
 * does not have. */
pl_status pl_tuned_profile_find(const pl_engine_info *engine, const char *name,
                                pl_tuned_profile *profile, bool *found, pl_error *error);

#endif
