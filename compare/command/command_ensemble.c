/* plumb ensemble: engines compared where no trajectory is right, by the distributions of what many
 * runs from almost the same start end in. Results are appended to DIR/results.jsonl as runs end. */
#include "commands.h"
#include "comparison.h"
#include "results/store.h"
#include "runner/execute.h"
#include "studies/ensemble/ensemble_report.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A --against: other settings of the scenarios. */
typedef struct other_setting {
    const char *text; /* as given */
    char *parts;      /* the same, cut at its commas */
    pl_texts settings;
} other_setting;

typedef struct options {
    pl_comparison comparison;
    pl_texts against;
    other_setting *others; /* (against.count) */
    int members;
    bool converged, keep;
} options;

enum { KEY_MEMBERS = 0x200, KEY_AGAINST, KEY_CONVERGED, KEY_KEEP };

static const char itself[] = "itself";

static const pl_comparison_help option_help = {
    .suite = "All scenarios of a suite (repeatable; default chaotic when no scenario is named)",
    .json = "Write the outcome as a JSON object there too (- is standard output)",
    .jobs = "Runs at a time (default the number of cores)",
    .out = "Where results and summary go (default ensemble)",
    .reader = "every member"};

static const struct argp_option argp_options[] = {
    {"members", KEY_MEMBERS, "N", 0, "Members of each ensemble (default 16)", 0},
    {"against", KEY_AGAINST, "NAME=VALUE[,...]|itself", 0,
     "Also a second ensemble of each engine, of members of its own, with these scenario settings, "
     "or with the same ones, and compare the two (repeatable)",
     0},
    {"converged", KEY_CONVERGED, NULL, 0,
     "Also each engine's own reference, NAME@converged: a 16th of the step, and 8 times its "
     "iterations where it has that option",
     0},
    {"keep-trajectories", KEY_KEEP, NULL, 0,
     "Leave the members' positions over time in DIR/trajectories", 0},
    {0}};

static void add_against(options *o, struct argp_state *state, const char *text)
{
    char *parts = strdup(text);
    other_setting *grown = realloc(o->others, ((size_t)o->against.count + 1) * sizeof *grown);
    if (parts == NULL || grown == NULL) {
        argp_failure(state, PL_EXIT_FAILED, 0, "out of memory");
        abort();
    }
    o->others = grown;
    other_setting *added = &o->others[o->against.count];
    *added = (other_setting){.text = text, .parts = parts};
    pl_texts_add(&o->against, text);
    char *rest = NULL;
    if (strcmp(text, itself) == 0) {
        return;
    }
    int parts_found = 0;
    for (char *part = strtok_r(parts, ",", &rest); part != NULL;
         part = strtok_r(NULL, ",", &rest)) {
        if (strchr(part, '=') == NULL || part[0] == '=') {
            argp_error(state, "--against takes NAME=VALUE[,NAME=VALUE]... or %s; found \"%s\"",
                       itself, text);
        }
        pl_texts_add(&added->settings, part);
        ++parts_found;
    }
    if (parts_found == 0) {
        argp_error(state, "--against takes NAME=VALUE[,NAME=VALUE]... or %s; found \"%s\"", itself,
                   text);
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        pl_comparison_init(&o->comparison, state);
        return 0;
    case KEY_MEMBERS:
        o->members = (int)pl_option_integer(state, "--members takes an integer", text, 2, 1000);
        return 0;
    case KEY_AGAINST:
        add_against(o, state, text);
        return 0;
    case KEY_CONVERGED:
        o->converged = true;
        return 0;
    case KEY_KEEP:
        o->keep = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "[SCENARIO|SCENE.json...]",
    .doc =
        "Compares engines where the motion is chaotic: each runs many members of the same scene, "
        "displaced by a ten-thousandth of a body's size, and the distributions of what they end "
        "in are compared. Says how long the members of an engine stay together, which engines are "
        "told apart and by what, and which laws members broke. Each run is in a process of its "
        "own; an engine that falls, crashes or hangs is a row, not a failure.\v"
        "Examples:\n"
        "  plumb ensemble --engine plumb --engine ode:quick --engine bullet:si\n"
        "  plumb ensemble pile --set n=60 --members 64 --converged --out pile-60\n"
        "  plumb ensemble wall-collapse --engine plumb --against friction=0.4 --against itself\n"
        "  plumb ensemble ./mine.json --engine ./mine.so:fast --json - | jq .comparisons",
    .children = pl_comparison_children};

/* The problems of a setting: those asked for, where the other setting's values come last. */
static pl_status add_problems(void *user, int setting, pl_plan *plan, pl_error *error)
{
    const options *o = user;
    pl_comparison comparison = o->comparison;
    if (setting > 0) {
        comparison.selection.others = o->others[setting - 1].settings;
        comparison.selection.others_option = "--against";
    }
    return pl_comparison_add_problems(&comparison, plan, error);
}

static bool skip(void *user, const char *run)
{
    return pl_store_has(user, run);
}

static pl_status keep_result(void *user, json_t *result, pl_error *error)
{
    return pl_store_append(user, result, error);
}

static char *path_in(const char *folder, const char *name, pl_error *error)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s", folder, name) < 0) {
        pl_fail(error, PL_NO_MEMORY, "out of memory");
        return NULL;
    }
    return path;
}

