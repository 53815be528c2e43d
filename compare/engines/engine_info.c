/* An engine describes itself in a process of its own: first one line for each stage, so that a
 * fault has a place, and at last one line of JSON. The texts of an info are those of that JSON. */
#include "engine_info.h"

#include "adapters/contact_problems.h"
#include "base/json_field.h"
#include "process.h"

#include <fenv.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

enum { LEAST_SECONDS = 1, MOST_SECONDS = 30, MOST_TEXT = 4096 };

/* The last stage that a process reports before its answer. */
static const char COMPLETE[] = "after it was unloaded";

static pl_limits describe_limits = {.timeout = MOST_SECONDS};

void pl_engine_describe_within(const pl_limits *limits)
{
    describe_limits = *limits;
    describe_limits.timeout = fmax(LEAST_SECONDS, fmin(limits->timeout, MOST_SECONDS));
}

/* ---- In the process that loads the engine ---- */

static json_t *text(const char *text_or_null)
{
    return text_or_null == NULL ? json_null()
                                : pl_json_text(text_or_null, strnlen(text_or_null, MOST_TEXT));
}

/* On a line of its own, whatever the engine wrote before it. */
static void report_stage(FILE *answer, const char *stage)
{
    fprintf(answer, "\n%s\n", stage);
    fflush(answer);
}

/* The defaults of a profile; NULL when one of them is not in the range of its option. */
static json_t *defaults_json(const pl_engine *engine, int profile, FILE *answer, pl_error *error)
{
    double values[PL_ENGINE_MAX_OPTIONS];
    for (int k = 0; k < engine->option_count; ++k) {
        values[k] = engine->options[k].value;
    }
    if (engine->profile_defaults != NULL) {
        fenv_t environment;
        char stage[PL_NAME_SIZE + 64];
        snprintf(stage, sizeof stage, "while it was asked for the defaults of profile %s",
                 engine->profiles[profile].name);
        report_stage(answer, stage);
        fegetenv(&environment);
        engine->profile_defaults(profile, values);
        fesetenv(&environment);
    }
    json_t *list = json_array();
    for (int k = 0; k < engine->option_count; ++k) {
        const pl_engine_option *option = &engine->options[k];
        if (!(values[k] >= option->min && values[k] <= option->max)) {
            pl_fail(error, PL_BAD_INPUT,
                    "profile %s: the default %g of option %s is not within %g to %g",
                    engine->profiles[profile].name, values[k], option->name, option->min,
                    option->max);
            json_decref(list);
            return NULL;
        }
        json_array_append_new(list, json_real(values[k]));
    }
    return list;
}

static json_t *profiles_json(const pl_engine *engine, FILE *answer, pl_error *error)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->profile_count; ++i) {
        const pl_engine_profile *profile = &engine->profiles[i];
        json_t *defaults = defaults_json(engine, i, answer, error);
        if (defaults == NULL) {
            json_decref(list);
            return NULL;
        }
        json_array_append_new(list,
                              json_pack("{s:o, s:o, s:b, s:o, s:o}", "name", text(profile->name),
                                        "help", text(profile->help), "in_default_comparison",
                                        (int)profile->in_default_comparison, "step_code",
                                        text(profile->step_code), "defaults", defaults));
    }
    return list;
}

static json_t *options_json(const pl_engine *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->option_count; ++i) {
        const pl_engine_option *o = &engine->options[i];
        json_array_append_new(
            list, json_pack("{s:o, s:f, s:f, s:f, s:b, s:o, s:o, s:o, s:I, s:f, s:f, s:b}", "name",
                            text(o->name), "value", o->value, "min", o->min, "max", o->max,
                            "integer", (int)o->integer, "unit", text(o->unit), "help",
                            text(o->help), "code", text(o->code), "tune_profiles",
                            (json_int_t)o->tune_profiles, "tune_min", o->tune_min, "tune_max",
                            o->tune_max, "tune_logarithmic", (int)o->tune_logarithmic));
    }
    return list;
}

static json_t *sources_json(const pl_engine *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->source_count; ++i) {
        const pl_engine_source *source = &engine->sources[i];
        json_array_append_new(list,
                              json_pack("{s:i, s:o, s:o}", "profile", source->profile, "option",
                                        text(source->option), "text", text(source->text)));
    }
    return list;
}

static bool gives_contact_problems(const pl_engine *engine, FILE *answer)
{
    fenv_t environment;
    report_stage(answer, "while it was asked for an extension");
    fegetenv(&environment);
    const bool gives = pl_contact_problems_of(engine) != NULL;
    fesetenv(&environment);
    return gives;
}

