/* An engine describes itself in a process of its own: it says in shared memory how far it has come, so that a
 * fault has a place, and answers with what it answers to hello of plumb.engine/1, with what the harness finds: its
 * binary, the stamp of that, and whether it gives contact problems. */
#include "engine_info.h"

#include "adapters/contact_problems.h"
#include "adapters/process/hello.h"
#include "base/heap.h"
#include "base/json_field.h"
#include "process.h"

#include <fenv.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { LEAST_SECONDS = 1, MOST_SECONDS = 30 };

/* The last stage that a process reports before its answer. */
static const char COMPLETE[] = "after it was unloaded";

/* How far the process of a description has come, in memory that the harness shares with it. */
enum { PLACE_SIZE = 160 };
static char *place;

static pl_limits describe_limits = {.timeout = MOST_SECONDS};

void pl_engine_describe_within(const pl_limits *limits)
{
    describe_limits = *limits;
    describe_limits.timeout = fmax(LEAST_SECONDS, fmin(limits->timeout, MOST_SECONDS));
}

/* ---- In the process that loads the engine ---- */

/* `name` ends the text. */
static void enter(const char *stage, const char *name)
{
    snprintf(place, PLACE_SIZE, "%s%s", stage, name);
}

/* The values of each profile, (profile_count x option_count). PL_BAD_INPUT: one is not in the range of its
 * option. */
static pl_status read_defaults(const pl_engine *engine, double *defaults, pl_error *error)
{
    for (int i = 0; i < engine->profile_count; ++i) {
        double values[PL_ENGINE_MAX_OPTIONS];
        for (int k = 0; k < engine->option_count; ++k) {
            values[k] = engine->options[k].value;
        }
        if (engine->profile_defaults != NULL) {
            fenv_t environment;
            enter("while it was asked for the defaults of profile ", engine->profiles[i].name);
            fegetenv(&environment);
            engine->profile_defaults(i, values);
            fesetenv(&environment);
        }
        for (int k = 0; k < engine->option_count; ++k) {
            const pl_engine_option *option = &engine->options[k];
            if (!(values[k] >= option->min && values[k] <= option->max)) {
                return pl_fail(error, PL_BAD_INPUT,
                               "profile %s: the default %g of option %s is not within %g to %g",
                               engine->profiles[i].name, values[k], option->name, option->min,
                               option->max);
            }
            defaults[i * engine->option_count + k] = values[k];
        }
    }
    return PL_OK;
}

static bool gives_contact_problems(const pl_engine *engine)
{
    fenv_t environment;
    enter("while it was asked for an extension", "");
    fegetenv(&environment);
    const bool gives = pl_contact_problems_of(engine) != NULL;
    fesetenv(&environment);
    return gives;
}

static pl_status describe(const pl_engine_info *info, json_t **description, pl_error *error)
{
    char hash[17];
    char stamp[17] = "";
    pl_loaded_engine loaded;
    const int mapped = pl_mapped_file_count();
    enter("while it was loaded", "");
    pl_status status = pl_load_engine(info, &loaded, error);
    if (status == PL_OK) {
        status = pl_binary_hash(info, mapped, hash, error);
    }
    if (status == PL_OK && info->path != NULL) {
        status = pl_binary_stamp(mapped, stamp, error);
    }
    if (status != PL_OK) {
        return status;
    }
    const pl_engine *e = &loaded.table;
    double defaults[PL_ENGINE_MAX_PROFILES * PL_ENGINE_MAX_OPTIONS];
    pl_error cause = {.message = ""};
    status = read_defaults(e, defaults, &cause);
    if (status == PL_OK) {
        *description = pl_hello_write(e, defaults);
        json_object_update_new(*description, json_pack("{s:b, s:s, s:s}", "gives_contact_problems",
                                                       (int)gives_contact_problems(e), "binary",
                                                       hash, "stamp", stamp));
    }
    enter("while it was unloaded", "");
    pl_unload_engine(&loaded);
    return status == PL_OK ? PL_OK : pl_fail(error, status, "%s: %s", info->spec, cause.message);
}

