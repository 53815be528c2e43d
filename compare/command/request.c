#include "request.h"

#include "base/file_beneath.h"
#include "base/folding.h"
#include "base/heap.h"
#include "base/parallel.h"
#include "engines/registry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

pl_request pl_request_default(void)
{
    return (pl_request){.dt = NAN,
                        .duration = NAN,
                        .limits = {.timeout = 120, .memory = UINT64_C(8) << 30},
                        .jobs = 1};
}

void pl_request_free(pl_request *request)
{
    free(request->names.items);
    free(request->suites.items);
    free(request->engines.items);
    free(request->with.items);
    free(request->settings.items);
    *request = pl_request_default();
}

/* ---- Options ---- */

static pl_status parse_setting(void *options, const char *text, pl_error *error)
{
    pl_request *request = options;
    if (strchr(text, '=') == NULL || text[0] == '=') {
        return pl_fail(error, PL_BAD_INPUT, "--set takes NAME=VALUE; found \"%s\"", text);
    }
    pl_texts_add(&request->settings, text);
    return PL_OK;
}

const pl_option pl_scene_options[] = {
    {"set", "NAME=VALUE",
     "Set a parameter of every named scenario or scene file that has it (repeatable; see plumb "
     "list scenarios)",
     PL_OPTION_PARSED, .parse = parse_setting},
    {"dt", "S", "Time step in seconds, also as a fraction: 1/240", PL_OPTION_NUMBER,
     .field = offsetof(pl_request, dt), .takes = "seconds", .min = 1e-9, .max = 1e3},
    {"duration", "S", "Simulated time in seconds", PL_OPTION_NUMBER,
     .field = offsetof(pl_request, duration), .takes = "seconds", .min = 1e-9, .max = 1e9},
    {"seed", "N", "Seed of scenarios that draw random numbers (default 0)", PL_OPTION_LARGE,
     .field = offsetof(pl_request, seed), .max = 0x1p53 - 1},
    {0}};

/* Puts a path before those of an environment variable, where it is looked up. */
static void add_path(const char *variable, const char *path)
{
    const char *before = getenv(variable);
    char *paths =
        pl_heap_format("%s%s%s", path, before == NULL ? "" : ":", before == NULL ? "" : before);
    if (setenv(variable, paths, 1) != 0) {
        pl_out_of_memory();
    }
    free(paths);
}

static pl_status add_profiles(void *options, const char *path, pl_error *error)
{
    (void)options;
    (void)error;
    add_path(PL_PROFILES_VARIABLE, path);
    return PL_OK;
}

static pl_status add_allowed(void *options, const char *folder, pl_error *error)
{
    (void)options;
    char *real = realpath(folder, NULL);
    struct stat status;
    if (real == NULL || stat(real, &status) != 0 || !S_ISDIR(status.st_mode) ||
        strchr(real, ':') != NULL) {
        free(real);
        return pl_fail(error, PL_BAD_INPUT,
                       "--allow-files takes a folder without ':' in its name; found \"%.200s\"",
                       folder);
    }
    add_path(PL_ALLOWED_VARIABLE, real);
    free(real);
    return PL_OK;
}

const pl_option pl_file_options[] = {
    {"allow-files", "DIR",
     "Let scenes name files below DIR too, not only below their own folder (repeatable)",
     PL_OPTION_PARSED, .parse = add_allowed},
    {0}};

static pl_status parse_memory(void *options, const char *text, pl_error *error)
{
    pl_request *request = options;
    double gib = 0;
    if (!pl_parse_number(text, &gib) || !(gib >= 0 && gib <= 1048576)) {
        return pl_fail(error, PL_BAD_INPUT, "--memory takes GiB, 0 to 1048576; found \"%s\"", text);
    }
    request->limits.memory = (uint64_t)(0x1p30 * gib);
    return PL_OK;
}

