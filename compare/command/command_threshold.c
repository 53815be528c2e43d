/* plumb threshold: the critical value of a scenario's parameter, bisected on every engine. */
#include "base/heap.h"
#include "studies/threshold/threshold.h"
#include "studies/vary.h"
#include "study_command.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_request request;
    pl_vary *varied; /* (varied_count) */
    int varied_count;
    double tolerance; /* of the parameter; NAN: the scenario's own, else 1e-5 of the range */
} options;

static pl_status add_vary(void *user, const char *text, pl_error *error)
{
    options *o = user;
    pl_vary vary;
    const pl_status status = pl_vary_parse(text, PL_VARY_KNOWN_RANGE, &vary, error);
    if (status == PL_OK) {
        pl_push(&o->varied, &o->varied_count, &vary, sizeof vary);
    }
    return status;
}

/* An error that says how to choose a parameter of the scenario; NULL: of those of a suite. */
static pl_status fail_without(const pl_scenario *scenario, pl_error *error)
{
    const bool is_file = scenario != NULL && scenario->file != NULL;
    pl_text_buffer names = {0};
    int count;
    const pl_scenario *const *all = pl_scenarios(&count);
    count = is_file ? scenario->param_count - 2 : count; /* without dt and duration */
    for (int i = 0; i < count; ++i) {
        if (is_file || all[i]->threshold != NULL) {
            pl_text_format(&names, "%s%s", names.length == 0 ? "" : ", ",
                           is_file ? scenario->params[i].name : all[i]->name);
        }
    }
    char *list = pl_text_take(&names);
    if (is_file && count == 0) {
        pl_fail(error, PL_BAD_INPUT, "%s has no parameters: give \"parameters\" in the file",
                scenario->name);
    } else if (is_file) {
        pl_fail(error, PL_BAD_INPUT, "%s: which parameter? --vary NAME=LOW..HIGH; the file has %s",
                scenario->name, list);
    } else {
        pl_fail(error, PL_BAD_INPUT,
                "%s has no threshold: choose a parameter by --vary NAME=LOW..HIGH; these have "
                "one: %s",
                scenario == NULL ? "the suite" : scenario->name, list);
    }
    free(list);
    return PL_BAD_INPUT;
}

/* ---- What is searched for ---- */

static bool has(const pl_scenario *scenario, const pl_vary *vary)
{
    return pl_vary_is_of(vary, scenario->name) && pl_scenario_param(scenario, vary->key) >= 0;
}

/* Takes the range from --vary, else from the threshold, else from the parameter. */
static pl_status find_range(const pl_scenario *scenario, const pl_vary *vary, pl_threshold *t,
                            pl_error *error)
{
    const pl_param *param = &scenario->params[pl_scenario_param(scenario, vary->key)];
    const bool is_given = isfinite(vary->low);
    t->low = is_given ? vary->low : isfinite(t->low) ? t->low : param->min;
    t->high = is_given ? vary->high : isfinite(t->high) ? t->high : param->max;
    if (!isfinite(t->low) || !isfinite(t->high)) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--vary %s: %s has no range there: write --vary %s=LOW..HIGH, or give it "
                       "\"low\" and \"high\" in %s",
                       param->name, param->name, param->name, scenario->name);
    }
    if (t->low < param->min || t->high > param->max || param->integer) {
        return pl_fail(error, PL_BAD_INPUT, "--vary %s: expected %s from %g to %g of %s%s",
                       param->name, param->name, param->min, param->max, scenario->name,
                       param->integer ? ", but it is a whole number" : "");
    }
    return PL_OK;
}

/* Sets what is searched for in a scenario; t->param stays NULL if there is nothing. */
static pl_status aim_at(const options *o, const pl_scenario *scenario, pl_threshold *t,
                        pl_error *error)
{
    const pl_threshold *own = scenario->threshold;
    const pl_vary *vary = NULL;
    for (int i = 0; i < o->varied_count; ++i) {
        if (has(scenario, &o->varied[i]) && vary != NULL) {
            return pl_fail(error, PL_BAD_INPUT, "--vary %s: %s has %s, too; one is searched for",
                           o->varied[i].key, scenario->name, vary->key);
        }
        vary = has(scenario, &o->varied[i]) ? &o->varied[i] : vary;
    }
    const bool is_own = own != NULL && (vary == NULL || strcmp(own->param, vary->key) == 0);
    *t = is_own ? *own
                : (pl_threshold){.param = vary == NULL ? NULL : vary->key,
                                 .low = (double)NAN,
                                 .high = (double)NAN,
                                 .either_side = true};
    const pl_status status = vary == NULL ? PL_OK : find_range(scenario, vary, t, error);
    t->tolerance = !isnan(o->tolerance) ? o->tolerance
                   : is_own             ? t->tolerance
                                        : 1e-5 * (t->high - t->low);
    return status;
}

/* ---- Cases ---- */

/* A scenario that is named must have something to search for; those of suites need not. */
static pl_status check_case(const pl_request *request, const pl_case *test_case,
                            const pl_threshold *t, pl_error *error)
{
    const pl_scenario *scenario = test_case->descriptor;
    for (int i = 0; i < request->names.count && t->param == NULL; ++i) {
        if (strcmp(request->names.items[i], test_case->name) == 0) {
            return fail_without(scenario, error);
        }
    }
    if (scenario->file != NULL && isinf(test_case->scene.collapse_distance)) {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s: expected a rest among what it expects, found none that can collapse: "
                       "a scene holds where its bodies stay within collapse_distance of their rest",
                       test_case->name);
    }
    for (int k = 0; t->param != NULL && k < request->settings.count; ++k) {
        const char *setting = request->settings.items[k];
        const size_t length = strcspn(setting, "=");
        if (strlen(t->param) == length && strncmp(setting, t->param, length) == 0) {
            return pl_fail(error, PL_BAD_INPUT, "--set %s: %s is what is searched for in %s",
                           setting, t->param, test_case->name);
        }
    }
    return PL_OK;
}