static pl_status describe(const pl_engine_info *info, FILE *answer, json_t **description,
                          pl_error *error)
{
    char hash[17];
    char stamp[17] = "";
    pl_loaded_engine loaded;
    const int mapped = pl_mapped_file_count();
    report_stage(answer, "while it was loaded");
    const char *libraries =
        info->built_in == NULL || info->path != NULL ? NULL : info->built_in->libraries;
    const pl_engine_origin origin = pl_engine_origin_of(info);
    pl_status status = pl_load_engine(&origin, &loaded, error);
    if (status == PL_OK) {
        status = loaded.is_program ? pl_program_hash(hash, error)
                                   : pl_binary_hash(mapped, libraries, hash, error);
    }
    if (status == PL_OK && info->path != NULL) {
        status = pl_binary_stamp(mapped, stamp, error);
    }
    if (status != PL_OK) {
        return status;
    }
    const pl_engine *e = &loaded.table;
    *description = json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:I, s:I, s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:b, s:b, s:b, "
        "s:s, s:s}",
        "name", text(e->name), "version", text(e->version), "description", text(e->description),
        "residual_unit", text(e->residual_unit), "runtime", text(e->runtime), "capabilities",
        (json_int_t)e->capabilities, "contacts", (json_int_t)e->contacts, "precision",
        (int)e->precision, "integrator", (int)e->integrator, "gyroscopic", (int)e->gyroscopic,
        "substeps", e->substeps, "profiles", profiles_json(e, answer, error), "options",
        options_json(e), "sources", sources_json(e), "reads_settings",
        (int)(e->read_settings != NULL), "reads_pairs", (int)(e->read_pair != NULL),
        "gives_contact_problems", (int)gives_contact_problems(e, answer), "binary", hash, "stamp",
        stamp);
    report_stage(answer, "while it was unloaded");
    pl_unload_engine(&loaded);
    if (*description != NULL) {
        return PL_OK;
    }
    const pl_error cause = *error;
    return cause.status == PL_OK
               ? pl_fail(error, PL_NO_MEMORY, "out of memory")
               : pl_fail(error, cause.status, "%s: %s", info->spec, cause.message);
}

