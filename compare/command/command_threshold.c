/* plumb threshold: the critical value of a scenario's parameter, bisected on every engine. */
#include "request.h"
#include "results/store.h"
#include "studies/threshold/threshold.h"

#include <stdlib.h>
#include <string.h>

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

/* A scenario that is named must have a threshold; those of suites need not. */
static pl_status check_names(const pl_request *request, pl_error *error)
{
    for (int i = 0; i < request->names.count; ++i) {
        const pl_scenario *scenario = pl_scenario_find(request->names.items[i], error);
        if (scenario == NULL) {
            return PL_BAD_INPUT;
        }
        if (scenario->threshold == NULL) {
            return fail_without(scenario->name, error);
        }
    }
    return PL_OK;
}

/* Leaves out the cases of suites that have no threshold. */
static pl_status keep_thresholds(pl_plan *plan, pl_error *error)
{
    int kept = 0;
    for (int i = 0; i < plan->case_count; ++i) {
        pl_case kept_case = plan->cases[i];
        if (kept_case.descriptor->threshold != NULL) {
            plan->cases[i] = plan->cases[kept];
            plan->cases[kept++] = kept_case;
        }
    }
    while (plan->case_count > kept) {
        pl_case *last = &plan->cases[--plan->case_count];
        free(last->name);
        pl_scene_free(&last->scene);
    }
    return kept > 0 ? PL_OK : fail_without("the suite", error);
}

/* The parameter that is searched for cannot be set. */
static pl_status check_settings(const pl_request *request, const pl_plan *plan, pl_error *error)
{
    for (int i = 0; i < plan->case_count; ++i) {
        const char *param = plan->cases[i].descriptor->threshold->param;
        for (int k = 0; k < request->settings.count; ++k) {
            const char *setting = request->settings.items[k];
            size_t length = strcspn(setting, "=");
            if (strlen(param) == length && strncmp(setting, param, length) == 0) {
                return pl_fail(error, PL_BAD_INPUT, "--set %s: %s is what is searched for in %s",
                               setting, param, plan->cases[i].name);
            }
        }
    }
    return PL_OK;
}

static pl_status add_cases(const pl_request *request, pl_plan *plan, pl_error *error)
{
    pl_status status = check_names(request, error);
    if (status == PL_OK) {
        status = pl_request_add_cases(request, plan, error);
    }
    if (status == PL_OK) {
        status = keep_thresholds(plan, error);
    }
    return status == PL_OK ? check_settings(request, plan, error) : status;
}

static pl_status write_lines(const char *path, const pl_plan *plan,
                             const pl_threshold_search *searches, int count, json_t *provenance,
                             const char *started, pl_error *error)
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

static bool all_unsupported(const pl_threshold_search *searches, int count)
{
    for (int i = 0; i < count; ++i) {
        if (strcmp(searches[i].outcome, "unsupported") != 0) {
            return false;
        }
    }
    return true;
}

static int search(const pl_call *call, const pl_request *request, const pl_plan *plan)
{
    pl_error error = {.message = ""};
    pl_threshold_search *searches = NULL;
    int count = 0, signal_number = 0, code = PL_EXIT_OK;
    char started[32];
    pl_timestamp(started);
    pl_journal *journal = NULL;
    json_t *provenance = pl_call_provenance(call, &error);
    pl_status status =
        provenance == NULL ? PL_NO_MEMORY : pl_request_journal(call, request, &journal, &error);
    const pl_threshold_search_def def = {.plan = plan,
                                         .jobs = request->jobs,
                                         .limits = request->limits,
                                         .provenance = provenance,
                                         .journal = journal,
                                         .progress = stderr};
    if (status == PL_OK) {
        status = pl_find_thresholds(&def, &searches, &count, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        code = all_unsupported(searches, count) ? PL_EXIT_NOTHING : PL_EXIT_OK;
        if (request->json != NULL) {
            status = write_lines(request->json, plan, searches, count, provenance, started, &error);
        }
        if (!pl_is_stdout(request->json)) {
            pl_threshold_print(stdout, plan, searches, count);
        }
    }
    free(searches);
    json_decref(provenance);
    return pl_call_end_study(call, journal, status, &error, signal_number, code);
}

static pl_status check(void *user, pl_error *error)
{
    return pl_request_check(user, "which scenario? plumb threshold SCENARIO, or --suite NAME", NULL,
                            error);
}

static int run(const pl_call *call)
{
    pl_request request = pl_request_default();
    pl_call_parse(call, &request);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    int code = PL_EXIT_OK;
    pl_status status = add_cases(&request, &plan, &error);
    if (status == PL_OK) {
        status = pl_request_add_engines(call, &request, &plan, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (plan.configuration_count == 0) {
        code = pl_call_nothing(call, "there is no engine to search on");
    } else {
        code = search(call, &request, &plan);
    }
    pl_plan_free(&plan);
    pl_request_free(&request);
    return code;
}

static const pl_option OPTIONS[] = {
    {"suite", NULL, "All scenarios of a suite that have a threshold (repeatable)",
     .kind = PL_OPTION_HELP},
    {"json", NULL, "Write a JSON object a line for each scenario and engine (- is standard output)",
     .kind = PL_OPTION_HELP},
    {"jobs", NULL, "Runs at a time, of different searches (default 1)", .kind = PL_OPTION_HELP},
    {0}};

const pl_command pl_command_threshold = {
    .name = "threshold",
    .summary = "bisect a scenario's critical value on engines",
    .arguments = "SCENARIO...",
    .description =
        "Bisects the critical value of a scenario's parameter on every engine: on one side of it "
        "the scene holds (outcome ok), on the other it does not (collapsed). Each trial is a run "
        "in "
        "a process of its own. An engine that holds at both ends of the search, or at neither, or "
        "that fails, is a row of the table; the command still succeeds.",
    .notes = "Examples:\n"
             "  plumb threshold slope-threshold --set friction=0.5\n"
             "  plumb threshold slope-threshold slope-tip --engine plumb --engine ode:quick\n"
             "  plumb threshold --suite hard --jobs 2 --json thresholds.jsonl",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_comparison_options,
               pl_jobs_options, pl_study_options},
    .check = check,
    .run = run};