/* Files, then the summary on standard output, unless the JSON is there. */
static pl_status deliver(const options *o, const pl_ensemble_outcome *outcome, pl_error *error)
{
    char *json = path_in(o->comparison.out, "ensemble.json", error);
    char *summary = path_in(o->comparison.out, "summary.md", error);
    pl_status status = json == NULL || summary == NULL ? error->status : PL_OK;
    if (status == PL_OK) {
        status = pl_results_write_json(json, outcome->json, error);
    }
    if (status == PL_OK) {
        status = pl_write_text(summary, outcome->summary, strlen(outcome->summary), error);
    }
    if (status == PL_OK && o->comparison.json != NULL) {
        status = pl_results_write_json(o->comparison.json, outcome->json, error);
    }
    if (o->comparison.json == NULL || strcmp(o->comparison.json, "-") != 0) {
        fputs(outcome->summary, stdout);
    }
    free(json);
    free(summary);
    return status;
}

static bool all_unsupported(const json_t *results)
{
    size_t index;
    const json_t *result;
    json_array_foreach(results, index, result)
    {
        if (strcmp(pl_json_get_text(result, "outcome"), "unsupported") != 0) {
            return false;
        }
    }
    return true;
}

/* What the runs that are there say. */
static pl_status conclude(const options *o, const pl_plan *plan, const pl_ensembles *ensembles,
                          const json_t *results, const char *folder, pl_error *error)
{
    pl_ensemble_outcome outcome;
    char *path = path_in(o->comparison.out, "ensemble.json", error);
    if (path == NULL) {
        return PL_NO_MEMORY;
    }
    json_t *before = o->comparison.resume ? json_load_file(path, 0, NULL) : NULL;
    free(path);
    pl_status status =
        pl_ensemble_conclude(plan, ensembles, results, folder, before, &outcome, error);
    if (status == PL_OK) {
        status = deliver(o, &outcome, error);
    }
    if (status == PL_OK && !o->keep) {
        pl_ensemble_clear(plan, ensembles, folder);
    }
    pl_ensemble_outcome_free(&outcome);
    json_decref(before);
    return status;
}

/* Runs what is due and concludes. */
static int execute(const pl_call *call, const options *o, const pl_plan *plan,
                   const pl_ensembles *ensembles)
{
    pl_error error = {.message = ""};
    pl_store *store = NULL;
    int signal_number = 0;
    int code = PL_EXIT_OK;
    char *folder = path_in(o->comparison.out, "trajectories", &error);
    json_t *provenance = pl_provenance(call->program_argc, call->program_argv);
    pl_status status = provenance == NULL || folder == NULL
                           ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                           : pl_store_open(o->comparison.out, o->comparison.resume, &store, &error);
    if (status == PL_OK) {
        status = pl_make_directories(folder, &error);
    }
    if (status == PL_OK) {
        const pl_execution_def execution = {.plan = plan,
                                            .jobs = o->comparison.jobs,
                                            .limits = o->comparison.limits,
                                            .positions = folder,
                                            .provenance = provenance,
                                            .progress = stderr,
                                            .user = store,
                                            .skip = skip,
                                            .keep = keep_result};
        status = pl_execute(&execution, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        status = conclude(o, plan, ensembles, pl_store_results(store), folder, &error);
        code = all_unsupported(pl_store_results(store)) ? PL_EXIT_NOTHING : PL_EXIT_OK;
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (signal_number != 0) {
        fprintf(stderr,
                "plumb ensemble: interrupted; %zu results are in %s/results.jsonl: the same "
                "command with --resume goes on from there\n",
                json_array_size(pl_store_results(store)), o->comparison.out);
        code = 128 + signal_number;
    }
    pl_store_close(store);
    json_decref(provenance);
    free(folder);
    return code;
}

static pl_status make_plan(options *o, pl_plan *plan, pl_ensembles *ensembles, pl_error *error)
{
    const pl_members_def def = {.members = o->members,
                                .setting_count = o->against.count,
                                .settings = o->against.items,
                                .references = o->converged,
                                .user = o,
                                .add = add_problems};
    if (o->comparison.names.count == 0 && o->comparison.suites.count == 0) {
        pl_texts_add(&o->comparison.suites, "chaotic");
    }
    pl_status status = pl_comparison_add_engines("plumb ensemble", &o->comparison, plan, error);
    return status == PL_OK ? pl_members_plan(&def, plan, ensembles, error) : status;
}

static int core_count(void)
{
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : count > 1024 ? 1024 : (int)count;
}

static void free_options(options *o)
{
    for (int i = 0; i < o->against.count; ++i) {
        free(o->others[i].parts);
        free(o->others[i].settings.items);
    }
    free(o->others);
    pl_comparison_free(&o->comparison);
    free(o->against.items);
}

int pl_command_ensemble(const pl_call *call)
{
    options o = {.comparison = pl_comparison_default(&option_help), .members = 16};
    o.comparison.out = "ensemble";
    o.comparison.jobs = core_count();
    pl_call_parse(call, &argp, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    pl_ensembles ensembles = {.count = 0};
    int code = PL_EXIT_OK;
    pl_status status = make_plan(&o, &plan, &ensembles, &error);
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (ensembles.count == 0) {
        fprintf(stderr, "plumb ensemble: there is nothing to compare\n");
        code = PL_EXIT_NOTHING;
    } else {
        code = execute(call, &o, &plan, &ensembles);
    }
    pl_ensembles_free(&ensembles);
    pl_plan_free(&plan);
    free_options(&o);
    return code;
}
