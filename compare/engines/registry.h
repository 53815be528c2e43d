/* An engine chosen by a SPEC: a built-in engine or a shared object, its profile and its options. */
#ifndef PLUMB_REGISTRY_H
#define PLUMB_REGISTRY_H

#include "engine_info.h"

#include <jansson.h>

/* Size of a label, with its terminating zero. */
enum { PL_LABEL_SIZE = 384 };

/* An engine chosen with its settings, complete and in range. */
typedef struct pl_engine_choice {
    const pl_engine_info *engine; /* valid until the program ends */
    int profile;
    double values[PL_ENGINE_MAX_OPTIONS]; /* (engine->option_count) */
    char spec[PL_SPEC_SIZE];              /* as the user wrote it */
    char label[PL_LABEL_SIZE];            /* label=; "": none was given */
} pl_engine_choice;

/* Describes a built-in engine. PL_UNSUPPORTED when it is absent, with how to get it; and as
 * pl_engine_describe. */
pl_status pl_engine_of_build(const pl_built_in *built_in, const pl_engine_info **info,
                             pl_error *error);

/* Parses `name[:profile][,option=value]...[,label=TEXT]`, where name is a built-in engine, the path
 * of a shared object (it has a '/' or ends in ".so"), or "exec:" and the command of a program that
 * speaks plumb.engine/1. That command ends where the rest is a profile and options with numbers; one
 * that itself ends so is followed by its profile. The default profile is the engine's first. A profile that the engine does not have itself is looked up in the files that
 * PLUMB_PROFILES names and in those that come with Plumb. An engine with a fault
 * (pl_engine_info.fault) is chosen too; its profile and
 * options are then not checked. PL_BAD_INPUT: an unknown name, profile or option (the nearest one
 * is suggested), a value out of range, a shared object of another ABI, or a file that is no
 * plumb.profile/1. PL_UNSUPPORTED: an engine that is absent, with how to get it. PL_IO:
 * a file cannot be read. */
pl_status pl_engine_choose(const char *spec, pl_engine_choice *choice, pl_error *error);

/* Writes the label of the choice in reports: the given one, or "name:profile", then ",option=value"
 * for each option that differs from the profile's default. */
void pl_engine_choice_label(const pl_engine_choice *choice, char label[PL_LABEL_SIZE]);

/* Writes the label of a choice that was made from `asked` by changing its profile and options: a
 * given label, then ":profile" and ",option=value" for what was changed. */
void pl_engine_choice_varied_label(const pl_engine_choice *asked, const pl_engine_choice *varied,
                                   char label[PL_LABEL_SIZE]);

/* ---- Tuned profiles (tuned_profile.c): what `plumb tune` saved (plumb.profile/1), in the user's files, and those that
 * come with Plumb (tuned_profiles.json) ---- */

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