/* `user` is the info, of which the fields about the origin are set. */
static void describe_and_answer(void *user, FILE *answer)
{
    json_t *description = NULL;
    pl_error error = {.message = ""};
    pl_status status = describe(user, answer, &description, &error);
    if (status != PL_OK) {
        description = json_pack("{s:i, s:o}", "status", (int)status, "error", text(error.message));
    }
    report_stage(answer, COMPLETE);
    json_dumpf(description, answer, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(description);
}

/* ---- In the harness's process ---- */

/* An info with what it points to. */
typedef struct known_info {
    pl_engine_info info;
    json_t *description; /* holds the texts */
    pl_engine_profile profiles[PL_ENGINE_MAX_PROFILES];
    pl_engine_option options[PL_ENGINE_MAX_OPTIONS];
    pl_engine_source sources[PL_ENGINE_MAX_SOURCES];
    double *defaults;
    struct known_info *next;
} known_info;

static const char *text_of(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

/* A text that must be there: "" otherwise. */
static const char *required_text(const json_t *object, const char *key)
{
    return pl_json_get_text(object, key);
}

static double number_of(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

static long long whole_of(const json_t *object, const char *key)
{
    return json_integer_value(json_object_get(object, key));
}

static bool flag_of(const json_t *object, const char *key)
{
    return json_is_true(json_object_get(object, key));
}

/* False when the counts are not those of an engine. */
static bool read_lists(known_info *known)
{
    const json_t *profiles = json_object_get(known->description, "profiles");
    const json_t *options = json_object_get(known->description, "options");
    const size_t profile_count = json_array_size(profiles);
    const size_t option_count = json_array_size(options);
    if (profile_count < 1 || profile_count > PL_ENGINE_MAX_PROFILES ||
        option_count > PL_ENGINE_MAX_OPTIONS) {
        return false;
    }
    known->defaults = calloc(profile_count * option_count + 1, sizeof *known->defaults);
    for (size_t i = 0; i < option_count; ++i) {
        const json_t *o = json_array_get(options, i);
        known->options[i] = (pl_engine_option){
            .name = required_text(o, "name"),
            .value = number_of(o, "value"),
            .min = number_of(o, "min"),
            .max = number_of(o, "max"),
            .integer = flag_of(o, "integer"),
            .unit = required_text(o, "unit"),
            .help = required_text(o, "help"),
            .code = text_of(o, "code"),
            .tune_profiles = (uint32_t)whole_of(o, "tune_profiles"),
            .tune_min = number_of(o, "tune_min"),
            .tune_max = number_of(o, "tune_max"),
            .tune_logarithmic = flag_of(o, "tune_logarithmic"),
        };
    }
    for (size_t i = 0; i < profile_count; ++i) {
        const json_t *p = json_array_get(profiles, i);
        const json_t *defaults = json_object_get(p, "defaults");
        if (json_array_size(defaults) != option_count) {
            return false;
        }
        known->profiles[i] =
            (pl_engine_profile){.name = required_text(p, "name"),
                                .help = required_text(p, "help"),
                                .in_default_comparison = flag_of(p, "in_default_comparison"),
                                .step_code = text_of(p, "step_code")};
        for (size_t k = 0; k < option_count && known->defaults != NULL; ++k) {
            known->defaults[i * option_count + k] = json_number_value(json_array_get(defaults, k));
        }
    }
    const json_t *sources = json_object_get(known->description, "sources");
    const size_t source_count = json_array_size(sources);
    if (source_count > PL_ENGINE_MAX_SOURCES) {
        return false;
    }
    for (size_t i = 0; i < source_count; ++i) {
        const json_t *s = json_array_get(sources, i);
        known->sources[i] = (pl_engine_source){.profile = (int)whole_of(s, "profile"),
                                               .option = text_of(s, "option"),
                                               .text = required_text(s, "text")};
    }
    known->info.source_count = (int)source_count;
    known->info.profile_count = (int)profile_count;
    known->info.option_count = (int)option_count;
    return known->defaults != NULL;
}

static bool read_description(known_info *known)
{
    const json_t *d = known->description;
    pl_engine_info *info = &known->info;
    info->name = required_text(d, "name");
    info->version = required_text(d, "version");
    info->description = required_text(d, "description");
    info->residual_unit = text_of(d, "residual_unit");
    info->runtime = text_of(d, "runtime");
    info->capabilities = (uint32_t)whole_of(d, "capabilities");
    info->contacts = (uint32_t)whole_of(d, "contacts");
    info->precision = (pl_precision)whole_of(d, "precision");
    info->integrator = (pl_integrator)whole_of(d, "integrator");
    info->gyroscopic = (pl_gyroscopic)whole_of(d, "gyroscopic");
    info->substeps = (int)whole_of(d, "substeps");
    info->reads_settings = flag_of(d, "reads_settings");
    info->reads_pairs = flag_of(d, "reads_pairs");
    info->gives_contact_problems = flag_of(d, "gives_contact_problems");
    snprintf(info->binary, sizeof info->binary, "%s", required_text(d, "binary"));
    snprintf(info->stamp, sizeof info->stamp, "%s", required_text(d, "stamp"));
    info->profiles = known->profiles;
    info->options = known->options;
    info->sources = known->sources;
    const bool complete = read_lists(known);
    info->defaults = known->defaults;
    return complete && info->name[0] != '\0' && strlen(info->name) < PL_NAME_SIZE;
}

/* The name by which an engine goes that could not say its own: the base name of its file, or the end
 * of its command, where characters that separate the parts of a SPEC become '_'. */
static const char *name_of_file(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *name = strdup(slash == NULL ? path : slash + 1);
    for (char *c = name; c != NULL && *c != '\0'; ++c) {
        *c = (unsigned char)*c <= ' ' || *c == 0x7f || strchr(":,=", *c) != NULL ? '_' : *c;
    }
    if (name != NULL && strlen(name) >= PL_NAME_SIZE) {
        name[PL_NAME_SIZE - 1] = '\0';
    }
    return name == NULL ? "engine" : name;
}

/* An engine whose process ended at `place`, the last stage that it reported, or could not go on. */
static void note_fault(known_info *known, const pl_process *process, const char *place,
                       const char *reason)
{
    static const double no_values[1];
    static const pl_engine_profile only[] = {{.name = "default", .help = ""}};
    pl_engine_info *info = &known->info;
    info->fault = (pl_engine_fault){.is_fault = true, .timed_out = process->timed_out};
    info->name = info->built_in != NULL
                     ? info->built_in->name
                     : name_of_file(info->path != NULL ? info->path : info->command);
    info->version = "unknown";
    info->description = "";
    info->profiles = only;
    info->profile_count = 1;
    info->option_count = 0;
    info->defaults = no_values;
    info->substeps = 1;
    if (info->path != NULL) {
        pl_file_hash(info->path, info->binary);
    }
    if (reason != NULL) {
        char line[201];
        pl_process_last_line(process, line);
        snprintf(info->fault.reason, sizeof info->fault.reason, "%s%s%s", reason,
                 line[0] == '\0' ? "" : "; last line: ", line);
    } else if (strcmp(place, COMPLETE) == 0) {
        snprintf(info->fault.reason, sizeof info->fault.reason, "its description is damaged: %s",
                 PL_FOREIGN_DESCRIPTOR);
    } else {
        pl_process_describe_end(process, describe_limits.timeout, place, info->fault.reason,
                                sizeof info->fault.reason);
    }
}

/* Whether a line is one of report_stage, and not something else that the engine wrote there. */
static bool is_stage(const char *line, size_t length)
{
    return length < 160 && ((length > 6 && memcmp(line, "while ", 6) == 0) ||
                            (length == strlen(COMPLETE) && memcmp(line, COMPLETE, length) == 0));
}

/* Separates the last line of the answer, which is JSON, from the stages. PL_NO_MEMORY. */
static pl_status split_answer(const pl_process *process, char place[160], json_t **description,
                              pl_error *error)
{
    json_error_t fault;
    const char *text_begin = process->text;
    size_t length = process->text_length;
    *description = NULL;
    snprintf(place, 160, "before it was loaded");
    while (length > 0) {
        const char *newline = memchr(text_begin, '\n', length);
        if (newline == NULL) {
            *description = json_loadb(text_begin, length, JSON_REJECT_DUPLICATES, &fault);
            return *description == NULL && pl_json_lacked_memory(&fault)
                       ? pl_fail(error, PL_NO_MEMORY, "out of memory for an engine")
                       : PL_OK;
        }
        const size_t line = (size_t)(newline - text_begin);
        if (is_stage(text_begin, line)) {
            snprintf(place, 160, "%.*s", (int)line, text_begin);
        }
        length -= (size_t)(newline - text_begin) + 1;
        text_begin = newline + 1;
    }
    return PL_OK;
}

static pl_status ask(known_info *known, pl_error *error)
{
    pl_process process;
    char place[160];
    pl_status status =
        pl_process_start(&process, &describe_limits, describe_and_answer, &known->info, error);
    if (status == PL_OK) {
        status = pl_process_wait(&process, error);
    }
    if (status != PL_OK) {
        return status;
    }
    status = split_answer(&process, place, &known->description, error);
    if (strcmp(place, COMPLETE) != 0) {
        json_decref(known->description);
        known->description = NULL;
    }
    const char *refusal = text_of(known->description, "error");
    if (status != PL_OK) {
        goto cleanup;
    }
    if (refusal != NULL && whole_of(known->description, "status") == PL_BAD_INPUT) {
        status = pl_fail(error, PL_BAD_INPUT, "%s", refusal);
    } else if (refusal != NULL || known->description == NULL || !read_description(known)) {
        note_fault(known, &process, place, refusal);
    }

cleanup:
    pl_process_free(&process);
    return status;
}

static bool is_same(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

pl_engine_origin pl_engine_origin_of(const pl_engine_info *info)
{
    return (pl_engine_origin){.path = info->path,
                              .command = info->command,
                              .entry = info->built_in == NULL ? NULL : info->built_in->entry};
}

pl_status pl_engine_describe(const char *path, const char *command, const pl_built_in *built_in,
                             const pl_engine_info **info, pl_error *error)
{
    static known_info *first; /* they live until the program ends */
    for (known_info *known = first; known != NULL; known = known->next) {
        if (known->info.built_in == built_in && is_same(known->info.path, path) &&
            is_same(known->info.command, command)) {
            *info = &known->info;
            return PL_OK;
        }
    }
    known_info *known = calloc(1, sizeof *known);
    char *spec = NULL;
    if (known == NULL || asprintf(&spec, "%s%s", command != NULL && built_in == NULL ? "exec:" : "",
                                  built_in != NULL ? built_in->name
                                  : path != NULL   ? path
                                                   : command) < 0) {
        free(known);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for an engine");
    }
    known->info.spec = spec;
    known->info.path = path == NULL ? NULL : strdup(path);
    known->info.built_in = built_in;
    known->info.command = command == NULL ? NULL : strdup(command);
    pl_status status = (path != NULL && known->info.path == NULL) ||
                               (command != NULL && known->info.command == NULL)
                           ? pl_fail(error, PL_NO_MEMORY, "out of memory for an engine")
                           : ask(known, error);
    if (status != PL_OK) {
        json_decref(known->description);
        free(known->defaults);
        free((char *)known->info.command);
        free((char *)known->info.path);
        free(known);
        free(spec);
        return status;
    }
    known->next = first;
    first = known;
    *info = &known->info;
    return PL_OK;
}

const char *pl_engine_runtime(const pl_engine_info *info)
{
    return info->runtime == NULL ? "native" : info->runtime;
}

int pl_engine_option_index(const pl_engine_info *info, const char *name)
{
    for (int i = 0; i < info->option_count; ++i) {
        if (strcmp(info->options[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

int pl_engine_profile_index(const pl_engine_info *info, const char *name)
{
    for (int i = 0; i < info->profile_count; ++i) {
        if (strcmp(info->profiles[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

const double *pl_engine_profile_values(const pl_engine_info *info, int profile)
{
    return info->defaults + (size_t)profile * (size_t)info->option_count;
}

int pl_engine_threads(const pl_engine_info *info, const double *values)
{
    const int option = pl_engine_option_index(info, "threads");
    return option >= 0 && values[option] > 1 && values[option] < INT_MAX ? (int)values[option] : 1;
}
