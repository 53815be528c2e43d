/* plumb ensemble: engines compared where motion is chaotic, so that no single trajectory is right,
 * by the distributions of the end states of many runs from almost the same start. */
#include "base/heap.h"
#include "base/parallel.h"
#include "runner/positions.h"
#include "studies/ensemble/ensemble.h"
#include "studies/ensemble/verdict.h"
#include "study_command.h"

#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_request request;
    pl_texts against; /* other settings of the scenarios */
    int members;
    bool converged, keep;
    pl_ensembles ensembles;
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
    char *parts = pl_heap_copy(text);
    pl_texts settings = {.count = 0};
    const bool right = strcmp(text, ITSELF) == 0 || cut_settings(parts, &settings);
    pl_texts_add(&o->against, text);
    free(settings.items);
    free(parts);
    return right ? PL_OK
                 : pl_fail(error, PL_BAD_INPUT,
                           "--against takes NAME=VALUE[,NAME=VALUE]... or %s; found \"%s\"", ITSELF,
                           text);
}

/* The cases of a setting: those asked for, with the other setting's values last. */
static pl_status add_cases(void *user, int setting, pl_plan *plan, pl_error *error)
{
    const options *o = user;
    const char *text = setting > 0 ? o->against.items[setting - 1] : ITSELF;
    char *parts = pl_heap_copy(text);
    pl_request request = o->request;
    request.others_option = "--against";
    if (strcmp(text, ITSELF) != 0) {
        cut_settings(parts, &request.others);
    }
    const pl_status status = pl_request_add_cases(&request, plan, error);
    free(request.others.items);
    free(parts);
    return status;
}

static char *trajectories_of(const options *o)
{
    return pl_heap_format("%s/trajectories", o->request.out);
}

static pl_status make_runs(void *user, pl_execution_def *how, int *signal_number, pl_error *error)
{
    const options *o = user;
    char *trajectories = trajectories_of(o);
    how->positions = trajectories;
    pl_status status = pl_make_directories(trajectories, error);
    if (status == PL_OK) {
        status = pl_ensemble_run(&o->ensembles, how, signal_number, error);
    }
    free(trajectories);
    return status;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the type is that of a study */
static pl_status finish(void *user, const json_t *conclusion, int *code, pl_error *error)
{
    const options *o = user;
    char *trajectories = trajectories_of(o);
    (void)conclusion;
    (void)code;
    (void)error;
    if (!o->keep) {
        pl_positions_clear(trajectories);
    }
    free(trajectories);
    return PL_OK;
}

static pl_status make_plan(void *user, const pl_call *call, pl_plan *plan, pl_error *error)
{
    options *o = user;
    const pl_members_def def = {.members = o->members,
                                .setting_count = o->against.count,
                                .references = o->converged,
                                .user = o,
                                .add = add_cases};
    if (o->request.names.count == 0 && o->request.suites.count == 0) {
        pl_texts_add(&o->request.suites, "chaotic");
    }
    pl_status status = pl_request_add_engines(call, &o->request, plan, error);
    if (status == PL_OK) {
        status = pl_members_plan(&def, plan, &o->ensembles, error);
    }
    if (status == PL_OK) {
        pl_ensemble_mark(&o->ensembles, o->against.items, plan);
        status = pl_verdicts_possible(&o->ensembles, error);
    }
    return status;
}

static pl_status check(void *user, pl_error *error)
{
    return pl_request_check(user, NULL, "every member", error);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default(), .members = 16};
    const pl_study_work work = {.study = &pl_ensemble_study,
                                .options = &o,
                                .plan = make_plan,
                                .run = make_runs,
                                .finish = finish};
    o.request.jobs = pl_usable_cpus();
    const int code = pl_study_main(call, &work);
    free(o.ensembles.items);
    free(o.against.items);
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
    {"out", NULL, "Where results and page go (default ensemble)", .kind = PL_OPTION_HELP},
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
