#include "threshold.h"

#include "runner/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

pl_bisection pl_bisection_begin(double low, double high, bool holds_below, double tolerance)
{
    return (pl_bisection){
        .low = low, .high = high, .tolerance = tolerance, .holds_below = holds_below};
}

static double middle_of(const pl_bisection *b)
{
    return b->low + (b->high - b->low) / 2;
}

double pl_bisection_next(const pl_bisection *b)
{
    return b->trials == 0 ? b->low : b->trials == 1 ? b->high : middle_of(b);
}

/* A bracket of two neighbouring numbers has no middle. */
static bool is_narrow(const pl_bisection *b)
{
    double middle = middle_of(b);
    return b->high - b->low <= b->tolerance || middle <= b->low || middle >= b->high;
}

static void judge_ends(pl_bisection *b, bool high_holds)
{
    if (b->low_holds == high_holds) {
        b->state = high_holds ? PL_BISECTION_ALWAYS_HOLDS : PL_BISECTION_NEVER_HOLDS;
    } else if (b->low_holds != b->holds_below) {
        b->state = PL_BISECTION_REVERSED;
    }
}

void pl_bisection_take(pl_bisection *b, bool holds)
{
    if (b->trials == 0) {
        b->low_holds = holds;
    } else if (b->trials == 1) {
        judge_ends(b, holds);
    } else {
        *(holds == b->holds_below ? &b->low : &b->high) = middle_of(b);
    }
    b->trials++;
    if (b->trials >= 2 && b->state == PL_BISECTION_SEARCHING && is_narrow(b)) {
        b->state = PL_BISECTION_FOUND;
    }
}

int pl_bisection_most_trials(const pl_bisection *bisection)
{
    int trials = 2;
    for (double width = bisection->high - bisection->low;
         width > bisection->tolerance && trials < 1100; width /= 2) {
        trials++;
    }
    return trials;
}

typedef struct study {
    const pl_threshold_search_def *def;
    pl_threshold_search *items;
    int count;
    pl_progress progress;
} study;

/* The scenario's index of its threshold's parameter. */
static int pl_threshold_param(const pl_scenario *scenario)
{
    int index = 0;
    while (strcmp(scenario->params[index].name, scenario->threshold->param) != 0) {
        index++;
    }
    return index;
}

/* "found", "never holds", "always holds", "reversed", the outcome that ended it, or "searching". */
static const char *pl_threshold_outcome(const pl_threshold_search *search)
{
    static const char *const names[] = {[PL_BISECTION_SEARCHING] = "searching",
                                        [PL_BISECTION_FOUND] = "found",
                                        [PL_BISECTION_NEVER_HOLDS] = "never holds",
                                        [PL_BISECTION_ALWAYS_HOLDS] = "always holds",
                                        [PL_BISECTION_REVERSED] = "reversed"};
    return search->outcome[0] != '\0' ? search->outcome : names[search->bisection.state];
}

/* The closed form for the case's parameters; NAN: there is none. */
static double pl_threshold_critical(const pl_plan *plan, const pl_threshold_search *search)
{
    const pl_case *test_case = &plan->cases[search->test_case];
    const pl_threshold *threshold = test_case->descriptor->threshold;
    return threshold->critical == NULL ? (double)NAN : threshold->critical(test_case->params);
}

static bool is_over(const pl_threshold_search *search)
{
    return search->outcome[0] != '\0' || search->bisection.state != PL_BISECTION_SEARCHING;
}

static pl_threshold_search *find_trial(const study *s, const char *run)
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