const pl_option pl_limit_options[] = {
    {"timeout", "S", "Longest wall time of a run in seconds (default 120)", PL_OPTION_NUMBER,
     .field = offsetof(pl_request, limits.timeout), .takes = "seconds", .min = 1e-3, .max = 1e6},
    {"cpu-limit", "S",
     "Longest CPU time in seconds of the engine's create and steps in a run. A call that reads "
     "counts only if it alone takes longer. The referee's time does not count (default: none)",
     PL_OPTION_NUMBER, .field = offsetof(pl_request, limits.cpu_time), .takes = "seconds",
     .min = 1e-3, .max = 1e6},
    {"memory", "GIB",
     "Largest memory of a run in GiB, beyond that of the harness (default 8; 0: no limit)",
     PL_OPTION_PARSED, .parse = parse_memory},
    {"profiles", "FILE",
     "Profiles that plumb tune saved, for --engine NAME:tuned (repeatable; they come before "
     "those of the environment variable PLUMB_PROFILES)",
     PL_OPTION_PARSED, .parse = add_profiles},
    {0}};

const pl_option pl_comparison_options[] = {
    {"suite", "NAME", "All scenarios of a suite (repeatable)", PL_OPTION_TEXTS,
     .field = offsetof(pl_request, suites), .values = "SUITE"},
    {"engine", "SPEC",
     "An engine: NAME[:PROFILE][,OPTION=VALUE...][,label=TEXT]; the path of a shared object, or "
     "exec:COMMAND, in place of NAME (repeatable; default: all native ones that are present)",
     PL_OPTION_TEXTS, .field = offsetof(pl_request, engines)},
    {"with", "NAMES",
     "Further engines by name, with the profiles that they propose: rapier,jolt, or all "
     "(repeatable; "
     "plumb doctor lists them)",
     PL_OPTION_TEXTS, .field = offsetof(pl_request, with)},
    {"json", "FILE", "Also write all results as JSON (- is standard output, in place of tables)",
     PL_OPTION_TEXT, .field = offsetof(pl_request, json)},
    {0}};

const pl_option pl_home_options[] = {
    {"home", "SPEC",
     "The engine that the report speaks for: where it is worse than others comes first. A label, "
     "ENGINE:PROFILE or ENGINE (default: none, all engines are peers)",
     PL_OPTION_TEXT, .field = offsetof(pl_request, home)},
    {0}};

const pl_option pl_jobs_options[] = {
    {"jobs", "N",
     "Runs at a time, as long as their engines have no more threads than there are CPUs (default "
     "1: runs at the same time disturb each other's times)",
     PL_OPTION_INTEGER, .field = offsetof(pl_request, jobs), .min = 1, .max = 1024},
    {0}};

const pl_option pl_out_options[] = {
    {"out", "DIR", "Where results go", PL_OPTION_TEXT, .field = offsetof(pl_request, out)},
    {"resume", NULL,
     "Keep the results in DIR and make only the runs that are missing, whatever the outcome "
     "of the others",
     PL_OPTION_FLAG, .field = offsetof(pl_request, resume)},
    {"force", NULL,
     "Replace the results in DIR, which stay until the first new ones are there, and the report",
     PL_OPTION_FLAG, .field = offsetof(pl_request, force)},
    {0}};

const pl_option pl_force_options[] = {{"force", NULL, "Replace files that exist", PL_OPTION_FLAG,
                                       .field = offsetof(pl_request, force)},
                                      {0}};

pl_status pl_request_check(const pl_request *request, const char *which, const char *reader,
                           pl_error *error)
{
    for (int i = 0; i < request->names.count && reader != NULL; ++i) {
        if (strcmp(request->names.items[i], "-") == 0) {
            return pl_fail(error, PL_BAD_INPUT,
                           "standard input can be read once, and %s reads its scene: give a file",
                           reader);
        }
    }
    return which == NULL || request->names.count > 0 || request->suites.count > 0
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT, "%s", which);
}

pl_status pl_request_outputs(const pl_request *request, const char *other, pl_error *error)
{
    const bool may_replace = request->force || request->resume;
    pl_status status = pl_output_check(request->json, may_replace, error);
    return status == PL_OK ? pl_output_check(other, may_replace, error) : status;
}

/* ---- Cases ---- */

static bool is_scene_file(const char *name)
{
    size_t length = strlen(name);
    return strcmp(name, "-") == 0 || strchr(name, '/') != NULL ||
           (length > 5 && strcmp(name + length - 5, ".json") == 0);
}

