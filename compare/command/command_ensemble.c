/* plumb ensemble: engines compared where motion is chaotic, so that no single trajectory is right,
 * by the distributions of the end states of many runs from almost the same start. */
#include "base/array.h"
#include "base/heap.h"
#include "runner/positions.h"
#include "studies/ensemble/ensemble.h"
#include "studies/ensemble/verdict.h"
#include "study_command.h"

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
    other_setting added = {.parts = pl_heap_copy(text)};
    const bool right = strcmp(text, ITSELF) == 0 || cut_settings(added.parts, &added.settings);
    pl_texts_add(&o->against, text);
    pl_push(&o->others, &o->other_count, &added, sizeof added);
    return right ? PL_OK
                 : pl_fail(error, PL_BAD_INPUT,
                           "--against takes NAME=VALUE[,NAME=VALUE]... or %s; found \"%s\"", ITSELF,
                           text);
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

/* The plan, and where its trajectories go. */
typedef struct planned_work {
    pl_plan plan;
    pl_ensembles ensembles;
    char *trajectories;
} planned_work;

static pl_status make_runs(void *user, pl_execution_def *how, int *signal_number, pl_error *error)
{
    const planned_work *work = user;
    how->positions = work->trajectories;
    const pl_status status = pl_make_directories(work->trajectories, error);
    return status == PL_OK
               ? pl_ensemble_run(&work->plan, &work->ensembles, how, signal_number, error)
               : status;
}

/* Runs what is due and concludes. */
static int execute(const pl_call *call, const options *o, planned_work *planned)
{
    const pl_study_work work = {.study = &pl_ensemble_study, .user = planned, .run = make_runs};
    planned->trajectories = pl_heap_format("%s/trajectories", o->request.out);
    const int code = pl_study_command(call, &o->request, &work);
    if (!o->keep && (code == PL_EXIT_OK || code == PL_EXIT_NOTHING)) {
        pl_positions_clear(planned->trajectories);
    }
    free(planned->trajectories);
    return code;
}

static pl_status make_plan(const pl_call *call, options *o, pl_plan *plan, pl_ensembles *ensembles,
                           pl_error *error)
{
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
        status = pl_members_plan(&def, plan, ensembles, error);
    }
    if (status == PL_OK) {
        pl_ensemble_mark(ensembles, o->against.items, plan);
        status = pl_verdicts_possible(ensembles, error);
    }
    return status;
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
    planned_work planned = {.plan = {.repeats = 1}};
    int code = PL_EXIT_OK;
    pl_status status = make_plan(call, &o, &planned.plan, &planned.ensembles, &error);
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (planned.ensembles.count == 0) {
        code = pl_call_nothing(call, "there is nothing to compare");
    } else {
        code = execute(call, &o, &planned);
    }
    pl_ensembles_free(&planned.ensembles);
    pl_plan_free(&planned.plan);
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
