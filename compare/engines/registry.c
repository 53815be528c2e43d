/* SPEC = name[:profile][,option=value]...[,label=TEXT] */
#include "registry.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How the SPEC of a program begins. */
static const char EXEC[] = "exec:";

static const char BLANKS[] = " \t\n";

static bool is_program(const char *spec)
{
    return strncmp(spec, EXEC, strlen(EXEC)) == 0;
}

/* Length of a profile's or an option's name at `text`. */
static size_t word_length(const char *text)
{
    return strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-");
}

/* Length of the value of the option that begins at `text`, a number; of a label, any text. 0: it has
 * none. */
static size_t value_length(const char *text, size_t name_length)
{
    static const char LABEL[] = "label";
    const char *value = text + name_length + 1;
    const size_t length = strcspn(value, ",");
    char *end = NULL;
    if (name_length == strlen(LABEL) && strncmp(text, LABEL, name_length) == 0) {
        return length;
    }
    strtod(value, &end);
    return isspace((unsigned char)*value) || end != value + length ? 0 : length;
}

/* Whether `text` is [:PROFILE][,OPTION=NUMBER]... to its end. */
static bool is_choice(const char *text)
{
    if (*text == ':') {
        const size_t length = word_length(text + 1);
        if (length == 0) {
            return false;
        }
        text += 1 + length;
    }
    while (*text == ',') {
        const size_t length = word_length(text + 1);
        if (length == 0 || text[1 + length] != '=') {
            return false;
        }
        const size_t value = value_length(text + 1, length);
        if (value == 0) {
            return false;
        }
        text += 1 + length + 1 + value;
    }
    return *text == '\0';
}