static bool has_param(const pl_scenario *scenario, const char *setting)
{
    char name[PL_NAME_SIZE];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(setting, "="), setting);
    return pl_scenario_param(scenario, name) >= 0;
}

/* Checks that some scenario of the plan has the parameter of each setting. The error names the option, the parameter
 * and the nearest one. */
static pl_status check_settings(const char *option, const pl_texts *settings, const pl_plan *plan,
                                pl_error *error)
{
    for (int i = 0; i < settings->count; ++i) {
        const char *setting = settings->items[i];
        char word[PL_NAME_SIZE], hint[PL_SUGGESTION_SIZE] = "";
        bool is_known = false;
        snprintf(word, sizeof word, "%.*s", (int)strcspn(setting, "="), setting);
        for (int k = 0; k < plan->case_count && !is_known; ++k) {
            const pl_scenario *scenario = plan->cases[k].descriptor;
            const char *names[PL_MAX_PARAMS];
            for (int p = 0; p < scenario->param_count; ++p) {
                names[p] = scenario->params[p].name;
            }
            is_known = has_param(scenario, setting);
            if (!is_known && hint[0] == '\0') {
                pl_did_you_mean(word, names, scenario->param_count, hint);
            }
        }
        if (!is_known) {
            return pl_fail(error, PL_BAD_INPUT, "%s %s: no chosen scenario has the parameter %s%s",
                           option, setting, word, hint);
        }
    }
    return PL_OK;
}

static void add_known(const pl_scenario *scenario, const pl_texts *settings, pl_texts *chosen)
{
    for (int i = 0; i < settings->count; ++i) {
        if (has_param(scenario, settings->items[i])) {
            pl_texts_add(chosen, settings->items[i]);
        }
    }
}

/* Adds a scenario or a scene file, with the setting of a suite (NULL: none) before those of the request. */
static pl_status add_case(const pl_request *request, const char *name, const char *own_setting,
                          pl_plan *plan, pl_error *error)
{
    char dt[48], duration[48];
    pl_texts chosen = {.count = 0};
    const pl_scenario *scenario = NULL;
    pl_status status = PL_OK;
    if (is_scene_file(name)) {
        status = pl_plan_open_file(plan, name, &scenario, error);
    } else {
        scenario = pl_scenario_find(name, error);
    }
    if (scenario == NULL) {
        return status == PL_OK ? PL_BAD_INPUT : status;
    }
    if (own_setting != NULL) {
        pl_texts_add(&chosen, own_setting);
    }
    if (!isnan(request->dt)) {
        snprintf(dt, sizeof dt, "dt=%.17g", request->dt);
        pl_texts_add(&chosen, dt);
    }
    if (!isnan(request->duration)) {
        snprintf(duration, sizeof duration, "duration=%.17g", request->duration);
        pl_texts_add(&chosen, duration);
    }
    add_known(scenario, &request->settings, &chosen);
    add_known(scenario, &request->others, &chosen);
    status = pl_plan_add_scenario(plan, scenario, chosen.items, chosen.count, error);
    free(chosen.items);
    return status;
}

pl_status pl_request_add_cases(const pl_request *request, pl_plan *plan, pl_error *error)
{
    pl_status status = PL_OK;
    plan->seed = request->seed;
    for (int i = 0; i < request->suites.count && status == PL_OK; ++i) {
        const pl_suite *suite = pl_suite_find(request->suites.items[i], error);
        status = suite == NULL ? PL_BAD_INPUT : PL_OK;
        for (int k = 0; status == PL_OK && k < suite->entry_count; ++k) {
            status = add_case(request, suite->entries[k].scenario, suite->entries[k].setting, plan,
                              error);
        }
    }
    for (int i = 0; i < request->names.count && status == PL_OK; ++i) {
        status = add_case(request, request->names.items[i], NULL, plan, error);
    }
    if (status == PL_OK) {
        status = check_settings("--set", &request->settings, plan, error);
    }
    return status == PL_OK ? check_settings(request->others_option, &request->others, plan, error)
                           : status;
}

/* ---- Engines ---- */

