/* plumb ensemble: engines compared where motion is chaotic, so that no single trajectory is right,
 * by the distributions of the end states of many runs from almost the same start. Results are
 * appended to DIR/results.jsonl as runs end. */
#include "base/array.h"
#include "base/folding.h"
#include "report/study_page.h"
#include "request.h"
#include "results/store.h"
#include "runner/execute.h"
#include "studies/ensemble/ensemble_report.h"
#include "studies/ensemble/verdict.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A --against: other settings of the scenarios. */
typedef struct other_setting {
    char *parts; /* the text, cut at its commas */
    pl_texts settings;
} other_setting;

typedef struct options {
    pl_request request;
    pl_texts against;
    other_setting *others; /* (other_count), of each text in `against` */
    int other_count;
    int members;
    bool converged, keep;
} options;

static const char ITSELF[] = "itself";

/* Cuts a text at its commas into settings. False for one that has none, or a part without '='. */
static bool cut_settings(char *parts, pl_texts *settings)
{
    char *rest = NULL;
    for (char *part = strtok_r(parts, ",", &rest); part != NULL;
         part = strtok_r(NULL, ",", &rest)) {
        if (strchr(part, '=') == NULL || part[0] == '=') {
            return false;
        }
        pl_texts_add(settings, part);
    }
    return settings->count > 0;
}