/* Length of the name at the head of a spec. A path may hold ':' and ',' up to its ".so". */
static size_t name_length(const char *spec)
{
    if (is_program(spec)) {
        size_t length = strlen(EXEC);
        while (!is_choice(spec + length)) {
            ++length;
        }
        return length;
    }
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

pl_status pl_engine_of_build(const pl_built_in *built_in, const pl_engine_info **info,
                             pl_error *error)
{
    char command[4200], path[PL_BUILT_IN_PATH];
    const bool is_module = pl_built_in_path(built_in, path, sizeof path);
    const bool is_script = pl_built_in_command(built_in, command, sizeof command);
    if (!pl_built_in_is_present(built_in)) {
        char how[PL_HOW_TO_GET];
        pl_built_in_how_to_get(built_in, how, sizeof how);
        return pl_fail(error, PL_UNSUPPORTED, "engine %s is absent: %s gets it (%s %s)",
                       built_in->name, how, is_script ? "npm" : "Debian", built_in->package);
    }
    return pl_engine_describe(is_module ? path : NULL, is_script ? command : NULL, built_in, info,
                              error);
}

static pl_status find_built_in(const char *name, const pl_engine_info **engine, pl_error *error)
{
    const char *names[PL_MOST_BUILT_IN];
    int count = 0;
    const pl_built_in *all = pl_built_in_engines(&count);
    for (int i = 0; i < count; ++i) {
        names[i] = all[i].name;
        if (strcmp(all[i].name, name) == 0) {
            return pl_engine_of_build(&all[i], engine, error);
        }
    }
    return fail_unknown(error, "engine", name, names, count);
}

static pl_status find_profile(const pl_engine_info *engine, const char *name, int *profile,
                              pl_error *error)
{
    const char *names[PL_ENGINE_MAX_PROFILES];
    *profile = pl_engine_profile_index(engine, name);
    if (*profile >= 0) {
        return PL_OK;
    }
    for (int i = 0; i < engine->profile_count; ++i) {
        names[i] = engine->profiles[i].name;
    }
    char what[160];
    const bool is_users = engine->command != NULL && engine->built_in == NULL;
    snprintf(what, sizeof what, "profile of engine %s%s%.80s%s", engine->name,
             is_users ? ", whose command is " : "", is_users ? engine->command : "",
             is_users ? "," : "");
    return fail_unknown(error, what, name, names, engine->profile_count);
}

static void take_profile_values(pl_engine_choice *choice)
{
    memcpy(choice->values, pl_engine_profile_values(choice->engine, choice->profile),
           (size_t)choice->engine->option_count * sizeof *choice->values);
}

/* Chooses one of the engine's own profiles, or one of a file, which changes some of its values. */
static pl_status choose_profile(pl_engine_choice *choice, const char *name, pl_error *error)
{
    const pl_engine_info *engine = choice->engine;
    pl_tuned_profile tuned;
    bool found = false;
    pl_status status = PL_OK;
    if (pl_engine_profile_index(engine, name) < 0) {
        status = pl_tuned_profile_find(engine, name, &tuned, &found, error);
    }
    if (status == PL_OK) {
        status = find_profile(engine, found ? tuned.base : name, &choice->profile, error);
    }
    if (status != PL_OK) {
        return status;
    }
    take_profile_values(choice);
    for (int i = 0; found && i < engine->option_count; ++i) {
        choice->values[i] = tuned.given[i] ? tuned.values[i] : choice->values[i];
    }
    return PL_OK;
}

static pl_status set_label(const char *text, pl_engine_choice *choice, pl_error *error)
{
    if (text[0] == '\0' || strlen(text) >= sizeof choice->label || choice->label[0] != '\0') {
        return pl_fail(error, PL_BAD_INPUT, "label: expected one text of 1 to %zu bytes",
                       sizeof choice->label - 1);
    }
    for (const char *c = text; *c != '\0'; ++c) {
        if ((unsigned char)*c < ' ' || *c == 0x7f) {
            return pl_fail(error, PL_BAD_INPUT, "label: has a control character");
        }
    }
    snprintf(choice->label, sizeof choice->label, "%s", text);
    return PL_OK;
}

/* Applies one "option=value"; `given` marks the options that were set already. */
static pl_status set_option(pl_engine_choice *choice, char *text, bool *given, pl_error *error)
{
    const pl_engine_info *engine = choice->engine;
    char *equals = strchr(text, '=');
    if (equals == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "\"%s\": expected option=value", text);
    }
    *equals = '\0';
    const char *value_text = equals + 1;
    if (strcmp(text, "label") == 0) {
        return set_label(value_text, choice, error);
    }
    if (engine->fault.is_fault) {
        return PL_OK;
    }
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
    choice->values[index] = value;
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
    if (is_program(text) && rest == text + strlen(EXEC) + strspn(text + strlen(EXEC), BLANKS)) {
        return pl_fail(error, PL_BAD_INPUT, "engine \"%s\": expected a command after \"%s\"", spec,
                       EXEC);
    }
    char separator = cut(&rest, ":,");
    pl_status status =
        is_program(text) ? pl_engine_describe(NULL, text + strlen(EXEC), NULL, &made.engine, error)
        : is_path(text)  ? pl_engine_describe(text, NULL, NULL, &made.engine, error)
                         : find_built_in(text, &made.engine, error);
    if (status != PL_OK) {
        return status;
    }
    take_profile_values(&made);
    if (separator == ':') {
        const char *profile = rest;
        separator = cut(&rest, ",");
        status = made.engine->fault.is_fault ? PL_OK : choose_profile(&made, profile, error);
        if (status != PL_OK) {
            return status;
        }
    }
    bool given[PL_ENGINE_MAX_OPTIONS] = {false};
    while (separator == ',') {
        char *setting = rest;
        separator = cut(&rest, ",");
        status = set_option(&made, setting, given, error);
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

/* Adds ",option=value" for each option that differs from `from` (engine->option_count). */
static void add_options(const pl_engine_choice *choice, const double *from, size_t used,
                        char label[PL_LABEL_SIZE])
{
    const pl_engine_info *engine = choice->engine;
    for (int i = 0; i < engine->option_count && used < PL_LABEL_SIZE; ++i) {
        if (choice->values[i] != from[i]) {
            char number[32];
            format_number(choice->values[i], number);
            used += (size_t)snprintf(label + used, PL_LABEL_SIZE - used, ",%s=%s",
                                     engine->options[i].name, number);
        }
    }
}

void pl_engine_choice_label(const pl_engine_choice *choice, char label[PL_LABEL_SIZE])
{
    const pl_engine_info *engine = choice->engine;
    if (choice->label[0] != '\0') {
        memcpy(label, choice->label, sizeof choice->label);
        return;
    }
    const int used = snprintf(label, PL_LABEL_SIZE, "%s:%s", engine->name,
                              engine->profiles[choice->profile].name);
    add_options(choice, pl_engine_profile_values(engine, choice->profile), (size_t)used, label);
}

void pl_engine_choice_varied_label(const pl_engine_choice *asked, const pl_engine_choice *varied,
                                   char label[PL_LABEL_SIZE])
{
    const pl_engine_info *engine = varied->engine;
    const bool same_profile = asked->profile == varied->profile;
    if (asked->label[0] == '\0') {
        pl_engine_choice_label(varied, label);
        return;
    }
    const int used = snprintf(label, PL_LABEL_SIZE, "%s%s%s", asked->label, same_profile ? "" : ":",
                              same_profile ? "" : engine->profiles[varied->profile].name);
    add_options(varied,
                same_profile ? asked->values : pl_engine_profile_values(engine, varied->profile),
                (size_t)used, label);
}
