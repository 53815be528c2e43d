#include "selection.h"

#include "adapters/tuned_profile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void pl_texts_add(pl_texts *texts, const char *item)
{
    const char **grown = realloc(texts->items, ((size_t)texts->count + 1) * sizeof *grown);
    if (grown == NULL) {
        fprintf(stderr, "plumb: out of memory\n");
        exit(PL_EXIT_FAILED);
    }
    texts->items = grown;
    texts->items[texts->count++] = item;
}

pl_selection pl_selection_default(void)
{
    return (pl_selection){.dt = NAN, .duration = NAN};
}

void pl_selection_free(pl_selection *selection)
{
    free(selection->settings.items);
    *selection = pl_selection_default();
}

enum { KEY_SET = 0x100, KEY_DT, KEY_DURATION, KEY_SEED, KEY_TIMEOUT, KEY_MEMORY, KEY_PROFILES };

static const struct argp_option selection_options[] = {
    {"set", KEY_SET, "NAME=VALUE", 0,
     "Sets a parameter of every named scenario that has it (repeatable; see plumb list scenarios)",
     0},
    {"dt", KEY_DT, "S", 0, "Time step in seconds, also as a fraction: 1/240", 0},
    {"duration", KEY_DURATION, "S", 0, "Simulated time in seconds", 0},
    {"seed", KEY_SEED, "N", 0, "Seed of scenarios that draw random numbers (default 0)", 0},
    {0}};

