/* The table of built-in engines, the parsing of SPEC, and the loading of shared objects.
 *
 * SPEC = name[:profile][,option=value]...  A loaded object stays loaded until the process ends,
 * because its descriptor is its own memory. */
#include "registry.h"

#include <dlfcn.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_KNOWN = 8, MOST_PROFILES = 64 };

const pl_known_engine *pl_known_engines(int *count)
{
    /* The addresses of engines come from calls, so the table is filled, each time with the same. */
    static pl_known_engine known[] = {
        {.name = "plumb", .package = ""},
        {.name = "ode", .package = "libode-dev"},
        {.name = "bullet", .package = "libbullet-dev libbullet-extras-dev"},
    };
    known[0].engine = pl_engine_plumb();
#ifdef PLUMB_HAVE_ODE
    known[1].engine = pl_engine_ode();
#endif
#ifdef PLUMB_HAVE_BULLET
    known[2].engine = pl_engine_bullet();
#endif
    *count = (int)(sizeof known / sizeof *known);
    return known;
}

/* Length of the name at the head of a spec. A path may hold ':' and ',' up to its ".so". */
static size_t name_length(const char *spec)
{
    for (const char *at = strstr(spec, ".so"); at != NULL; at = strstr(at + 1, ".so")) {
        if (at[3] == '\0' || at[3] == ':' || at[3] == ',') {
            return (size_t)(at - spec) + 3;
        }
    }
    return strcspn(spec, ":,");
}

static bool is_path(const char *name)
{
    size_t length = strlen(name);
    return strchr(name, '/') != NULL || (length > 3 && strcmp(name + length - 3, ".so") == 0);
}

/* Fails with "WHAT "word"" and either the nearest of `names` or all of them. */
static pl_status fail_unknown(pl_error *error, const char *what, const char *word,
                              const char *const *names, int count)
{
    const char *nearest = pl_nearest_name(word, names, count);
    if (nearest != NULL) {
        return pl_fail(error, PL_BAD_INPUT, "unknown %s \"%s\"; did you mean \"%s\"?", what, word,
                       nearest);
    }
    char all[256] = "";
    size_t used = 0;
    for (int i = 0; i < count && used < sizeof all; ++i) {
        used +=
            (size_t)snprintf(all + used, sizeof all - used, "%s%s", i > 0 ? ", " : "", names[i]);
    }
    return pl_fail(error, PL_BAD_INPUT, "unknown %s \"%s\"; there is: %s", what, word,
                   count > 0 ? all : "none");
}

static pl_status check_loaded(const char *path, const pl_engine *engine, pl_error *error)
{
    if (engine == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s: " PL_ENGINE_SYMBOL "() returned no engine", path);
    }
    if (engine->abi_version != PL_ENGINE_ABI_VERSION) {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s: is built for engine ABI %u, this plumb has %d: rebuild it", path,
                       (unsigned)engine->abi_version, (int)PL_ENGINE_ABI_VERSION);
    }
    if (engine->struct_size < sizeof *engine) {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s: its pl_engine has %u bytes, this plumb's has %zu: rebuild it", path,
                       (unsigned)engine->struct_size, sizeof *engine);
    }
    const char *missing = engine->name == NULL            ? "name"
                          : engine->version == NULL       ? "version"
                          : engine->profiles == NULL      ? "profiles"
                          : engine->create == NULL        ? "create"
                          : engine->destroy == NULL       ? "destroy"
                          : engine->step == NULL          ? "step"
                          : engine->read_frame == NULL    ? "read_frame"
                          : engine->read_pair == NULL     ? "read_pair"
                          : engine->read_settings == NULL ? "read_settings"
                                                          : NULL;
    if (missing != NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s: its pl_engine lacks %s", path, missing);
    }
    if (engine->profile_count < 1 || engine->profile_count > MOST_PROFILES) {
        return pl_fail(error, PL_BAD_INPUT, "%s: has %d profiles, expected 1 to %d", path,
                       engine->profile_count, (int)MOST_PROFILES);
    }
    if (engine->option_count < 0 || engine->option_count > PL_ENGINE_MAX_OPTIONS ||
        (engine->option_count > 0 && engine->options == NULL)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: has %d options, expected 0 to %d", path,
                       engine->option_count, (int)PL_ENGINE_MAX_OPTIONS);
    }
    return PL_OK;
}