/* `user` is the info, of which the fields about the origin are set. */
static void describe_and_answer(void *user, FILE *answer)
{
    json_t *description = NULL;
    pl_error error = {.message = ""};
    pl_status status = describe(user, &description, &error);
    if (status != PL_OK) {
        description =
            json_pack("{s:i, s:o}", "status", (int)status, "error", pl_json_text(error.message));
    }
    enter(COMPLETE, "");
    fputs("\n", answer); /* whatever the engine wrote before it */
    json_dumpf(description, answer, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(description);
}

/* ---- In the harness's process ---- */

/* An info with what it points to. */
typedef struct known_info {
    pl_engine_info info;
    pl_hello hello; /* holds the texts */
    struct known_info *next;
} known_info;

/* False when the answer is not that of an engine. */
static bool read_description(known_info *known, const json_t *answer)
{
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_engine_info *info = &known->info;
    const pl_engine *table = &known->hello.table;
    if (!pl_hello_read(answer, &known->hello, &diagnostic) || table->name[0] == '\0' ||
        strlen(table->name) >= PL_NAME_SIZE) {
        return false;
    }
    double *defaults =
        pl_heap_new((size_t)table->profile_count * (size_t)table->option_count, sizeof *defaults);
    for (int i = 0; i < table->profile_count; ++i) {
        double *values = defaults + i * table->option_count;
        for (int k = 0; k < table->option_count; ++k) {
            values[k] = table->options[k].value;
        }
        pl_hello_profile_values(&known->hello, i, values);
    }
    info->name = table->name;
    info->version = table->version;
    info->description = table->description;
    info->residual_unit = table->residual_unit;
    info->runtime = table->runtime;
    info->capabilities = table->capabilities;
    info->contacts = table->contacts;
    info->precision = table->precision;
    info->integrator = table->integrator;
    info->gyroscopic = table->gyroscopic;
    info->substeps = table->substeps;
    info->profiles = table->profiles;
    info->profile_count = table->profile_count;
    info->options = table->options;
    info->option_count = table->option_count;
    info->sources = table->sources;
    info->source_count = table->source_count;
    info->defaults = defaults;
    info->reads_settings = known->hello.reads_settings;
    info->reads_pairs = known->hello.reads_pairs;
    info->gives_contact_problems = json_is_true(json_object_get(answer, "gives_contact_problems"));
    snprintf(info->binary, sizeof info->binary, "%s", pl_json_get_text(answer, "binary"));
    snprintf(info->stamp, sizeof info->stamp, "%s", pl_json_get_text(answer, "stamp"));
    return true;
}

/* The name by which an engine goes that could not say its own: the base name of its file, or the end
 * of its command, where characters that separate the parts of a SPEC become '_'. */
static const char *name_of_file(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *name = pl_heap_copy(slash == NULL ? path : slash + 1);
    for (char *c = name; *c != '\0'; ++c) {
        *c = (unsigned char)*c <= ' ' || *c == 0x7f || strchr(":,=", *c) != NULL ? '_' : *c;
    }
    name[strlen(name) < PL_NAME_SIZE ? strlen(name) : PL_NAME_SIZE - 1] = '\0';
    return name;
}

/* An engine whose process ended early, or could not go on for the reason given. */
static void note_fault(known_info *known, const pl_process *process, const char *reason)
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

/* The last line of the answer, which is JSON; NULL: the process did not come to its end. */
static json_t *read_answer(const pl_process *process)
{
    const size_t length = process->text.length;
    const char *line = length > 0 ? memrchr(process->text.data, '\n', length) : NULL;
    const bool is_complete = line != NULL && strcmp(place, COMPLETE) == 0;
    return is_complete ? json_loadb(line, (size_t)(process->text.data + length - line),
                                    JSON_REJECT_DUPLICATES, NULL)
                       : NULL;
}

static pl_status ask(known_info *known, pl_error *error)
{
    pl_process process;
    enter("before it was loaded", "");
    pl_status status =
        pl_process_start(&process, &describe_limits, describe_and_answer, &known->info, error);
    if (status == PL_OK) {
        status = pl_process_wait(&process, error);
    }
    if (status != PL_OK) {
        return status;
    }
    place[PLACE_SIZE - 1] = '\0';
    json_t *answer = read_answer(&process);
    const char *refusal = json_string_value(json_object_get(answer, "error"));
    if (refusal != NULL && json_integer_value(json_object_get(answer, "status")) == PL_BAD_INPUT) {
        status = pl_fail(error, PL_BAD_INPUT, "%s", refusal);
    } else if (refusal != NULL || answer == NULL || !read_description(known, answer)) {
        note_fault(known, &process, refusal);
    }
    json_decref(answer);
    pl_process_free(&process);
    return status;
}

static bool is_same(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
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
    known_info *known = pl_heap_new(1, sizeof *known);
    pl_engine_info *found = &known->info;
    found->built_in = built_in;
    found->path = path == NULL ? NULL : pl_heap_copy(path);
    found->command = command == NULL ? NULL : pl_heap_copy(command);
    found->spec = built_in != NULL ? pl_heap_copy(built_in->name)
                  : path != NULL   ? pl_heap_copy(path)
                                   : pl_heap_format("exec:%s", command);
    place = pl_shared_new(PLACE_SIZE);
    const pl_status status = ask(known, error);
    munmap(place, PLACE_SIZE);
    if (status != PL_OK) {
        pl_hello_free(&known->hello);
        free((char *)found->command);
        free((char *)found->path);
        free((char *)found->spec);
        free(known);
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