static pl_status add_against(void *user, const char *text, pl_error *error)
{
    options *o = user;
    other_setting added = {.parts = strdup(text)};
    if (added.parts == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    bool right = strcmp(text, ITSELF) == 0 || cut_settings(added.parts, &added.settings);
    pl_texts_add(&o->against, text);
    pl_status status = pl_array_push(&o->others, &o->other_count, &added, sizeof added, error);
    return status == PL_OK && !right
               ? pl_fail(error, PL_BAD_INPUT,
                         "--against takes NAME=VALUE[,NAME=VALUE]... or %s; found \"%s\"", ITSELF,
                         text)
               : status;
}

/* The cases of a setting: those asked for, with the other setting's values last. */
static pl_status add_cases(void *user, int setting, pl_plan *plan, pl_error *error)
{
    const options *o = user;
    pl_request request = o->request;
    if (setting > 0) {
        request.others = o->others[setting - 1].settings;
        request.others_option = "--against";
    }
    return pl_request_add_cases(&request, plan, error);
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
    char *json = path_in(o->request.out, "ensemble.json", error);
    char *summary = path_in(o->request.out, "summary.md", error);
    pl_status status = json == NULL || summary == NULL ? error->status : PL_OK;
    if (status == PL_OK) {
        status = pl_results_write_json(json, outcome->json, error);
    }
    if (status == PL_OK) {
        status = pl_write_text(summary, outcome->summary, strlen(outcome->summary), error);
    }
    if (status == PL_OK) {
        status = pl_study_page_write(o->request.out, "ensemble", outcome->json, error);
    }
    if (status == PL_OK) {
        status = pl_results_write_json(o->request.json, outcome->json, error);
    }
    if (!pl_is_stdout(o->request.json)) {
        fputs(outcome->text, stdout);
    }
    free(json);
    free(summary);
    return status;
}

/* What the runs that are there say. */
static pl_status conclude(const options *o, const pl_plan *plan, const pl_ensembles *ensembles,
                          const json_t *results, const char *folder, pl_error *error)
{
    pl_ensemble_outcome outcome;
    char *path = path_in(o->request.out, "ensemble.json", error);
    if (path == NULL) {
        return PL_NO_MEMORY;
    }
    json_t *before = o->request.resume ? json_load_file(path, 0, NULL) : NULL;
    free(path);
    pl_status status = pl_ensemble_conclude(plan, ensembles, results, folder, before,
                                            pl_window_width(stdout), &outcome, error);
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
    static const char *const report_files[] = {"ensemble.json", NULL};
    const pl_store_mode mode = pl_store_mode_of(o->request.resume, o->request.force);
    char *folder = path_in(o->request.out, "trajectories", &error);
    json_t *provenance = pl_call_provenance(call, &error);
    pl_status status = provenance == NULL || folder == NULL
                           ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                           : pl_store_open(o->request.out, mode, report_files, &store, &error);
    if (status == PL_OK) {
        status = pl_make_directories(folder, &error);
    }
    if (status == PL_OK) {
        const pl_execution_def execution = {.plan = plan,
                                            .jobs = o->request.jobs,
                                            .limits = o->request.limits,
                                            .positions = folder,
                                            .provenance = provenance,
                                            .store = store,
                                            .progress = stderr};
        status = pl_execute(&execution, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        status = conclude(o, plan, ensembles, pl_store_results(store), folder, &error);
        code = pl_results_all_unsupported(pl_store_results(store)) ? PL_EXIT_NOTHING : PL_EXIT_OK;
        if (status == PL_OK) {
            pl_store_finish(store);
        }
    }
    json_decref(provenance);
    free(folder);
    return pl_call_end_store(call, store, o->request.out, status, &error, signal_number, code);
}

static pl_status make_plan(const pl_call *call, options *o, pl_plan *plan, pl_ensembles *ensembles,
                           pl_error *error)
{
    const pl_members_def def = {.members = o->members,
                                .setting_count = o->against.count,
                                .settings = o->against.items,
                                .references = o->converged,
                                .user = o,
                                .add = add_cases};
    if (o->request.names.count == 0 && o->request.suites.count == 0) {
        pl_texts_add(&o->request.suites, "chaotic");
    }
    pl_status status = pl_request_add_engines(call, &o->request, plan, error);
    if (status == PL_OK) {
        status = pl_members_plan(&def, plan, ensembles, error);
    }
    return status == PL_OK ? pl_verdicts_possible(ensembles, error) : status;
}

static int core_count(void)
{
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : count > 1024 ? 1024 : (int)count;
}

static void free_options(options *o)
{
    for (int i = 0; i < o->other_count; ++i) {
        free(o->others[i].parts);
        free(o->others[i].settings.items);
    }
    free(o->others);
    free(o->against.items);
    pl_request_free(&o->request);
}

static pl_status check(void *user, pl_error *error)
{
    return pl_request_check(user, NULL, "every member", error);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default(), .members = 16};
    o.request.out = "ensemble";
    o.request.jobs = core_count();
    pl_call_parse(call, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    pl_ensembles ensembles = {.count = 0};
    int code = PL_EXIT_OK;
    pl_status status = pl_request_outputs(&o.request, NULL, &error);
    if (status == PL_OK) {
        status = make_plan(call, &o, &plan, &ensembles, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (ensembles.count == 0) {
        code = pl_call_nothing(call, "there is nothing to compare");
    } else {
        code = execute(call, &o, &plan, &ensembles);
    }
    pl_ensembles_free(&ensembles);
    pl_plan_free(&plan);
    free_options(&o);
    return code;
}

static const pl_option OPTIONS[] = {
    {"members", "N",
     "Members of each ensemble (default 16); so few that no difference could be significant are "
     "refused",
     PL_OPTION_INTEGER, .field = offsetof(options, members), .min = 2, .max = 1000},
    {"against", "SETTINGS",
     "Also run a second ensemble of each engine, with members of its own and with these scenario "
     "settings, NAME=VALUE[,...], or with the same ones, itself, and compare the two (repeatable)",
     PL_OPTION_PARSED, .parse = add_against},
    {"converged", NULL,
     "Also run each engine's own reference, NAME@converged: a 16th of the time step, and 8 "
     "times the iterations where the engine has that option",
     PL_OPTION_FLAG, .field = offsetof(options, converged)},
    {"keep-trajectories", NULL, "Keep the members' positions over time in DIR/trajectories",
     PL_OPTION_FLAG, .field = offsetof(options, keep)},
    {"suite", NULL,
     "All scenarios of a suite (repeatable; default chaotic when no scenario is named)",
     .kind = PL_OPTION_HELP},
    {"jobs", NULL, "Runs at a time (default: the number of cores)", .kind = PL_OPTION_HELP},
    {"out", NULL, "Where results and summary go (default ensemble)", .kind = PL_OPTION_HELP},
    {0}};

const pl_command pl_command_ensemble = {
    .name = "ensemble",
    .summary = "compare engines where motion is chaotic",
    .arguments = "[SCENARIO|SCENE.json...]",
    .description =
        "Compares engines where the motion is chaotic: each engine runs many members of the same "
        "scene, displaced by a ten-thousandth of a body's size, and the distributions of their end "
        "states are compared. Reports how long the members of an engine stay together, which "
        "engines differ and in which metrics, and which laws members broke. Each run is in a "
        "process of its own; an engine that crashes, hangs or fails is a row of the table, and the "
        "command still succeeds.",
    .notes =
        "Examples:\n"
        "  plumb ensemble --engine plumb --engine ode:quick --engine bullet:si\n"
        "  plumb ensemble pile --set n=60 --members 64 --converged --out pile-60\n"
        "  plumb ensemble wall-collapse --engine plumb --against friction=0.4 --against itself\n"
        "  plumb ensemble ./mine.json --engine ./mine.so:fast --json - | jq .comparisons",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_comparison_options,
               pl_jobs_options, pl_out_options},
    .check = check,
    .run = run};