/* A --vary must be of a parameter that some case has. */
static pl_status check_vary(const pl_vary *vary, const pl_plan *plan, pl_error *error)
{
    char hint[PL_SUGGESTION_SIZE] = "";
    for (int p = 0; p < plan->case_count; ++p) {
        const pl_scenario *scenario = plan->cases[p].descriptor;
        const char *names[PL_MAX_PARAMS];
        for (int k = 0; k < scenario->param_count; ++k) {
            names[k] = scenario->params[k].name;
        }
        if (has(scenario, vary)) {
            return PL_OK;
        }
        if (hint[0] == '\0') {
            pl_did_you_mean(vary->key, names, scenario->param_count, hint);
        }
    }
    return pl_fail(error, PL_BAD_INPUT, "--vary: no chosen scenario has the parameter %s%s%s%s",
                   vary->owner, vary->owner[0] == '\0' ? "" : ".", vary->key, hint);
}

/* Gives each case that has something to search for its study. */
static pl_status aim(const options *o, pl_plan *plan, pl_error *error)
{
    bool any = false;
    pl_status status = PL_OK;
    for (int i = 0; i < o->varied_count && status == PL_OK; ++i) {
        status = check_vary(&o->varied[i], plan, error);
    }
    for (int i = 0; i < plan->case_count && status == PL_OK; ++i) {
        pl_case *test_case = &plan->cases[i];
        pl_threshold threshold;
        status = aim_at(o, test_case->descriptor, &threshold, error);
        if (status == PL_OK) {
            status = check_case(&o->request, test_case, &threshold, error);
        }
        if (status == PL_OK && threshold.param != NULL) {
            any = true;
            test_case->study =
                pl_threshold_study_of(test_case->descriptor, &threshold, test_case->params);
        }
    }
    return status != PL_OK || any ? status : fail_without(NULL, error);
}

static pl_status make_plan(void *user, const pl_call *call, pl_plan *plan, pl_error *error)
{
    const options *o = user;
    pl_status status = pl_request_add_cases(&o->request, plan, error);
    if (status == PL_OK) {
        status = aim(o, plan, error);
    }
    return status == PL_OK ? pl_request_add_engines(call, &o->request, plan, error) : status;
}

static pl_status make_runs(void *user, pl_execution_def *how, int *signal_number, pl_error *error)
{
    (void)user;
    return pl_threshold_run(how, signal_number, error);
}

static pl_status check(void *user, pl_error *error)
{
    return pl_request_check(
        user, "which scenario? plumb threshold SCENARIO|SCENE.json, or --suite NAME", NULL, error);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default(), .tolerance = (double)NAN};
    const pl_study_work work = {.study = &pl_threshold_study,
                                .options = &o,
                                .plan = make_plan,
                                .run = make_runs,
                                .nothing = "there is no engine to search on"};
    const int code = pl_study_main(call, &work);
    free(o.varied);
    return code;
}

static const pl_option OPTIONS[] = {
    {"vary", "NAME[=LOW..HIGH]",
     "Search for the critical value of this parameter, in that range; the range of the scenario's "
     "threshold, else that of the parameter (low and high in a scene file), need not be given; "
     "SCENARIO.NAME is of that one alone (repeatable: one for each scenario)",
     PL_OPTION_PARSED, .parse = add_vary, .values = "NAME=VALUE"},
    {"tolerance", "WIDTH",
     "Width of the bracket at which a search ends, in the unit of the parameter (default: that of "
     "the scenario's threshold, else 1e-5 of the range)",
     PL_OPTION_NUMBER, .field = offsetof(options, tolerance), .takes = "a width", .min = 1e-300,
     .max = 1e300},
    {"suite", NULL, "All scenarios of a suite that have a threshold (repeatable)",
     .kind = PL_OPTION_HELP},
    {"json", NULL,
     "Write an array of an object for each scenario and engine (- is standard output)",
     .kind = PL_OPTION_HELP},
    {"out", NULL, "Where results and page go (default threshold)", .kind = PL_OPTION_HELP},
    {"jobs", NULL, "Runs at a time, of different searches (default 1)", .kind = PL_OPTION_HELP},
    {0}};

const pl_command pl_command_threshold = {
    .name = "threshold",
    .summary = "bisect a scenario's critical value on engines",
    .arguments = "SCENARIO|SCENE.json...",
    .description =
        "Bisects the critical value of a parameter of a scenario or a scene file on every engine: "
        "on one side of it the scene holds (outcome ok), on the other it does not (collapsed). "
        "Each trial is a run in a process of its own. An engine that holds at both ends of the "
        "search, or at neither, or that fails, is a row of the table; the command still succeeds.",
    .notes = "Examples:\n"
             "  plumb threshold slope-threshold --set friction=0.5\n"
             "  plumb threshold slope-threshold slope-tip --engine plumb --engine ode:quick\n"
             "  plumb threshold ramp.json --vary mu=0.1..1 --engine plumb\n"
             "  plumb threshold --suite hard --jobs 2 --json thresholds.json",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_comparison_options,
               pl_jobs_options, pl_out_options},
    .check = check,
    .run = run};
