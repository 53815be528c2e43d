#include "threshold_search.h"

#include "runner/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct searches {
    const pl_threshold_search_def *def;
    pl_threshold_search *items;
    int count;
    pl_progress progress;
} searches;

int pl_threshold_param(const pl_scenario *scenario)
{
    int index = 0;
    while (strcmp(scenario->params[index].name, scenario->threshold->param) != 0) {
        index++;
    }
    return index;
}

const char *pl_threshold_outcome(const pl_threshold_search *search)
{
    static const char *const names[] = {[PL_BISECTION_SEARCHING] = "searching",
                                        [PL_BISECTION_FOUND] = "found",
                                        [PL_BISECTION_NEVER_HOLDS] = "never holds",
                                        [PL_BISECTION_ALWAYS_HOLDS] = "always holds",
                                        [PL_BISECTION_REVERSED] = "reversed"};
    return search->outcome[0] != '\0' ? search->outcome : names[search->bisection.state];
}

double pl_threshold_critical(const pl_plan *plan, const pl_threshold_search *search)
{
    const pl_case *problem = &plan->cases[search->problem];
    const pl_threshold *threshold = problem->descriptor->threshold;
    return threshold->critical == NULL ? (double)NAN : threshold->critical(problem->params);
}

static bool is_over(const pl_threshold_search *search)
{
    return search->outcome[0] != '\0' || search->bisection.state != PL_BISECTION_SEARCHING;
}

static pl_threshold_search *find_trial(const searches *s, const char *run)
{
    for (int i = 0; i < s->count; ++i) {
        if (s->items[i].run[0] != '\0' && strcmp(s->items[i].run, run) == 0) {
            return &s->items[i];
        }
    }
    return NULL;
}

/* The plan of a round has every value on every engine: those that no search asks for are skipped.
 */
static bool skip(void *user, const char *run)
{
    return find_trial(user, run) == NULL;
}

static void show_end(searches *s, const pl_threshold_search *search)
{
    const pl_plan *plan = s->def->plan;
    if (s->progress.terminal) {
        return;
    }
    fprintf(s->progress.out, "%s  %s  %s after %d %s\n", plan->problems[search->problem].name,
            plan->contenders[search->contender].label, pl_threshold_outcome(search), search->runs,
            search->runs == 1 ? "run" : "runs");
    fflush(s->progress.out);
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    (void)error;
    searches *s = user;
    pl_threshold_search *search = find_trial(s, pl_json_get_text(result, "run"));
    const char *outcome = pl_json_get_text(result, "outcome");
    bool holds = strcmp(outcome, "ok") == 0;
    search->runs++;
    search->run[0] = '\0';
    if (holds || strcmp(outcome, "collapsed") == 0) {
        pl_bisection_take(&search->bisection, holds);
    } else {
        snprintf(search->outcome, sizeof search->outcome, "%s", outcome);
        snprintf(search->reason, sizeof search->reason, "%s", pl_json_get_text(result, "reason"));
    }
    if (s->def->progress != NULL) {
        const pl_plan *plan = s->def->plan;
        char running[256];
        snprintf(running, sizeof running, "%s %s", plan->cases[search->problem].name,
                 plan->configurations[search->configuration].label);
        s->progress.done++;
        if (is_over(search)) {
            s->progress.total -= pl_bisection_most_trials(&search->bisection) - search->runs;
            show_end(s, search);
        }
        pl_progress_draw(&s->progress, running, 0, pl_monotonic_seconds());
    }
    return PL_OK;
}

