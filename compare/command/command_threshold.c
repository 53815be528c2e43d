/* plumb threshold: the critical value of a scenario's parameter, bisected on every engine. */
#include "command/commands.h"

#include "command/contest.h"
#include "results/store.h"
#include "threshold/row.h"

#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_selection selection;
    pl_limits limits;
    pl_texts names, suites, engines;
    const char *json;
    int jobs;
} options;

enum { KEY_SUITE = 0x200, KEY_ENGINE, KEY_JOBS, KEY_JSON };

static const struct argp_option argp_options[] = {
    {"suite", KEY_SUITE, "NAME", 0, "All scenarios of a suite that have a threshold (repeatable)",
     0},
    {"engine", KEY_ENGINE, "SPEC", 0,
     "An engine: NAME[:PROFILE][,OPTION=VALUE...], or the path of a shared object in place of NAME "
     "(repeatable; default all found)",
     0},
    {"jobs", KEY_JOBS, "N", 0, "Runs at a time, of different searches (default 1)", 0},
    {"json", KEY_JSON, "FILE", 0,
     "Write a JSON object a line for each scenario and engine (- is standard output)", 0},
    {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->selection;
        state->child_inputs[1] = &o->limits;
        return 0;
    case KEY_SUITE:
        pl_texts_add(&o->suites, text);
        return 0;
    case KEY_ENGINE:
        pl_texts_add(&o->engines, text);
        return 0;
    case KEY_JOBS:
        o->jobs = (int)pl_option_integer(state, "--jobs takes an integer", text, 1, 1024);
        return 0;
    case KEY_JSON:
        o->json = text;
        return 0;
    case ARGP_KEY_ARG:
        pl_texts_add(&o->names, text);
        return 0;
    case ARGP_KEY_END:
        if (o->names.count == 0 && o->suites.count == 0) {
            argp_error(state, "which scenario? plumb threshold SCENARIO, or --suite NAME");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "SCENARIO...",
    .doc =
        "Bisects the critical value of a scenario's parameter on every engine: on one side of it "
        "the scene holds (outcome ok), on the other it does not (collapsed). Each trial is a "
        "run in a process of its own. An engine that holds at both ends of the search, or at "
        "neither, or that fails, is a row, not a failure.\v"
        "Examples:\n"
        "  plumb threshold slope-threshold --set friction=0.5\n"
        "  plumb threshold slope-threshold slope-tip --engine plumb --engine ode:quick\n"
        "  plumb threshold --suite hard --jobs 2 --json thresholds.jsonl",
    .children = pl_run_children};

/* An error with the names of those that have one. */
static pl_status fail_without(const char *what, pl_error *error)
{
    int count;
    char list[400] = "";
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        size_t used = strlen(list);
        if (scenarios[i]->threshold != NULL) {
            snprintf(list + used, sizeof list - used, "%s%s", used == 0 ? "" : ", ",
                     scenarios[i]->name);
        }
    }
    return pl_fail(error, PL_BAD_INPUT, "%s has no threshold; these have one: %s", what, list);
}

/* A scenario that is named must have a threshold; those of suites may. */
static pl_status check_names(const options *o, pl_error *error)
{
    for (int i = 0; i < o->names.count; ++i) {
        const pl_scenario *scenario = pl_scenario_find(o->names.items[i], error);
        if (scenario == NULL) {
            return PL_BAD_INPUT;
        }
        if (scenario->threshold == NULL) {
            return fail_without(scenario->name, error);
        }
    }
    return PL_OK;
}

/* Leaves out the problems of suites that have no threshold. */
static pl_status keep_thresholds(pl_plan *plan, pl_error *error)
{
    int kept = 0;
    for (int i = 0; i < plan->problem_count; ++i) {
        pl_problem problem = plan->problems[i];
        if (problem.descriptor->threshold != NULL) {
            plan->problems[i] = plan->problems[kept];
            plan->problems[kept++] = problem;
        }
    }
    while (plan->problem_count > kept) {
        pl_problem *last = &plan->problems[--plan->problem_count];
        free(last->name);
        pl_scene_free(&last->scene);
    }
    return kept > 0 ? PL_OK : fail_without("the suite", error);
}

/* What is searched for cannot be set. */
static pl_status check_settings(const options *o, const pl_plan *plan, pl_error *error)
{
    for (int i = 0; i < plan->problem_count; ++i) {
        const char *param = plan->problems[i].descriptor->threshold->param;
        for (int k = 0; k < o->selection.settings.count; ++k) {
            const char *setting = o->selection.settings.items[k];
            size_t length = strcspn(setting, "=");
            if (strlen(param) == length && strncmp(setting, param, length) == 0) {
                return pl_fail(error, PL_BAD_INPUT, "--set %s: %s is what is searched for in %s",
                               setting, param, plan->problems[i].name);
            }
        }
    }
    return PL_OK;
}

static pl_status add_problems(const options *o, pl_plan *plan, pl_error *error)
{
    pl_status status = check_names(o, error);
    if (status == PL_OK) {
        status = pl_contest_add_problems(&o->selection, &o->suites, &o->names, plan, error);
    }
    if (status == PL_OK) {
        status = keep_thresholds(plan, error);
    }
    return status == PL_OK ? check_settings(o, plan, error) : status;
}

static pl_status write_lines(const char *path, const pl_plan *plan, const pl_search *searches,
                             int count, json_t *provenance, const char *started, pl_error *error)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    bool complete = stream != NULL;
    for (int i = 0; i < count && complete; ++i) {
        json_t *row = pl_threshold_json(plan, &searches[i], provenance, started);
        char *line = row == NULL ? NULL : pl_result_to_line(row);
        complete = line != NULL && fprintf(stream, "%s\n", line) > 0;
        free(line);
        json_decref(row);
    }
    complete = stream != NULL && fclose(stream) == 0 && complete;
    pl_status status = complete ? pl_write_text(path, text, length, error)
                                : pl_fail(error, PL_NO_MEMORY, "out of memory for %s", path);
    free(text);
    return status;
}

