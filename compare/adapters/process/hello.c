#include "hello.h"

#include "base/json_field.h"
#include "plumb/scenario.h"

#include <math.h>
#include <string.h>

/* No text of an engine is longer in an answer. */
enum { MOST_TEXT = 4096 };

/* ---- Words ---- */

static const char PROTOCOL[] = "plumb.engine/1";

static const char *const precisions[] = {
    [PL_PRECISION_DOUBLE] = "double", [PL_PRECISION_FLOAT] = "float", NULL};
static const char *const integrators[] = {[PL_INTEGRATOR_UNKNOWN] = "unknown",
                                          [PL_INTEGRATOR_SEMI_IMPLICIT_EULER] =
                                              "semi-implicit Euler",
                                          [PL_INTEGRATOR_EXPLICIT_EULER] = "explicit Euler",
                                          [PL_INTEGRATOR_MIDPOINT] = "midpoint",
                                          NULL};
static const char *const gyroscopics[] = {[PL_GYROSCOPIC_UNKNOWN] = "unknown",
                                          [PL_GYROSCOPIC_NONE] = "none",
                                          [PL_GYROSCOPIC_EXPLICIT] = "explicit",
                                          [PL_GYROSCOPIC_IMPLICIT] = "implicit",
                                          NULL};
static const char *const contacts[] = {"points", "impulses", "torques", NULL};
static const char *const readings[] = {"settings", "pairs", NULL};

/* The names that messages of the harness have for capabilities, bit by bit: words[32], then NULL. Bits without
 * a name have an empty one. */
static void list_capabilities(const char *words[33])
{
    for (int i = 0; i < 32; ++i) {
        const char *name = pl_needs_name(1u << i);
        words[i] = name == NULL ? "" : name;
    }
    words[32] = NULL;
}

