#include "registry.h"

#include "base/heap.h"
#include "base/json_field.h"
#include "base/program_name.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The profiles that come with Plumb, an array, which compare/CMakeLists.txt builds into the program.
 */
extern const char pl_tuned_profiles_json[];

/* The profile of that name in a list; NULL: none. Borrowed. */
static json_t *find_profile(const json_t *list, const char *name)
{
    size_t index;
    json_t *file;
    json_array_foreach(list, index, file)
    {
        if (strcmp(pl_json_get_text(file, "name"), name) == 0) {
            return file;
        }
    }
    return NULL;
}

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

/* Adds a profile to the list where it is the engine's and its name is new. Takes `file`. */
static pl_status add_profile(const pl_engine_info *engine, const char *from, json_t *file,
                             json_t *list, pl_error *error)
{
    const char *name = pl_json_get_text(file, "name");
    pl_status status = PL_OK;
    if (strcmp(pl_json_get_text(file, "schema"), "plumb.profile/1") != 0 ||
        !json_is_object(json_object_get(file, "options"))) {
        status =
            pl_fail(error, PL_BAD_INPUT, "%s: is no plumb.profile/1, as plumb tune saves it", from);
    } else if (strcmp(pl_json_get_text(file, "engine"), engine->name) == 0 &&
               find_profile(list, name) == NULL) {
        json_object_set_new(file, "from", json_string(from));
        json_array_append(list, file);
    }
    json_decref(file);
    return status;
}

static pl_status add_file(const pl_engine_info *engine, const char *path, json_t *list,
                          pl_error *error)
{
    json_error_t why;
    json_t *file = json_load_file(path, JSON_REJECT_DUPLICATES, &why);
    if (file == NULL) {
        return json_error_code(&why) == json_error_cannot_open_file
                   ? pl_fail(error, PL_IO, "%s: %s", path, why.text)
                   : pl_fail(error, PL_BAD_INPUT, "%s:%d:%d: %s", path, why.line, why.column,
                             why.text);
    }
    return add_profile(engine, path, file, list, error);
}

static pl_status add_files(const pl_engine_info *engine, json_t *list, pl_error *error)
{
    const char *paths = getenv(PL_PROFILES_VARIABLE);
    char *copy = pl_heap_copy(paths == NULL ? "" : paths);
    pl_status status = PL_OK;
    for (char *rest = copy; rest != NULL && status == PL_OK;) {
        const char *path = strsep(&rest, ":");
        if (path[0] != '\0') {
            status = add_file(engine, path, list, error);
        }
    }
    free(copy);
    return status;
}

static pl_status add_own(const pl_engine_info *engine, json_t *list, pl_error *error)
{
    size_t index;
    json_t *file;
    json_t *own = json_loads(pl_tuned_profiles_json, JSON_REJECT_DUPLICATES, NULL);
    pl_status status = PL_OK;
    json_array_foreach(own, index, file)
    {
        if (status == PL_OK) {
            status = add_profile(engine, PL_PROGRAM, json_incref(file), list, error);
        }
    }
    json_decref(own);
    return status;
}

pl_status pl_tuned_profiles(const pl_engine_info *engine, json_t **list, pl_error *error)
{
    *list = json_array();
    pl_status status = add_files(engine, *list, error);
    if (status == PL_OK && engine->built_in != NULL) {
        status = add_own(engine, *list, error);
    }
    if (status != PL_OK) {
        json_decref(*list);
        *list = NULL;
    }
    return status;
}

pl_status pl_tuned_profile_find(const pl_engine_info *engine, const char *name,
                                pl_tuned_profile *profile, bool *found, pl_error *error)
{
    json_t *list = NULL;
    pl_status status = pl_tuned_profiles(engine, &list, error);
    json_t *file = find_profile(list, name);
    *found = file != NULL;
    if (status == PL_OK && *found) {
        status = read_options(engine, pl_json_get_text(file, "from"), file, profile, error);
    }
    json_decref(list);
    return status;
}