static pl_status load_engine(const char *path, const pl_engine **engine, pl_error *error)
{
    /* dlopen looks for a bare name in the system's folders, not here. */
    char here[300];
    snprintf(here, sizeof here, "%s%s", strchr(path, '/') == NULL ? "./" : "", path);
    void *library = dlopen(here, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "cannot load %s: %s", path, dlerror());
    }
    union { /* ISO C has no conversion from an object's address to a function's. */
        void *object;
        pl_engine_entry function;
    } symbol = {.object = dlsym(library, PL_ENGINE_SYMBOL)};
    if (symbol.object == NULL) {
        dlclose(library);
        return pl_fail(error, PL_BAD_INPUT, "%s: exports no " PL_ENGINE_SYMBOL, path);
    }
    const pl_engine *loaded = symbol.function();
    pl_status status = check_loaded(path, loaded, error);
    if (status != PL_OK) {
        dlclose(library);
        return status;
    }
    *engine = loaded;
    return PL_OK;
}

static pl_status find_built_in(const char *name, const pl_engine **engine, pl_error *error)
{
    const char *names[MOST_KNOWN];
    int count = 0;
    const pl_known_engine *known = pl_known_engines(&count);
    for (int i = 0; i < count; ++i) {
        names[i] = known[i].name;
        if (strcmp(known[i].name, name) != 0) {
            continue;
        }
        if (known[i].engine == NULL) {
            return pl_fail(error, PL_UNSUPPORTED,
                           "engine %s is not in this build: install %s and build again", name,
                           known[i].package);
        }
        *engine = known[i].engine;
        return PL_OK;
    }
    return fail_unknown(error, "engine", name, names, count);
}

static pl_status find_profile(const pl_engine *engine, const char *name, int *profile,
                              pl_error *error)
{
    const char *names[MOST_PROFILES];
    for (int i = 0; i < engine->profile_count; ++i) {
        names[i] = engine->profiles[i].name;
        if (strcmp(names[i], name) == 0) {
            *profile = i;
            return PL_OK;
        }
    }
    char what[96];
    snprintf(what, sizeof what, "profile of engine %s", engine->name);
    return fail_unknown(error, what, name, names, engine->profile_count);
}

static void profile_values(const pl_engine *engine, int profile, double *values)
{
    for (int i = 0; i < engine->option_count; ++i) {
        values[i] = engine->options[i].value;
    }
    if (engine->profile_defaults != NULL) {
        engine->profile_defaults(profile, values);
    }
}