/* The problem of a search at a value, added to the round; *index is where it is. */
static pl_status add_trial(pl_plan *round, const pl_case *problem, int param, double value,
                           int *index, pl_error *error)
{
    const pl_scenario *scenario = problem->descriptor;
    char texts[PL_MAX_PARAMS][PL_NAME_SIZE + 32];
    const char *settings[PL_MAX_PARAMS];
    for (int i = 0; i < scenario->param_count; ++i) {
        snprintf(texts[i], sizeof texts[i], "%s=%.17g", scenario->params[i].name,
                 i == param ? value : problem->params[i]);
        settings[i] = texts[i];
    }
    const int before = round->case_count;
    pl_status status =
        pl_plan_add_scenario(round, scenario, settings, scenario->param_count, error);
    if (status != PL_OK || round->case_count > before) {
        *index = before;
        return status;
    }
    for (int i = 0; i < before; ++i) {
        const pl_case *known = &round->cases[i];
        if (known->descriptor == scenario && known->params[param] == value) {
            *index = i;
            return PL_OK;
        }
    }
    return pl_fail(error, PL_FAILED, "%s: %s=%.17g gives the scene of another value",
                   scenario->name, scenario->params[param].name, value);
}

static pl_status name_trial(const pl_plan *round, int problem, pl_threshold_search *search,
                            pl_error *error)
{
    const pl_planned_run planned = {.test_case = &round->cases[problem],
                                    .configuration = &round->configurations[search->configuration]};
    json_t *identity = pl_planned_run_identity(round, &planned);
    if (identity == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for a run");
    }
    snprintf(search->run, sizeof search->run, "%s", pl_json_get_text(identity, "run"));
    json_decref(identity);
    return PL_OK;
}

/* One trial of every search that is not over; *any is false when there was none. */
static pl_status run_round(searches *s, bool *any, int *signal_number, pl_error *error)
{
    const pl_plan *plan = s->def->plan;
    pl_plan round = {.configurations = plan->configurations,
                     .configuration_count = plan->configuration_count,
                     .repeats = 1,
                     .seed = plan->seed};
    pl_status status = PL_OK;
    *any = false;
    for (int i = 0; i < s->count && status == PL_OK; ++i) {
        pl_threshold_search *search = &s->items[i];
        int index = 0;
        if (is_over(search)) {
            continue;
        }
        *any = true;
        search->value = pl_bisection_next(&search->bisection);
        status = add_trial(&round, &plan->cases[search->problem], search->param, search->value,
                           &index, error);
        if (status == PL_OK) {
            status = name_trial(&round, index, search, error);
        }
    }
    if (status == PL_OK && *any) {
        const pl_execution_def execution = {.plan = &round,
                                            .jobs = s->def->jobs,
                                            .limits = s->def->limits,
                                            .provenance = s->def->provenance,
                                            .user = s,
                                            .skip = skip,
                                            .keep = keep};
        status = pl_execute(&execution, signal_number, error);
    }
    round.configurations = NULL; /* the plan's */
    pl_plan_free(&round);
    return status;
}

static void begin(searches *s)
{
    const pl_plan *plan = s->def->plan;
    long total = 0;
    for (int p = 0; p < plan->case_count; ++p) {
        const pl_scenario *scenario = plan->cases[p].descriptor;
        const pl_threshold *t = scenario->threshold;
        for (int c = 0; c < plan->contender_count; ++c) {
            pl_threshold_search *search = &s->items[s->count++];
            *search = (pl_threshold_search){
                .problem = p,
                .configuration = c,
                .param = pl_threshold_param(scenario),
                .bisection = pl_bisection_begin(t->low, t->high, t->holds_below, t->tolerance)};
            total += pl_bisection_most_trials(&search->bisection);
        }
    }
    if (s->def->progress != NULL) {
        s->progress = pl_progress_begin(s->def->progress, total, pl_monotonic_seconds());
    }
}

pl_status pl_find_thresholds(const pl_threshold_search_def *def, pl_threshold_search **list,
                             int *count, int *signal_number, pl_error *error)
{
    searches s = {.def = def};
    size_t room = (size_t)def->plan->case_count * (size_t)def->plan->configuration_count;
    bool any = true;
    pl_status status = PL_OK;
    *signal_number = 0;
    *count = 0;
    *list = s.items = calloc(room + 1, sizeof *s.items);
    if (s.items == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu searches", room);
    }
    begin(&s);
    while (status == PL_OK && any && *signal_number == 0) {
        status = run_round(&s, &any, signal_number, error);
    }
    if (def->progress != NULL) {
        pl_progress_end(&s.progress);
    }
    *count = s.count;
    return status;
}