static error_t parse_selection(int key, char *text, struct argp_state *state)
{
    pl_selection *selection = state->input;
    const double shortest = 1e-9;
    switch (key) {
    case KEY_SET:
        if (strchr(text, '=') == NULL || text[0] == '=') {
            argp_error(state, "--set takes NAME=VALUE; found \"%s\"", text);
        }
        pl_texts_add(&selection->settings, text);
        return 0;
    case KEY_DT:
        selection->dt = pl_option_number(state, "--dt takes seconds", text, shortest, 1e3);
        return 0;
    case KEY_DURATION:
        selection->duration =
            pl_option_number(state, "--duration takes seconds", text, shortest, 1e9);
        return 0;
    case KEY_SEED:
        selection->seed =
            (uint64_t)pl_option_integer(state, "--seed takes an integer", text, 0, (1L << 53) - 1);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp pl_selection_argp = {.options = selection_options, .parser = parse_selection};

static const struct argp_option limits_options[] = {
    {"timeout", KEY_TIMEOUT, "S", 0, "Longest wall time of a run in seconds (default 120)", 0},
    {"memory", KEY_MEMORY, "GIB", 0,
     "Largest address space of a run in GiB (default 8; 0: no limit)", 0},
    {"profiles", KEY_PROFILES, "FILE", 0,
     "Profiles that plumb tune saved: --engine NAME:tuned then is one (repeatable, before those of "
     "the environment's PLUMB_PROFILES)",
     0},
    {0}};

/* Puts a file before those that the environment names, where engines are looked for. */
static void add_profiles(const char *path)
{
    const char *before = getenv(PL_PROFILES_VARIABLE);
    char *paths = NULL;
    if (asprintf(&paths, "%s%s%s", path, before == NULL ? "" : ":", before == NULL ? "" : before) <
            0 ||
        setenv(PL_PROFILES_VARIABLE, paths, 1) != 0) {
        fprintf(stderr, "plumb: out of memory\n");
        exit(PL_EXIT_FAILED);
    }
    free(paths);
}

static error_t parse_limits(int key, char *text, struct argp_state *state)
{
    pl_limits *limits = state->input;
    switch (key) {
    case KEY_TIMEOUT:
        limits->timeout = pl_option_number(state, "--timeout takes seconds", text, 1e-3, 1e6);
        return 0;
    case KEY_PROFILES:
        add_profiles(text);
        return 0;
    case KEY_MEMORY:
        limits->memory =
            (uint64_t)(0x1p30 * pl_option_number(state, "--memory takes GiB", text, 0, 1048576));
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp limits_argp = {.options = limits_options, .parser = parse_limits};

const struct argp_child pl_run_children[] = {
    {&pl_selection_argp, 0, NULL, 0}, {&limits_argp, 0, NULL, 0}, {0}};

pl_limits pl_limits_default(void)
{
    return (pl_limits){.timeout = 120, .memory = UINT64_C(8) << 30};
}

static bool is_scene_file(const char *name)
{
    size_t length = strlen(name);
    return strcmp(name, "-") == 0 || strchr(name, '/') != NULL ||
           (length > 5 && strcmp(name + length - 5, ".json") == 0);
}

static bool has_param(const pl_scenario *scenario, const char *setting)
{
    size_t length = strcspn(setting, "=");
    for (int i = 0; i < scenario->param_count; ++i) {
        const char *name = scenario->params[i].name;
        if (strlen(name) == length && strncmp(name, setting, length) == 0) {
            return true;
        }
    }
    return false;
}

/* An error that names the option, the parameter and the nearest one of all `scenarios`. */
static pl_status unknown_param(const char *option, const char *setting,
                               const pl_scenario *const *scenarios, int count, pl_error *error)
{
    char word[PL_NAME_SIZE];
    const char *nearest = NULL;
    snprintf(word, sizeof word, "%.*s", (int)strcspn(setting, "="), setting);
    for (int i = 0; i < count && nearest == NULL; ++i) {
        const char *names[PL_MAX_PARAMS];
        for (int k = 0; k < scenarios[i]->param_count; ++k) {
            names[k] = scenarios[i]->params[k].name;
        }
        nearest = pl_nearest_name(word, names, scenarios[i]->param_count);
    }
    if (count == 0) {
        return pl_fail(error, PL_BAD_INPUT, "%s %s: a scene file has no parameters; edit the file",
                       option, setting);
    }
    return pl_fail(error, PL_BAD_INPUT, "%s %s: no chosen scenario has the parameter %s%s%s%s",
                   option, setting, word, nearest == NULL ? "" : "; did you mean ",
                   nearest == NULL ? "" : nearest, nearest == NULL ? "" : "?");
}

static pl_status check_settings(const char *option, const pl_texts *settings,
                                const pl_scenario *const *scenarios, int count, pl_error *error)
{
    for (int i = 0; i < settings->count; ++i) {
        const char *setting = settings->items[i];
        bool known = false;
        for (int k = 0; k < count; ++k) {
            known = known || has_param(scenarios[k], setting);
        }
        if (!known) {
            return unknown_param(option, setting, scenarios, count, error);
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

static pl_status add_scenario(const pl_selection *selection, const pl_scenario *scenario,
                              const char *own_setting, pl_plan *plan, pl_error *error)
{
    char dt[48];
    char duration[48];
    pl_texts chosen = {.count = 0};
    if (own_setting != NULL) {
        pl_texts_add(&chosen, own_setting);
    }
    if (!isnan(selection->dt)) {
        snprintf(dt, sizeof dt, "dt=%.17g", selection->dt);
        pl_texts_add(&chosen, dt);
    }
    if (!isnan(selection->duration)) {
        snprintf(duration, sizeof duration, "duration=%.17g", selection->duration);
        pl_texts_add(&chosen, duration);
    }
    add_known(scenario, &selection->settings, &chosen);
    add_known(scenario, &selection->others, &chosen);
    pl_status status = pl_plan_add_scenario(plan, scenario, chosen.items, chosen.count, error);
    free(chosen.items);
    return status;
}

pl_status pl_selection_add(const pl_selection *selection, const pl_asked *asked, int count,
                           pl_plan *plan, pl_error *error)
{
    const pl_scenario **scenarios = calloc((size_t)count + 1, sizeof *scenarios);
    if (scenarios == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    pl_status status = PL_OK;
    int known = 0;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        if (!is_scene_file(asked[i].name)) {
            scenarios[known] = pl_scenario_find(asked[i].name, error);
            status = scenarios[known] == NULL ? PL_BAD_INPUT : PL_OK;
            ++known;
        }
    }
    if (status == PL_OK) {
        status = check_settings("--set", &selection->settings, scenarios, known, error);
    }
    if (status == PL_OK) {
        status =
            check_settings(selection->others_option, &selection->others, scenarios, known, error);
    }
    plan->seed = selection->seed;
    int next = 0;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = is_scene_file(asked[i].name)
                     ? pl_plan_add_scene_file(plan, asked[i].name, selection->dt,
                                              selection->duration, error)
                     : add_scenario(selection, scenarios[next++], asked[i].setting, plan, error);
    }
    free(scenarios);
    return status;
}
