/* plumb tune: the cheapest settings of an engine that meet targets on scenarios. */
#include "commands.h"
#include "comparison.h"
#include "results/store.h"
#include "studies/tune/tune.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_BUDGET = 200, MOST_BUDGET = 100000 };

typedef struct options {
    pl_comparison comparison;
    pl_texts varied, fixed;
    pl_targets targets;
    int budget;
} options;

static const pl_comparison_help option_help = {
    .json = "Write all that was found as a JSON object too (- is standard output)",
    .jobs = "Runs at a time (default 1: runs side by side disturb each other's times)",
    .reader = "every run"};

enum { KEY_TARGET = 0x200, KEY_VARY, KEY_FIX, KEY_BUDGET, KEY_OUT };

static const struct argp_option argp_options[] = {
    {"target", KEY_TARGET, "METRIC<=VALUE", 0,
     "What every scenario must meet, <= or < (repeatable; see plumb list metrics)", 0},
    {"vary", KEY_VARY, "KEY=LOW..HIGH", 0,
     "The range of dt or of an option, in place of the one that is tuned over, or of an option "
     "that would not be tuned; numbers may be fractions (repeatable)",
     0},
    {"fix", KEY_FIX, "KEY=VALUE", 0, "Does not tune dt or that option (repeatable)", 0},
    {"budget", KEY_BUDGET, "N", 0,
     "Settings tried by the search, each on all scenarios (default 200); measuring and validating "
     "the answer comes after",
     0},
    {"out", KEY_OUT, "DIR", 0, "Where ENGINE.profile.json goes (default .)", 0},
    {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    pl_error error = {.message = ""};
    switch (key) {
    case ARGP_KEY_INIT:
        pl_comparison_init(&o->comparison, state);
        return 0;
    case KEY_TARGET:
        if (pl_target_add(&o->targets, text, &error) != PL_OK) {
            argp_error(state, "%s", error.message);
        }
        return 0;
    case KEY_VARY:
        pl_texts_add(&o->varied, text);
        return 0;
    case KEY_FIX:
        pl_texts_add(&o->fixed, text);
        return 0;
    case KEY_BUDGET:
        o->budget =
            (int)pl_option_integer(state, "--budget takes an integer", text, 1, MOST_BUDGET);
        return 0;
    case KEY_OUT:
        o->comparison.out = text;
        return 0;
    case ARGP_KEY_END:
        if (o->comparison.names.count == 0 && o->comparison.suites.count == 0) {
            argp_error(state, "which scenario? plumb tune SCENARIO --engine NAME --target ...");
        }
        if (o->comparison.engines.count != 1) {
            argp_error(state, "one engine is tuned at a time: --engine NAME[:PROFILE]");
        }
        if (o->targets.count == 0) {
            argp_error(state, "to what? --target 'reference_error<=1e-3'");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {
    {&pl_comparison_argp, 0, NULL, 0}, {&pl_comparison_jobs_argp, 0, NULL, 0}, {0}};

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "SCENARIO|SCENE.json...",
    .doc =
        "Finds the cheapest settings of an engine, its step among them, that meet a target on all "
        "scenarios and on the same scenarios changed a little; with two standard deviations of "
        "their errors to spare, if that can be had. Cost is the CPU time of the engine's steps a "
        "simulated second, over that of the settings as shipped at the scenarios' own step, the "
        "geometric mean over the scenarios. Options that --engine sets are not tuned. --seed is "
        "the search's too. Then judges the settings on changes that they were not tuned on."
        "\v"
        "Exit code 3 when no settings found meet the target. DIR/ENGINE.profile.json holds the "
        "settings; with PLUMB_PROFILES=FILE or --profiles FILE, --engine ENGINE:tuned is these. "
        "Its step is not part of it: give --dt.\n\n"
        "Examples:\n"
        "  plumb tune tower slope-stick --engine ode --target 'reference_error<=1e-3'\n"
        "  plumb tune wall --set rows=5 --engine bullet:si --target 'penetration_max<=1e-4' --fix "
        "dt=1/60",
    .children = children};

static pl_status save_profile(const options *o, const pl_tune_def *def, const pl_tuning *tuning,
                              pl_error *error)
{
    const char *directory = o->comparison.out == NULL ? "." : o->comparison.out;
    char *path = NULL;
    pl_status status = pl_make_directories(directory, error);
    json_t *profile = pl_tune_profile(def, tuning);
    if (profile == NULL ||
        asprintf(&path, "%s/%s.profile.json", directory, def->space->base.engine->name) < 0) {
        json_decref(profile);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the profile");
    }
    if (status == PL_OK) {
        status = pl_results_write_json(path, profile, error);
    }
    if (status == PL_OK) {
        fprintf(stderr, "plumb tune: %s: --engine %s:tuned --profiles %s\n", path,
                def->space->base.engine->name, path);
    }
    free(path);
    json_decref(profile);
    return status;
}

static pl_status write_findings(const options *o, const pl_tune_def *def, const pl_tuning *tuning,
                                pl_error *error)
{
    const char *json_path = o->comparison.json;
    pl_status status = PL_OK;
    if (json_path != NULL) {
        json_t *json = pl_tune_json(def, tuning);
        status = json == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory for %s", json_path)
                              : pl_results_write_json(json_path, json, error);
        json_decref(json);
    }
    if (json_path == NULL || strcmp(json_path, "-") != 0) {
        pl_tune_print(stdout, def, tuning);
    }
    return status == PL_OK && tuning->met ? save_profile(o, def, tuning, error) : status;
}

static int tune(const pl_call *call, const options *o, const pl_plan *plan,
                const pl_tune_space *space)
{
    pl_error error = {.message = ""};
    pl_tuning tuning = {.runs = 0};
    json_t *provenance = pl_provenance(call->program_argc, call->program_argv);
    const pl_tune_def def = {.plan = plan,
                             .dt = o->comparison.selection.dt,
                             .duration = o->comparison.selection.duration,
                             .space = space,
                             .targets = &o->targets,
                             .budget = o->budget,
                             .jobs = o->comparison.jobs,
                             .limits = o->comparison.limits,
                             .provenance = provenance,
                             .progress = stderr};
    pl_status status = provenance == NULL ? pl_fail(&error, PL_NO_MEMORY, "out of memory")
                                          : pl_tune(&def, &tuning, &error);
    int code = PL_EXIT_OK;
    if (status == PL_OK && tuning.signal_number == 0) {
        code = tuning.met ? PL_EXIT_OK : PL_EXIT_FAILED;
        status = write_findings(o, &def, &tuning, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
        code = status == PL_UNSUPPORTED ? PL_EXIT_NOTHING : code;
    } else if (tuning.signal_number != 0) {
        code = 128 + tuning.signal_number;
    }
    pl_tuning_free(&tuning);
    json_decref(provenance);
    return code;
}

int pl_command_tune(const pl_call *call)
{
    options o = {.comparison = pl_comparison_default(&option_help), .budget = DEFAULT_BUDGET};
    pl_call_parse(call, &argp, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    pl_tune_space space;
    int code = PL_EXIT_OK;
    pl_status status = PL_OK;
    if (!pl_search_has_nlopt()) {
        status = pl_fail(&error, PL_UNSUPPORTED,
                         "this build lacks NLopt: install libnlopt-dev and build again");
    }
    if (status == PL_OK) {
        status = pl_comparison_add_problems(&o.comparison, &plan, &error);
    }
    if (status == PL_OK) {
        status = pl_comparison_add_engines("plumb tune", &o.comparison, &plan, &error);
    }
    if (status == PL_OK && plan.configuration_count > 0) {
        status = pl_tune_space_make(&plan.configurations[0].choice, o.comparison.selection.dt,
                                    o.varied.items, o.varied.count, o.fixed.items, o.fixed.count,
                                    &space, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (plan.configuration_count == 0) {
        fprintf(stderr, "plumb tune: there is no engine to tune\n");
        code = PL_EXIT_NOTHING;
    } else {
        code = tune(call, &o, &plan, &space);
    }
    pl_plan_free(&plan);
    free(o.varied.items);
    free(o.fixed.items);
    pl_comparison_free(&o.comparison);
    return code;
}
