#include "hello.h"

#include "base/json_field.h"
#include "hello_words.h"
#include "plumb/scenario.h"

#include <math.h>
#include <string.h>

/* ---- Words ---- */

/* The index of `word` among `words`, which end with NULL; -1: it is none of them. */
static int find_word(const char *const *words, const char *word)
{
    for (int i = 0; words[i] != NULL; ++i) {
        if (strcmp(words[i], word) == 0) {
            return i;
        }
    }
    return -1;
}

static bool unknown_word(const char *const *words, const json_t *found, pl_diagnostic *diagnostic)
{
    char all[200] = "", text[PL_FOUND_SIZE];
    for (int i = 0; words[i] != NULL; ++i) {
        const size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s\"%s\"", i == 0 ? "" : ", ", words[i]);
    }
    return pl_diagnose(diagnostic, "expected one of %s, found %s", all, pl_json_found(found, text));
}

/* The word at `key`, if there is one, as its index. */
static bool read_word(const json_t *object, const char *key, const char *const *words, int *index,
                      pl_diagnostic *diagnostic)
{
    const json_t *found = json_object_get(object, key);
    if (found == NULL || json_is_null(found)) {
        return true;
    }
    pl_path_push_key(&diagnostic->path, key);
    *index = json_is_string(found) ? find_word(words, json_string_value(found)) : -1;
    if (*index < 0) {
        return unknown_word(words, found, diagnostic);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* The words of an array as bits 1 << index. */
static bool read_words(const json_t *object, const char *key, const char *const *words,
                       uint32_t *bits, pl_diagnostic *diagnostic)
{
    const json_t *array;
    size_t i;
    const json_t *item;
    if (!pl_json_array(object, key, PL_OPTIONAL, &array, diagnostic)) {
        return false;
    }
    pl_path_push_key(&diagnostic->path, key);
    json_array_foreach(array, i, item)
    {
        const int index = json_is_string(item) ? find_word(words, json_string_value(item)) : -1;
        pl_path_push_index(&diagnostic->path, (int)i);
        if (index < 0) {
            return unknown_word(words, item, diagnostic);
        }
        *bits |= 1u << index;
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* Capabilities have the names that messages of the harness use. */
static bool read_capabilities(const json_t *answer, uint32_t *capabilities,
                              pl_diagnostic *diagnostic)
{
    const char *words[33] = {NULL};
    uint32_t bits_of[32], bits = 0;
    int count = 0;
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        if (pl_needs_name(bit) != NULL) {
            bits_of[count] = bit;
            words[count++] = pl_needs_name(bit);
        }
    }
    if (!read_words(answer, "capabilities", words, &bits, diagnostic)) {
        return false;
    }
    for (int i = 0; i < count; ++i) {
        *capabilities |= (bits >> i & 1u) != 0 ? bits_of[i] : 0;
    }
    return true;
}

/* ---- Lists ---- */

/* Reads each item of the array at `key`, an object, of at most `most`. */
static bool read_items(const json_t *object, const char *key, int most, int *count,
                       bool (*read)(const json_t *item, pl_hello *hello, int index,
                                    pl_diagnostic *diagnostic),
                       pl_hello *hello, pl_diagnostic *diagnostic)
{
    const json_t *array;
    size_t i;
    const json_t *item;
    if (!pl_json_array(object, key, PL_OPTIONAL, &array, diagnostic)) {
        return false;
    }
    pl_path_push_key(&diagnostic->path, key);
    *count = (int)json_array_size(array);
    if (*count > most) {
        return pl_diagnose(diagnostic, "expected at most %d, found %d", most, *count);
    }
    json_array_foreach(array, i, item)
    {
        char found[PL_FOUND_SIZE];
        pl_path_push_index(&diagnostic->path, (int)i);
        if (!json_is_object(item)) {
            return pl_diagnose(diagnostic, "expected an object, found %s",
                               pl_json_found(item, found));
        }
        if (!read(item, hello, (int)i, diagnostic)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool read_text(const json_t *object, const char *key, pl_presence presence,
                      const char **text, pl_diagnostic *diagnostic)
{
    const bool is_null = presence == PL_OPTIONAL && json_is_null(json_object_get(object, key));
    return is_null || pl_json_string(object, key, presence, "a text", text, diagnostic);
}

static bool read_profile(const json_t *item, pl_hello *hello, int index, pl_diagnostic *diagnostic)
{
    pl_engine_profile *p = &hello->profiles[index];
    *p = (pl_engine_profile){.help = ""};
    return read_text(item, "name", PL_REQUIRED, &p->name, diagnostic) &&
           read_text(item, "help", PL_OPTIONAL, &p->help, diagnostic) &&
           read_text(item, "step_code", PL_OPTIONAL, &p->step_code, diagnostic) &&
           pl_json_bool(item, "in_default_comparison", &p->in_default_comparison, diagnostic);
}

static const char *profile_name(const void *hello, int index)
{
    return ((const pl_hello *)hello)->profiles[index].name;
}

static const char *option_name(const void *hello, int index)
{
    return ((const pl_hello *)hello)->options[index].name;
}

/* The index of the item named `name` of `count`; a diagnostic for the current path if there is none. */
static bool find_named(const pl_hello *hello, const char *what,
                       const char *(*name_of)(const void *, int), int count, const char *name,
                       int *index, pl_diagnostic *diagnostic)
{
    char quoted[PL_QUOTED_SIZE];
    for (*index = 0; *index < count; ++*index) {
        if (strcmp(name_of(hello, *index), name) == 0) {
            return true;
        }
    }
    return pl_diagnose(diagnostic, "there is no %s %s", what, pl_quoted(name, quoted));
}

/* {"profiles": [names], "min", "max", "logarithmic"} */
static bool read_tune(const json_t *item, pl_hello *hello, pl_engine_option *option,
                      pl_diagnostic *diagnostic)
{
    const json_t *tune = json_object_get(item, "tune");
    const json_t *names;
    size_t i;
    const json_t *name;
    if (tune == NULL || json_is_null(tune)) {
        return true;
    }
    pl_path_push_key(&diagnostic->path, "tune");
    if (!pl_json_array(tune, "profiles", PL_REQUIRED, &names, diagnostic) ||
        !pl_json_number(tune, "min", PL_REQUIRED, &option->tune_min, diagnostic) ||
        !pl_json_number(tune, "max", PL_REQUIRED, &option->tune_max, diagnostic) ||
        !pl_json_bool(tune, "logarithmic", &option->tune_logarithmic, diagnostic)) {
        return false;
    }
    json_array_foreach(names, i, name)
    {
        int index;
        const char *text = json_is_string(name) ? json_string_value(name) : "";
        if (!find_named(hello, "profile", profile_name, hello->table.profile_count, text, &index,
                        diagnostic)) {
            return false;
        }
        option->tune_profiles |= index < 32 ? 1u << index : 0;
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool read_option(const json_t *item, pl_hello *hello, int index, pl_diagnostic *diagnostic)
{
    pl_engine_option *o = &hello->options[index];
    *o = (pl_engine_option){.unit = "1", .help = ""};
    return read_text(item, "name", PL_REQUIRED, &o->name, diagnostic) &&
           pl_json_number(item, "value", PL_REQUIRED, &o->value, diagnostic) &&
           pl_json_number(item, "min", PL_REQUIRED, &o->min, diagnostic) &&
           pl_json_number(item, "max", PL_REQUIRED, &o->max, diagnostic) &&
           pl_json_bool(item, "integer", &o->integer, diagnostic) &&
           read_text(item, "unit", PL_OPTIONAL, &o->unit, diagnostic) &&
           read_text(item, "help", PL_OPTIONAL, &o->help, diagnostic) &&
           read_text(item, "code", PL_OPTIONAL, &o->code, diagnostic) &&
           read_tune(item, hello, o, diagnostic);
}

static bool read_source(const json_t *item, pl_hello *hello, int index, pl_diagnostic *diagnostic)
{
    pl_engine_source *s = &hello->sources[index];
    const char *profile = NULL;
    int option;
    *s = (pl_engine_source){.option = NULL};
    return read_text(item, "profile", PL_REQUIRED, &profile, diagnostic) &&
           find_named(hello, "profile", profile_name, hello->table.profile_count, profile,
                      &s->profile, diagnostic) &&
           read_text(item, "option", PL_OPTIONAL, &s->option, diagnostic) &&
           (s->option == NULL || find_named(hello, "option", option_name, hello->table.option_count,
                                            s->option, &option, diagnostic)) &&
           read_text(item, "text", PL_REQUIRED, &s->text, diagnostic);
}

/* Whether the profiles' `values` are numbers of options that there are. */
static bool check_values(const pl_hello *hello, pl_diagnostic *diagnostic)
{
    size_t i;
    json_t *profile, *value;
    const char *key;
    json_array_foreach(json_object_get(hello->answer, "profiles"), i, profile)
    {
        json_object_foreach(json_object_get(profile, "values"), key, value)
        {
            int index;
            char found[PL_FOUND_SIZE];
            pl_path_push_key(&diagnostic->path, "profiles");
            pl_path_push_index(&diagnostic->path, (int)i);
            pl_path_push_key(&diagnostic->path, "values");
            if (!find_named(hello, "option", option_name, hello->table.option_count, key, &index,
                            diagnostic)) {
                return false;
            }
            if (!json_is_number(value)) {
                return pl_diagnose_field(diagnostic, key, "expected a number, found %s",
                                         pl_json_found(value, found));
            }
            diagnostic->path.depth -= 3;
        }
    }
    return true;
}

static bool read_lists(const json_t *answer, pl_hello *hello, pl_diagnostic *diagnostic)
{
    static const pl_engine_profile only = {.name = "default", .help = ""};
    pl_engine *table = &hello->table;
    if (!read_items(answer, "profiles", PL_ENGINE_MAX_PROFILES, &table->profile_count, read_profile,
                    hello, diagnostic)) {
        return false;
    }
    if (table->profile_count == 0) {
        hello->profiles[0] = only;
        table->profile_count = 1;
    }
    return read_items(answer, "options", PL_ENGINE_MAX_OPTIONS, &table->option_count, read_option,
                      hello, diagnostic) &&
           read_items(answer, "sources", PL_ENGINE_MAX_SOURCES, &table->source_count, read_source,
                      hello, diagnostic) &&
           check_values(hello, diagnostic);
}

/* ---- The answer ---- */

static bool read_protocol(const json_t *answer, pl_diagnostic *diagnostic)
{
    const json_t *protocol = json_object_get(answer, "protocol");
    char found[PL_FOUND_SIZE];
    return (json_is_string(protocol) && strcmp(json_string_value(protocol), PROTOCOL) == 0) ||
           pl_diagnose_field(diagnostic, "protocol", "expected \"%s\", found %s", PROTOCOL,
                             pl_json_found(protocol, found));
}

static bool read_substeps(const json_t *answer, int *substeps, pl_diagnostic *diagnostic)
{
    double number = 1;
    if (!pl_json_number(answer, "substeps", PL_OPTIONAL, &number, diagnostic)) {
        return false;
    }
    const bool is_right = number >= 1 && number <= 1e6 && number == floor(number);
    *substeps = is_right ? (int)number : 0;
    return pl_check_number(diagnostic, "substeps", number, is_right, "an integer of 1 to 1000000");
}

bool pl_hello_read(const json_t *answer, pl_hello *hello, pl_diagnostic *diagnostic)
{
    int precision = PL_PRECISION_DOUBLE, integrator = PL_INTEGRATOR_UNKNOWN;
    int gyroscopic = PL_GYROSCOPIC_UNKNOWN;
    uint32_t reads = 0;
    pl_engine *table = &hello->table;
    hello->answer = json_incref((json_t *)answer);
    *table = (pl_engine){.struct_size = sizeof *table,
                         .abi_version = PL_ENGINE_ABI_VERSION,
                         .description = "",
                         .runtime = "unknown",
                         .profiles = hello->profiles,
                         .options = hello->options,
                         .sources = hello->sources};
    if (!read_protocol(answer, diagnostic) ||
        !read_text(answer, "name", PL_REQUIRED, &table->name, diagnostic) ||
        !read_text(answer, "version", PL_REQUIRED, &table->version, diagnostic) ||
        !read_text(answer, "description", PL_OPTIONAL, &table->description, diagnostic) ||
        !read_text(answer, "runtime", PL_OPTIONAL, &table->runtime, diagnostic) ||
        !read_text(answer, "residual_unit", PL_OPTIONAL, &table->residual_unit, diagnostic) ||
        !read_capabilities(answer, &table->capabilities, diagnostic) ||
        !read_words(answer, "contacts", contacts, &table->contacts, diagnostic) ||
        !read_words(answer, "reads", readings, &reads, diagnostic) ||
        !read_word(answer, "precision", precisions, &precision, diagnostic) ||
        !read_word(answer, "integrator", integrators, &integrator, diagnostic) ||
        !read_word(answer, "gyroscopic", gyroscopics, &gyroscopic, diagnostic) ||
        !read_substeps(answer, &table->substeps, diagnostic) ||
        !read_lists(answer, hello, diagnostic)) {
        return false;
    }
    table->precision = (pl_precision)precision;
    table->integrator = (pl_integrator)integrator;
    table->gyroscopic = (pl_gyroscopic)gyroscopic;
    hello->reads_settings = (reads & 1u) != 0;
    hello->reads_pairs = (reads & 2u) != 0;
    return true;
}

void pl_hello_profile_values(const pl_hello *hello, int profile, double *values)
{
    const json_t *profiles = json_object_get(hello->answer, "profiles");
    const json_t *changed = json_object_get(json_array_get(profiles, (size_t)profile), "values");
    for (int i = 0; i < hello->table.option_count; ++i) {
        const json_t *value = json_object_get(changed, hello->options[i].name);
        values[i] = value == NULL ? values[i] : json_number_value(value);
    }
}

void pl_hello_free(pl_hello *hello)
{
    json_decref(hello->answer);
    *hello = (pl_hello){.answer = NULL};
}
