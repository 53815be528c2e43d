#include "tuned_profile.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *text_of(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text == NULL ? "" : text;
}

static pl_status read_option(const pl_engine *engine, const char *path, const char *key,
                             const json_t *value, pl_tuned_profile *profile, pl_error *error)
{
    for (int i = 0; i < engine->option_count; ++i) {
        const pl_engine_option *option = &engine->options[i];
        const double number = json_number_value(value);
        if (strcmp(option->name, key) != 0) {
            continue;
        }
        if (!json_is_number(value) || number < option->min || number > option->max ||
            (option->integer && number != floor(number))) {
            return pl_fail(error, PL_BAD_INPUT, "%s: option %s: expected %s of %g to %g", path, key,
                           option->integer ? "a whole number" : "a number", option->min,
                           option->max);
        }
        profile->values[i] = number;
        profile->given[i] = true;
        return PL_OK;
    }
    return pl_fail(error, PL_BAD_INPUT, "%s: engine %s has no option %s", path, engine->name, key);
}

static pl_status read_options(const pl_engine *engine, const char *path, json_t *file,
                              pl_tuned_profile *profile, pl_error *error)
{
    const char *key;
    json_t *value;
    pl_status status = PL_OK;
    *profile = (pl_tuned_profile){.base = ""};
    snprintf(profile->base, sizeof profile->base, "%s", text_of(file, "profile"));
    json_object_foreach(json_object_get(file, "options"), key, value)
    {
        if (status == PL_OK) {
            status = read_option(engine, path, key, value, profile, error);
        }
    }
    return status;
}

static pl_status look_into(const pl_engine *engine, const char *name, const char *path,
                           pl_tuned_profile *profile, bool *found, pl_error *error)
{
    json_error_t why;
    pl_status status = PL_OK;
    json_t *file = json_load_file(path, JSON_REJECT_DUPLICATES, &why);
    if (file == NULL) {
        return json_error_code(&why) == json_error_cannot_open_file
                   ? pl_fail(error, PL_IO, "%s: %s", path, why.text)
                   : pl_fail(error, PL_BAD_INPUT, "%s:%d:%d: %s", path, why.line, why.column,
                             why.text);
    }
    if (strcmp(text_of(file, "schema"), "plumb.profile/1") != 0 ||
        !json_is_object(json_object_get(file, "options"))) {
        status =
            pl_fail(error, PL_BAD_INPUT, "%s: is no plumb.profile/1, as plumb tune saves it", path);
    } else if (strcmp(text_of(file, "engine"), engine->name) == 0 &&
               strcmp(text_of(file, "name"), name) == 0) {
        *found = true;
        status = read_options(engine, path, file, profile, error);
    }
    json_decref(file);
    return status;
}

pl_status pl_tuned_profile_find(const pl_engine *engine, const char *name,
                                pl_tuned_profile *profile, bool *found, pl_error *error)
{
    const char *paths = getenv(PL_PROFILES_VARIABLE);
    char *copy = paths == NULL ? NULL : strdup(paths);
    pl_status status = PL_OK;
    *found = false;
    if (paths != NULL && copy == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for " PL_PROFILES_VARIABLE);
    }
    for (char *rest = copy; rest != NULL && !*found && status == PL_OK;) {
        const char *path = strsep(&rest, ":");
        if (path[0] != '\0') {
            status = look_into(engine, name, path, profile, found, error);
        }
    }
    free(copy);
    return status;
}