/* The index of `word` among `words`, which end with NULL; -1: it is none of them. */
static int find_word(const char *const *words, const json_t *word)
{
    const char *text = json_string_value(word);
    for (int i = 0; text != NULL && text[0] != '\0' && words[i] != NULL; ++i) {
        if (strcmp(words[i], text) == 0) {
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
        if (words[i][0] != '\0') {
            snprintf(all + used, sizeof all - used, "%s\"%s\"", i == 0 ? "" : ", ", words[i]);
        }
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
    *index = find_word(words, found);
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
        const int index = find_word(words, item);
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

/* The index of the item of that name among `count`, each of that size and beginning with its name; a diagnostic
 * for the current path if there is none. */
static bool find_named(const char *what, const void *items, size_t size, int count,
                       const char *name, int *index, pl_diagnostic *diagnostic)
{
    char quoted[PL_QUOTED_SIZE];
    for (*index = 0; *index < count; ++*index) {
        const void *item = (const char *)items + (size_t)*index * size;
        if (strcmp(*(const char *const *)item, name) == 0) {
            return true;
        }
    }
    return pl_diagnose(diagnostic, "there is no %s %s", what, pl_quoted(name, quoted));
}

static bool find_profile(const pl_hello *hello, const char *name, int *index,
                         pl_diagnostic *diagnostic)
{
    return find_named("profile", hello->profiles, sizeof *hello->profiles,
                      hello->table.profile_count, name, index, diagnostic);
}

static bool find_option(const pl_hello *hello, const char *name, int *index,
                        pl_diagnostic *diagnostic)
{
    return find_named("option", hello->options, sizeof *hello->options, hello->table.option_count,
                      name, index, diagnostic);
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
        if (!find_profile(hello, text, &index, diagnostic)) {
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
           find_profile(hello, profile, &s->profile, diagnostic) &&
           read_text(item, "option", PL_OPTIONAL, &s->option, diagnostic) &&
           (s->option == NULL || find_option(hello, s->option, &option, diagnostic)) &&
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
            if (!find_option(hello, key, &index, diagnostic)) {
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
    const char *capabilities[33];
    pl_engine *table = &hello->table;
    list_capabilities(capabilities);
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
        !read_words(answer, "capabilities", capabilities, &table->capabilities, diagnostic) ||
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

/* ---- Writing ---- */

static json_t *text(const char *text_or_null)
{
    return text_or_null == NULL ? json_null()
                                : pl_json_bytes(text_or_null, strnlen(text_or_null, MOST_TEXT));
}

const char *pl_hello_precision(pl_precision precision)
{
    return precisions[precision];
}

const char *pl_hello_integrator(pl_integrator integrator)
{
    return integrators[integrator];
}

static json_t *write_words(const char *const *words, uint32_t bits)
{
    json_t *list = json_array();
    for (int i = 0; words[i] != NULL; ++i) {
        if ((bits >> i & 1u) != 0 && words[i][0] != '\0') {
            json_array_append_new(list, json_string(words[i]));
        }
    }
    return list;
}

json_t *pl_hello_contacts(uint32_t reported)
{
    return write_words(contacts, reported);
}

json_t *pl_hello_tune(const pl_engine_option *option, const pl_engine_profile *profiles, int count)
{
    json_t *names = json_array();
    for (int i = 0; i < count && i < 32; ++i) {
        if ((option->tune_profiles >> i & 1u) != 0) {
            json_array_append_new(names, text(profiles[i].name));
        }
    }
    if (json_array_size(names) == 0) {
        json_decref(names);
        return NULL;
    }
    return json_pack("{s:f, s:f, s:b, s:o}", "min", option->tune_min, "max", option->tune_max,
                     "logarithmic", (int)option->tune_logarithmic, "profiles", names);
}

static json_t *option_list(const pl_engine *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->option_count; ++i) {
        const pl_engine_option *o = &engine->options[i];
        json_array_append_new(list,
                              json_pack("{s:o, s:f, s:f, s:f, s:b, s:o, s:o, s:o, s:o*}", "name",
                                        text(o->name), "value", o->value, "min", o->min, "max",
                                        o->max, "integer", (int)o->integer, "unit", text(o->unit),
                                        "help", text(o->help), "code", text(o->code), "tune",
                                        pl_hello_tune(o, engine->profiles, engine->profile_count)));
    }
    return list;
}

static json_t *profile_list(const pl_engine *engine, const double *defaults)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->profile_count; ++i) {
        const pl_engine_profile *p = &engine->profiles[i];
        json_t *values = json_object();
        for (int k = 0; k < engine->option_count; ++k) {
            const double value = defaults[i * engine->option_count + k];
            if (value != engine->options[k].value) {
                json_object_set_new(values, engine->options[k].name, json_real(value));
            }
        }
        json_array_append_new(list, json_pack("{s:o, s:o, s:b, s:o, s:o}", "name", text(p->name),
                                              "help", text(p->help), "in_default_comparison",
                                              (int)p->in_default_comparison, "step_code",
                                              text(p->step_code), "values", values));
    }
    return list;
}

static json_t *source_list(const pl_engine *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->source_count; ++i) {
        const pl_engine_source *source = &engine->sources[i];
        json_array_append_new(list,
                              json_pack("{s:o, s:o, s:o}", "profile",
                                        text(engine->profiles[source->profile].name), "option",
                                        text(source->option), "text", text(source->text)));
    }
    return list;
}

json_t *pl_hello_write(const pl_engine *e, const double *defaults)
{
    const char *capabilities[33];
    const uint32_t reads = (e->read_settings != NULL ? 1u : 0) | (e->read_pair != NULL ? 2u : 0);
    list_capabilities(capabilities);
    return json_pack(
        "{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:s, s:s, s:i, s:o, s:o, s:o, s:o}",
        "protocol", PROTOCOL, "name", text(e->name), "version", text(e->version), "description",
        text(e->description), "runtime", text(e->runtime == NULL ? "native" : e->runtime),
        "residual_unit", text(e->residual_unit), "capabilities",
        write_words(capabilities, e->capabilities), "contacts", pl_hello_contacts(e->contacts),
        "precision", precisions[e->precision], "integrator", integrators[e->integrator],
        "gyroscopic", gyroscopics[e->gyroscopic], "substeps", e->substeps, "profiles",
        profile_list(e, defaults), "options", option_list(e), "sources", source_list(e), "reads",
        write_words(readings, reads));
}
