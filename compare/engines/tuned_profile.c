#include "tuned_profile.h"

#include "base/json_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Whether a value is in the range of its option. */
static bool is_allowed(const pl_engine_option *option, double value)
{
    return value >= option->min && value <= option->max &&
           (!option->integer || value == floor(value));
}

static pl_status read_options(const pl_engine_info *engine, const char *path, json_t *file,
                              pl_tuned_profile *profile, pl_error *error)
{
    const char *key;
    json_t *value;
    *profile = (pl_tuned_profile){.base = ""};
    snprintf(profile->base, sizeof profile->base, "%s", pl_json_get_text(file, "profile"));
    json_object_foreach(json_object_get(file, "options"), key, value)
    {
        const int index = pl_engine_option_index(engine, key);
        if (index < 0) {
            return pl_fail(error, PL_BAD_INPUT, "%s: engine %s has no option %s", path,
                           engine->name, key);
        }
        const pl_engine_option *option = &engine->options[index];
        if (!json_is_number(value) || !is_allowed(option, json_number_value(value))) {
            return pl_fail(error, PL_BAD_INPUT, "%s: option %s: expected %s of %g to %g", path, key,
                           option->integer ? "a whole number" : "a number", option->min,
                           option->max);
        }
        profile->values[index] = json_number_value(value);
        profile->given[index] = true;
    }
    return PL_OK;
}

static pl_status read_profile(const pl_engine_info *engine, const char *name, const char *path,
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
    if (strcmp(pl_json_get_text(file, "schema"), "plumb.profile/1") != 0 ||
        !json_is_object(json_object_get(file, "options"))) {
        status =
            pl_fail(error, PL_BAD_INPUT, "%s: is no plumb.profile/1, as plumb tune saves it", path);
    } else if (strcmp(pl_json_get_text(file, "engine"), engine->name) == 0 &&
               strcmp(pl_json_get_text(file, "name"), name) == 0) {
        *found = true;
        status = read_options(engine, path, file, profile, error);
    }
    json_decref(file);
    return status;
}

pl_status pl_tuned_profile_find(const pl_engine_info *engine, const char *name,
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
            status = read_profile(engine, name, path, profile, found, error);
        }
    }
    free(copy);
    return status;
}