int pl_engine_option_index(const pl_engine *engine, const char *name)
{
    for (int i = 0; i < engine->option_count; ++i) {
        if (strcmp(engine->options[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

/* Whether a value is in the range of its option. */
static bool is_allowed(const pl_engine_option *option, double value)
{
    return value >= option->min && value <= option->max &&
           (!option->integer || value == floor(value));
}

/* ---- Tuned profiles ---- */

/* A profile of a file. */
typedef struct tuned_profile {
    char base[PL_NAME_SIZE];              /* the engine's own profile */
    double values[PL_ENGINE_MAX_OPTIONS]; /* (option_count) of the options in `given` */
    bool given[PL_ENGINE_MAX_OPTIONS];
} tuned_profile;

static const char *json_text_of(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text == NULL ? "" : text;
}

static pl_status read_options(const pl_engine *engine, const char *path, json_t *file,
                              tuned_profile *profile, pl_error *error)
{
    const char *key;
    json_t *value;
    *profile = (tuned_profile){.base = ""};
    snprintf(profile->base, sizeof profile->base, "%s", json_text_of(file, "profile"));
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

static pl_status read_profile(const pl_engine *engine, const char *name, const char *path,
                              tuned_profile *profile, bool *found, pl_error *error)
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
    if (strcmp(json_text_of(file, "schema"), "plumb.profile/1") != 0 ||
        !json_is_object(json_object_get(file, "options"))) {
        status =
            pl_fail(error, PL_BAD_INPUT, "%s: is no plumb.profile/1, as plumb tune saves it", path);
    } else if (strcmp(json_text_of(file, "engine"), engine->name) == 0 &&
               strcmp(json_text_of(file, "name"), name) == 0) {
        *found = true;
        status = read_options(engine, path, file, profile, error);
    }
    json_decref(file);
    return status;
}

static pl_status find_tuned_profile(const pl_engine *engine, const char *name,
                                    tuned_profile *profile, bool *found, pl_error *error)
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

/* Chooses one of the engine's own profiles, or one of a file, which changes some of its values. */
static pl_status choose_profile(pl_engine_choice *choice, const char *name, pl_error *error)
{
    const pl_engine *engine = choice->engine;
    tuned_profile tuned;
    bool found = false;
    if (find_profile(engine, name, &choice->profile, NULL) != PL_OK) {
        pl_status status = find_tuned_profile(engine, name, &tuned, &found, error);
        if (status != PL_OK) {
            return status;
        }
    }
    pl_status status = find_profile(engine, found ? tuned.base : name, &choice->profile, error);
    profile_values(engine, choice->profile, choice->values);
    for (int i = 0; found && i < engine->option_count; ++i) {
        choice->values[i] = tuned.given[i] ? tuned.values[i] : choice->values[i];
    }
    return status;
}

/* ---- SPEC ---- */

/* Applies one "option=value"; `given` marks the options that were set already. */
static pl_status set_option(const pl_engine *engine, char *text, double *values, bool *given,
                            pl_error *error)
{
    char *equals = strchr(text, '=');
    if (equals == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "\"%s\": expected option=value", text);
    }
    *equals = '\0';
    const char *value_text = equals + 1;
    int index = pl_engine_option_index(engine, text);
    if (index < 0) {
        const char *names[PL_ENGINE_MAX_OPTIONS];
        for (int i = 0; i < engine->option_count; ++i) {
            names[i] = engine->options[i].name;
        }
        char what[96];
        snprintf(what, sizeof what, "option of engine %s", engine->name);
        return fail_unknown(error, what, text, names, engine->option_count);
    }
    const pl_engine_option *option = &engine->options[index];
    if (given[index]) {
        return pl_fail(error, PL_BAD_INPUT, "option %s is given twice", option->name);
    }
    given[index] = true;
    char *end = NULL;
    double value = strtod(value_text, &end);
    if (end == value_text || *end != '\0' || !isfinite(value)) {
        return pl_fail(error, PL_BAD_INPUT, "option %s: expected a number, found \"%s\"",
                       option->name, value_text);
    }
    if (option->integer && value != floor(value)) {
        return pl_fail(error, PL_BAD_INPUT, "option %s: expected an integer, found %s",
                       option->name, value_text);
    }
    if (value < option->min || value > option->max) {
        return pl_fail(error, PL_BAD_INPUT, "option %s: expected %g to %g, found %s", option->name,
                       option->min, option->max, value_text);
    }
    values[index] = value;
    return PL_OK;
}

/* Ends the piece that `*rest` stands at, moves past it, and returns the character that ended it. */
static char cut(char **rest, const char *ends)
{
    *rest += strcspn(*rest, ends);
    char end = **rest;
    if (end != '\0') {
        *(*rest)++ = '\0';
    }
    return end;
}

pl_status pl_engine_choose(const char *spec, pl_engine_choice *choice, pl_error *error)
{
    pl_engine_choice made = {.engine = NULL};
    size_t length = strlen(spec);
    if (length >= sizeof made.spec) {
        return pl_fail(error, PL_BAD_INPUT, "engine \"%.40s...\": longer than %zu characters", spec,
                       sizeof made.spec - 1);
    }
    memcpy(made.spec, spec, length + 1);

    char text[sizeof made.spec];
    memcpy(text, spec, length + 1);
    char *rest = text + name_length(text);
    char separator = cut(&rest, ":,");
    pl_status status = is_path(text) ? load_engine(text, &made.engine, error)
                                     : find_built_in(text, &made.engine, error);
    if (status != PL_OK) {
        return status;
    }
    profile_values(made.engine, made.profile, made.values);
    if (separator == ':') {
        const char *profile = rest;
        separator = cut(&rest, ",");
        status = choose_profile(&made, profile, error);
        if (status != PL_OK) {
            return status;
        }
    }
    bool given[PL_ENGINE_MAX_OPTIONS] = {false};
    while (separator == ',') {
        char *setting = rest;
        separator = cut(&rest, ",");
        status = set_option(made.engine, setting, made.values, given, error);
        if (status != PL_OK) {
            return status;
        }
    }
    *choice = made;
    return PL_OK;
}

/* The shortest text that reads back to the same number. */
static void format_number(double value, char text[32])
{
    for (int digits = 6; digits <= 17; ++digits) {
        snprintf(text, 32, "%.*g", digits, value);
        if (strtod(text, NULL) == value) {
            return;
        }
    }
}

void pl_engine_choice_label(const pl_engine_choice *choice, char label[128])
{
    const pl_engine *engine = choice->engine;
    double defaults[PL_ENGINE_MAX_OPTIONS];
    profile_values(engine, choice->profile, defaults);
    size_t used =
        (size_t)snprintf(label, 128, "%s:%s", engine->name, engine->profiles[choice->profile].name);
    for (int i = 0; i < engine->option_count && used < 128; ++i) {
        if (choice->values[i] != defaults[i]) {
            char number[32];
            format_number(choice->values[i], number);
            used += (size_t)snprintf(label + used, 128 - used, ",%s=%s", engine->options[i].name,
                                     number);
        }
    }
}
