/* plumb tune: the cheapest settings of an engine that meet targets on scenarios. */
#include "base/folding.h"
#include "base/heap.h"
#include "results/store.h"
#include "studies/tune/tune.h"
#include "study_command.h"

#include <stdlib.h>

enum { DEFAULT_BUDGET = 200, MOST_BUDGET = 100000 };

typedef struct options {
    pl_request request;
    pl_texts varied, fixed;
    pl_targets targets;
    pl_tune_space space;
    pl_tune_def def;
    pl_study_work work;
    char *profile; /* path */
} options;

static pl_status parse_target(void *user, const char *text, pl_error *error)
{
    options *o = user;
    return pl_target_add(&o->targets, text, error);
}

static pl_status check(void *user, pl_error *error)
{
    const options *o = user;
    pl_status status = pl_request_check(
        &o->request, "which scenario? plumb tune SCENARIO --engine NAME --target ...", NULL, error);
    if (status == PL_OK && o->request.engines.count != 1) {
        return pl_fail(error, PL_BAD_INPUT,
                       "one engine is tuned at a time: --engine NAME[:PROFILE]");
    }
    if (status == PL_OK && o->targets.count == 0) {
        return pl_fail(error, PL_BAD_INPUT, "to what? --target 'reference_error<=1e-3'");
    }
    return status;
}

/* Plans what to tune. An engine that cannot be loaded has nothing to tune. */
static pl_status make_plan(void *user, const pl_call *call, pl_plan *plan, pl_error *error)
{
    options *o = user;
    const pl_status status = pl_request_plan(call, &o->request, plan, error);
    if (status != PL_OK || plan->configuration_count == 0) {
        return status;
    }
    const pl_engine_choice *choice = &plan->configurations[0].choice;
    const pl_tune_request asked = {.engine = choice,
                                   .dt = o->request.dt,
                                   .varied = o->varied.items,
                                   .varied_count = o->varied.count,
                                   .fixed = o->fixed.items,
                                   .fixed_count = o->fixed.count};
    o->def.plan = plan;
    o->profile = pl_heap_format("%s/%s.profile.json", o->request.out, choice->engine->name);
    o->work.output = o->profile;
    return choice->engine->fault.is_fault
               ? pl_fail(error, PL_IO, "%s: %s", choice->spec, choice->engine->fault.reason)
               : pl_tune_space_make(&asked, &o->space, error);
}

static pl_status make_runs(void *user, pl_execution_def *how, int *signal_number, pl_error *error)
{
    const options *o = user;
    return pl_tune_run(&o->def, how, signal_number, error);
}

/* Saves the settings that meet the targets as a profile. */
static pl_status finish(void *user, const json_t *conclusion, int *code, pl_error *error)
{
    const options *o = user;
    if (!json_is_true(json_object_get(conclusion, "met"))) {
        *code = PL_EXIT_FAILED;
        return PL_OK;
    }
    json_t *profile = pl_tune_profile(conclusion);
    const pl_status status = pl_results_write_json(o->profile, profile, error);
    json_decref(profile);
    if (status == PL_OK) {
        pl_print_line(stderr, "plumb tune: %s: --engine %s:tuned --profiles %s", o->profile,
                      o->space.base.engine->spec, o->profile);
    }
    return status;
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    o.def = (pl_tune_def){.space = &o.space, .targets = &o.targets, .budget = DEFAULT_BUDGET};
    o.work = (pl_study_work){.study = &pl_tune_study,
                             .user = &o,
                             .plan = make_plan,
                             .run = make_runs,
                             .finish = finish,
                             .nothing = "there is no engine to tune"};
    const int code = pl_study_main(call, &o.work);
    free(o.profile);
    free(o.varied.items);
    free(o.fixed.items);
    return code;
}

static const pl_option OPTIONS[] = {
    {"target", "METRIC<=VALUE",
     "What every scenario must meet, <= or < (repeatable; see plumb list metrics)",
     PL_OPTION_PARSED, .parse = parse_target},
    {"vary", "KEY=LOW..HIGH",
     "Tune dt or an option over this range instead of its default one, or tune an option that "
     "is not tuned otherwise; numbers may be fractions (repeatable)",
     PL_OPTION_TEXTS, .field = offsetof(options, varied), .values = "dt="},
    {"fix", "KEY=VALUE", "Do not tune dt or that option (repeatable)", PL_OPTION_TEXTS,
     .field = offsetof(options, fixed)},
    {"budget", "N",
     "Settings tried by the search, each on all scenarios (default 200); the best settings "
     "are measured and validated afterwards",
     PL_OPTION_INTEGER, .field = offsetof(options, def.budget), .min = 1, .max = MOST_BUDGET},
    {"json", NULL, "Write the conclusion as JSON (- is standard output, in place of text)",
     .kind = PL_OPTION_HELP},
    {"out", NULL, "Where the results, the page and ENGINE.profile.json go (default tune)",
     .kind = PL_OPTION_HELP},
    {0}};

const pl_command pl_command_tune = {
    .name = "tune",
    .summary = "find the cheapest settings that meet a target",
    .arguments = "SCENARIO|SCENE.json...",
    .description =
        "Finds the cheapest settings of an engine, its time step included, that meet a target on "
        "all scenarios and on slightly changed ones, with a margin of two standard deviations of "
        "the errors if possible. The cost is the CPU time of the engine's steps for a simulated "
        "second, divided by that of the default settings at the scenarios' own time step; the "
        "geometric mean over the scenarios counts. Options that --engine sets are not tuned. "
        "--seed "
        "also seeds the search. The settings are then validated on changed scenarios that they "
        "were "
        "not tuned on.",
    .notes =
        "Exits with 3 when no settings found meet the target. DIR/ENGINE.profile.json holds the "
        "settings; with PLUMB_PROFILES=FILE or --profiles FILE, --engine ENGINE:tuned selects "
        "them. The time step is not part of a profile: give --dt.\n\n"
        "Examples:\n"
        "  plumb tune tower slope-stick --engine ode --target 'reference_error<=1e-3'\n"
        "  plumb tune wall --set rows=5 --engine bullet:si --target 'penetration_max<=1e-4' "
        "--fix dt=1/60",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_comparison_options,
               pl_jobs_options, pl_out_options},
    .check = check,
    .run = run};