static void show_end(study *s, const pl_threshold_search *search)
{
    const pl_plan *plan = s->def->plan;
    if (s->progress.terminal) {
        return;
    }
    fprintf(s->progress.out, "%s  %s  %s after %d %s\n", plan->cases[search->test_case].name,
            plan->configurations[search->configuration].label, pl_threshold_outcome(search),
            search->runs, search->runs == 1 ? "run" : "runs");
    fflush(s->progress.out);
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    (void)error;
    study *s = user;
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
        snprintf(running, sizeof running, "%s %s", plan->cases[search->test_case].name,
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

/* The case of a search at a value, added to the round; *index is where it is. */
static pl_status add_trial(pl_plan *round, const pl_case *test_case, int param, double value,
                           int *index, pl_error *error)
{
    const pl_scenario *scenario = test_case->descriptor;
    char texts[PL_MAX_PARAMS][PL_NAME_SIZE + 32];
    const char *settings[PL_MAX_PARAMS];
    for (int i = 0; i < scenario->param_count; ++i) {
        snprintf(texts[i], sizeof texts[i], "%s=%.17g", scenario->params[i].name,
                 i == param ? value : test_case->params[i]);
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

static pl_status name_trial(const pl_plan *round, int test_case, pl_threshold_search *search,
                            pl_error *error)
{
    const pl_planned_run planned = {.test_case = &round->cases[test_case],
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
static pl_status run_round(study *s, bool *any, int *signal_number, pl_error *error)
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
        status = add_trial(&round, &plan->cases[search->test_case], search->param,
                           pl_bisection_next(&search->bisection), &index, error);
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

static void begin(study *s)
{
    const pl_plan *plan = s->def->plan;
    long total = 0;
    for (int p = 0; p < plan->case_count; ++p) {
        const pl_scenario *scenario = plan->cases[p].descriptor;
        const pl_threshold *t = scenario->threshold;
        for (int c = 0; c < plan->configuration_count; ++c) {
            pl_threshold_search *search = &s->items[s->count++];
            *search = (pl_threshold_search){
                .test_case = p,
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
    study s = {.def = def};
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

/* The middle of the bracket; NAN unless the value was found. */
static double value_of(const pl_threshold_search *search)
{
    const pl_bisection *b = &search->bisection;
    bool found = search->outcome[0] == '\0' && b->state == PL_BISECTION_FOUND;
    return found ? b->low + (b->high - b->low) / 2 : (double)NAN;
}

static json_t *number(double value)
{
    return pl_json_number_or_null(value);
}

/* The keys of a run's identity that also hold for a search. */
static json_t *identity_of(const pl_plan *plan, const pl_threshold_search *search)
{
    static const char *const of_one_run[] = {"run", "repeat", "scene_hash"};
    const pl_planned_run planned = {.test_case = &plan->cases[search->test_case],
                                    .configuration = &plan->configurations[search->configuration]};
    json_t *identity = pl_planned_run_identity(plan, &planned);
    for (size_t i = 0; identity != NULL && i < sizeof of_one_run / sizeof of_one_run[0]; ++i) {
        json_object_del(identity, of_one_run[i]);
    }
    const pl_scenario *scenario = planned.test_case->descriptor;
    json_object_del(json_object_get(identity, "params"), scenario->threshold->param);
    return identity;
}

json_t *pl_threshold_json(const pl_plan *plan, const pl_threshold_search *search,
                          json_t *provenance, const char *started)
{
    const pl_scenario *scenario = plan->cases[search->test_case].descriptor;
    const pl_threshold *t = scenario->threshold;
    const double value = value_of(search), critical = pl_threshold_critical(plan, search);
    const double low = isnan(value) ? value : search->bisection.low;
    const double high = isnan(value) ? value : search->bisection.high;
    const char *reason = search->reason[0] != '\0' ? search->reason : NULL;
    json_t *row = identity_of(plan, search);
    json_t *found = json_pack(
        "{s:s, s:s, s:s, s:s, s:s?, s:o, s:[o,o], s:[f,f], s:b, s:f, s:o, s:s?, s:o, s:o, s:i, "
        "s:s}",
        "schema", "plumb.threshold/1", "param", t->param, "unit",
        scenario->params[search->param].unit, "finding", pl_threshold_outcome(search), "reason",
        reason, "value", number(value), "bracket", number(low), number(high), "searched", t->low,
        t->high, "holds_below", (int)t->holds_below, "tolerance", t->tolerance, "closed_form",
        number(critical), "formula", t->formula, "error", number(value - critical),
        "relative_error", number((value - critical) / critical), "runs", search->runs, "started",
        started);
    if (row == NULL || found == NULL || json_object_update(row, found) != 0 ||
        json_object_update(row, provenance) != 0) {
        json_decref(row);
        row = NULL;
    }
    json_decref(found);
    return row;
}

static void print_head(FILE *out, const pl_plan *plan, const pl_threshold_search *search, int width)
{
    const pl_scenario *scenario = plan->cases[search->test_case].descriptor;
    const pl_threshold *t = scenario->threshold;
    const pl_param *param = &scenario->params[search->param];
    const bool plain = strcmp(param->unit, "1") == 0;
    const double critical = pl_threshold_critical(plan, search);
    fprintf(out, "%s: critical %s%s%s, searched from %g to %g, holds %s it\n", scenario->name,
            t->param, plain ? "" : ", ", plain ? "" : param->unit, t->low, t->high,
            t->holds_below ? "below" : "above");
    if (isnan(critical)) {
        fprintf(out, "  no closed form\n");
    } else {
        fprintf(out, "  closed form: %.9g = %s\n", critical, t->formula);
    }
    fprintf(out, "  %-*s %14s %10s %12s %12s %5s\n", width, "engine", "value", "+-", "error",
            "relative", "runs");
}

static void print_row(FILE *out, const pl_plan *plan, const pl_threshold_search *search, int width)
{
    const double value = value_of(search), critical = pl_threshold_critical(plan, search);
    fprintf(out, "  %-*s ", width, plan->configurations[search->configuration].label);
    if (isnan(value)) {
        fprintf(out, "%s", pl_threshold_outcome(search));
        if (search->reason[0] != '\0') {
            fprintf(out, ": %s", search->reason);
        }
        fprintf(out, " (%d %s)\n", search->runs, search->runs == 1 ? "run" : "runs");
        return;
    }
    fprintf(out, "%14.9g %10.2g", value, (search->bisection.high - search->bisection.low) / 2);
    if (isnan(critical)) {
        fprintf(out, " %12s %12s", "-", "-");
    } else {
        fprintf(out, " %12.2e %12.2e", value - critical, (value - critical) / critical);
    }
    fprintf(out, " %5d\n", search->runs);
}

void pl_threshold_print(FILE *out, const pl_plan *plan, const pl_threshold_search *searches,
                        int count)
{
    int width = (int)strlen("engine"), test_case = -1;
    for (int i = 0; i < plan->configuration_count; ++i) {
        int length = (int)strlen(plan->configurations[i].label);
        width = length > width ? length : width;
    }
    for (int i = 0; i < count; ++i) {
        if (searches[i].test_case != test_case) {
            test_case = searches[i].test_case;
            fprintf(out, "%s", i == 0 ? "" : "\n");
            print_head(out, plan, &searches[i], width);
        }
        print_row(out, plan, &searches[i], width);
    }
}