static bool all_unsupported(const pl_search *searches, int count)
{
    for (int i = 0; i < count; ++i) {
        if (strcmp(searches[i].outcome, "unsupported") != 0) {
            return false;
        }
    }
    return true;
}

static int search(const pl_call *call, const options *o, const pl_plan *plan)
{
    pl_error error = {.message = ""};
    pl_search *searches = NULL;
    int count = 0, signal_number = 0, code = PL_EXIT_OK;
    char started[32];
    pl_timestamp(started);
    json_t *provenance = pl_provenance(call->program_argc, call->program_argv);
    const pl_search_def def = {.plan = plan,
                               .jobs = o->jobs,
                               .limits = o->limits,
                               .provenance = provenance,
                               .progress = stderr};
    pl_status status = provenance == NULL
                           ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                           : pl_search_thresholds(&def, &searches, &count, &signal_number, &error);
    if (status == PL_OK && signal_number == 0) {
        code = all_unsupported(searches, count) ? PL_EXIT_NOTHING : PL_EXIT_OK;
        if (o->json != NULL) {
            status = write_lines(o->json, plan, searches, count, provenance, started, &error);
        }
        if (o->json == NULL || strcmp(o->json, "-") != 0) {
            pl_threshold_print(stdout, plan, searches, count);
        }
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (signal_number != 0) {
        code = 128 + signal_number;
    }
    free(searches);
    json_decref(provenance);
    return code;
}

int pl_command_threshold(const pl_call *call)
{
    options o = {.selection = pl_selection_default(), .limits = pl_limits_default(), .jobs = 1};
    pl_call_parse(call, &argp, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    int code = PL_EXIT_OK;
    pl_status status = add_problems(&o, &plan, &error);
    if (status == PL_OK) {
        status = pl_contest_add_engines("plumb threshold", &o.engines, &plan, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (plan.contender_count == 0) {
        fprintf(stderr, "plumb threshold: there is no engine to search on\n");
        code = PL_EXIT_NOTHING;
    } else {
        code = search(call, &o, &plan);
    }
    pl_plan_free(&plan);
    pl_selection_free(&o.selection);
    free(o.names.items);
    free(o.suites.items);
    free(o.engines.items);
    return code;
}