void pl_request_note_threads(const pl_call *call, const pl_plan *plan)
{
    const int cpus = pl_usable_cpus();
    for (int i = 0; i < plan->configuration_count; ++i) {
        const pl_configuration *c = &plan->configurations[i];
        const int threads = pl_engine_threads(c->choice.engine, c->choice.values);
        if (threads > cpus) {
            fprintf(
                stderr,
                "%s: note: %s asks for %d threads, of which no more than %d can run at a time "
                "here: its runs are made alone, and their wall times are those of so many CPUs\n",
                call->argv[0], c->label, threads, cpus);
        }
    }
}

/* Reports an engine that is absent; any other failure stays one. */
static pl_status pass_over(const pl_call *call, pl_status status, const pl_error *error)
{
    if (status == PL_UNSUPPORTED) {
        pl_print_line(stderr, "%s: %s", call->argv[0], error->message);
        return PL_OK;
    }
    return status;
}

/* Adds the profiles that a built-in engine proposes for comparison. */
static pl_status add_proposed(const pl_built_in *built_in, pl_plan *plan, pl_error *error)
{
    const pl_engine_info *engine = NULL;
    pl_status status = pl_engine_of_build(built_in, &engine, error);
    for (int k = 0; status == PL_OK && k < engine->profile_count; ++k) {
        char spec[2 * PL_NAME_SIZE];
        snprintf(spec, sizeof spec, "%s:%s", built_in->name, engine->profiles[k].name);
        if (engine->profiles[k].in_default_comparison) {
            status = pl_plan_add_engine(plan, spec, error);
        }
    }
    return status;
}

/* Marks in wanted[PL_MOST_BUILT_IN] also the engines that --with names, all of them for "all". A usage error
 * for a name that is none. */
static pl_status read_with(const pl_texts *with, bool *wanted, pl_error *error)
{
    int count;
    const pl_built_in *known = pl_built_in_engines(&count);
    const char *names[PL_MOST_BUILT_IN + 1] = {"all"};
    for (int i = 0; i < count; ++i) {
        names[i + 1] = known[i].name;
    }
    for (int i = 0; i < with->count; ++i) {
        for (const char *at = with->items[i]; *at != '\0';) {
            char name[PL_NAME_SIZE], hint[PL_SUGGESTION_SIZE];
            const size_t size = strcspn(at, ",");
            bool is_known = false;
            snprintf(name, sizeof name, "%.*s", (int)size, at);
            for (int k = 0; k < count; ++k) {
                const bool is_meant = strcmp(name, "all") == 0 || strcmp(name, known[k].name) == 0;
                wanted[k] = wanted[k] || is_meant;
                is_known = is_known || is_meant;
            }
            if (!is_known) {
                return pl_fail(error, PL_BAD_INPUT, "--with: there is no engine \"%s\"%s", name,
                               pl_did_you_mean(name, names, count + 1, hint));
            }
            at += size + (at[size] == ',');
        }
    }
    return PL_OK;
}

pl_status pl_request_add_engines(const pl_call *call, const pl_request *request, pl_plan *plan,
                                 pl_error *error)
{
    int count;
    const pl_built_in *known = pl_built_in_engines(&count);
    bool wanted[PL_MOST_BUILT_IN] = {false};
    for (int i = 0; i < count; ++i) {
        wanted[i] = known[i].script == NULL && request->engines.count == 0;
    }
    pl_engine_describe_within(&request->limits);
    pl_status status = read_with(&request->with, wanted, error);
    for (int i = 0; i < request->engines.count && status == PL_OK; ++i) {
        status = pass_over(call, pl_plan_add_engine(plan, request->engines.items[i], error), error);
    }
    for (int i = 0; i < count && status == PL_OK; ++i) {
        if (wanted[i]) {
            status = pass_over(call, add_proposed(&known[i], plan, error), error);
        }
    }
    return status;
}

pl_status pl_request_plan(const pl_call *call, const pl_request *request, pl_plan *plan,
                          pl_error *error)
{
    pl_status status = pl_request_add_cases(request, plan, error);
    return status == PL_OK ? pl_request_add_engines(call, request, plan, error) : status;
}
