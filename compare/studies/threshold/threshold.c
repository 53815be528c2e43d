/* Bisection of critical values by rounds of isolated runs; text and JSON output. */
#include "threshold.h"

#include "base/folding.h"
#include "base/table.h"
#include "runner/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

pl_bisection pl_bisection_begin(const pl_threshold *threshold)
{
    return (pl_bisection){.low = threshold->low,
                          .high = threshold->high,
                          .tolerance = threshold->tolerance,
                          .holds_below = threshold->holds_below,
                          .either_side = threshold->either_side};
}

static double midpoint_of(const pl_bisection *b)
{
    return b->low + (b->high - b->low) / 2;
}

double pl_bisection_next(const pl_bisection *b)
{
    return b->trials == 0 ? b->low : b->trials == 1 ? b->high : midpoint_of(b);
}

/* A bracket of two neighbouring numbers has no midpoint. */
static bool is_narrow(const pl_bisection *b)
{
    double midpoint = midpoint_of(b);
    return b->high - b->low <= b->tolerance || midpoint <= b->low || midpoint >= b->high;
}

static void judge_ends(pl_bisection *b, bool high_holds)
{
    if (b->low_holds == high_holds) {
        b->state = high_holds ? PL_BISECTION_ALWAYS_HOLDS : PL_BISECTION_NEVER_HOLDS;
    } else if (b->either_side) {
        b->holds_below = b->low_holds;
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
        *(holds == b->holds_below ? &b->low : &b->high) = midpoint_of(b);
    }
    ++b->trials;
    if (b->trials >= 2 && b->state == PL_BISECTION_SEARCHING && is_narrow(b)) {
        b->state = PL_BISECTION_FOUND;
    }
}

int pl_bisection_most_trials(const pl_bisection *bisection)
{
    int trials = 2;
    for (double width = bisection->high - bisection->low;
         width > bisection->tolerance && trials < 1100; width /= 2) {
        ++trials;
    }
    return trials;
}

typedef struct study {
    const pl_threshold_search_def *def;
    pl_threshold_search *items;
    int count;
    pl_progress progress;
} study;

/* "found", "never holds", "always holds", "reversed", the outcome that ended it, or "searching". */
static const char *outcome_of(const pl_threshold_search *search)
{
    static const char *const names[] = {[PL_BISECTION_SEARCHING] = "searching",
                                        [PL_BISECTION_FOUND] = "found",
                                        [PL_BISECTION_NEVER_HOLDS] = "never holds",
                                        [PL_BISECTION_ALWAYS_HOLDS] = "always holds",
                                        [PL_BISECTION_REVERSED] = "reversed"};
    return search->outcome[0] != '\0' ? search->outcome : names[search->bisection.state];
}

/* The closed form for the case's parameters; NAN: there is none. */
static double critical_value(const pl_plan *plan, const pl_threshold_search *search)
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

/* Skips the runs of a round that no search needs: its plan has every value on every engine. */
static bool skip(void *user, const char *run)
{
    return find_trial(user, run) == NULL;
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    (void)error;
    study *s = user;
    pl_threshold_search *search = find_trial(s, pl_json_get_text(result, "run"));
    const char *outcome = pl_json_get_text(result, "outcome");
    bool holds = strcmp(outcome, "ok") == 0;
    ++search->runs;
    search->run[0] = '\0';
    if (holds || strcmp(outcome, "collapsed") == 0) {
        pl_bisection_take(&search->bisection, holds);
    } else {
        snprintf(search->outcome, sizeof search->outcome, "%s", outcome);
        snprintf(search->reason, sizeof search->reason, "%s", pl_json_get_text(result, "reason"));
    }
    if (s->def->progress != NULL) {
        const char *name = s->def->plan->cases[search->test_case].name;
        const char *label = s->def->plan->configurations[search->configuration].label;
        char running[256];
        snprintf(running, sizeof running, "%s %.200s", name, label);
        ++s->progress.done;
        if (is_over(search)) {
            s->progress.total -= pl_bisection_most_trials(&search->bisection) - search->runs;
            if (!s->progress.terminal) {
                pl_print_line(s->progress.out, "%s  %s  %s after %d %s", name, label,
                              outcome_of(search), search->runs, search->runs == 1 ? "run" : "runs");
                fflush(s->progress.out);
            }
        }
        pl_progress_draw(&s->progress, running, 0, pl_monotonic_seconds());
    }
    return PL_OK;
}

/* Adds the case of a search at its next value to the round, and names the run of its trial. */
static pl_status add_trial(pl_plan *round, const pl_case *test_case, pl_threshold_search *search,
                           pl_error *error)
{
    const pl_scenario *scenario = test_case->descriptor;
    double values[PL_MAX_PARAMS];
    int index = -1;
    memcpy(values, test_case->params, sizeof values);
    values[search->param] = pl_bisection_next(&search->bisection);
    pl_status status = pl_plan_add_values(round, scenario, values, &index, error);
    if (status != PL_OK) {
        return status;
    }
    if (index < 0) {
        return pl_fail(error, PL_FAILED, "%s: %s=%.17g gives the scene of another value",
                       scenario->name, scenario->params[search->param].name, values[search->param]);
    }
    const pl_planned_run planned = {.test_case = &round->cases[index],
                                    .configuration = &round->configurations[search->configuration]};
    return pl_planned_run_hash(round, &planned, search->run, error);
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
        if (!is_over(search)) {
            *any = true;
            status = add_trial(&round, &plan->cases[search->test_case], search, error);
        }
    }
    if (status == PL_OK && *any) {
        const pl_execution_def execution = {.plan = &round,
                                            .jobs = s->def->jobs,
                                            .limits = s->def->limits,
                                            .provenance = s->def->provenance,
                                            .journal = s->def->journal,
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
        for (int c = 0; c < plan->configuration_count; ++c) {
            pl_threshold_search *search = &s->items[s->count++];
            *search = (pl_threshold_search){
                .test_case = p,
                .configuration = c,
                .param = pl_scenario_param(scenario, scenario->threshold->param),
                .bisection = pl_bisection_begin(scenario->threshold)};
            total += pl_bisection_most_trials(&search->bisection);
        }
    }
    if (s->def->progress != NULL) {
        s->progress = pl_progress_begin(s->def->progress, total, pl_monotonic_seconds());
    }
}

pl_status pl_find_thresholds(const pl_threshold_search_def *def, pl_threshold_search **searches,
                             int *count, int *signal_number, pl_error *error)
{
    study s = {.def = def};
    size_t room = (size_t)def->plan->case_count * (size_t)def->plan->configuration_count;
    bool any = true;
    pl_status status = PL_OK;
    *signal_number = 0;
    *count = 0;
    *searches = s.items = calloc(room + 1, sizeof *s.items);
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

/* The midpoint of the bracket; NAN unless the value was found. */
static double value_of(const pl_threshold_search *search)
{
    const pl_bisection *b = &search->bisection;
    bool found = search->outcome[0] == '\0' && b->state == PL_BISECTION_FOUND;
    return found ? midpoint_of(b) : (double)NAN;
}

/* The side of the critical value on which the scene holds, as a word; NULL: not known. */
static const char *side_of(const pl_threshold_search *search)
{
    const pl_bisection *b = &search->bisection;
    const bool is_known = !b->either_side || b->state == PL_BISECTION_FOUND;
    return !is_known ? NULL : b->holds_below ? "below" : "above";
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
    const double value = value_of(search), critical = critical_value(plan, search);
    const double low = isnan(value) ? value : search->bisection.low;
    const double high = isnan(value) ? value : search->bisection.high;
    const char *reason = search->reason[0] != '\0' ? search->reason : NULL;
    json_t *row = identity_of(plan, search);
    json_t *found = json_pack(
        "{s:s, s:s, s:s, s:s, s:s?, s:o, s:[o,o], s:[f,f], s:o, s:f, s:o, s:s?, s:o, s:o, s:i, "
        "s:s}",
        "schema", "plumb.threshold/1", "param", t->param, "unit",
        scenario->params[search->param].unit, "finding", outcome_of(search), "reason", reason,
        "value", number(value), "bracket", number(low), number(high), "searched", t->low, t->high,
        "holds_below",
        side_of(search) == NULL ? json_null() : json_boolean(search->bisection.holds_below),
        "tolerance", t->tolerance, "closed_form", number(critical), "formula", t->formula, "error",
        number(value - critical), "relative_error", number((value - critical) / critical), "runs",
        search->runs, "started", started);
    if (row == NULL || found == NULL || json_object_update(row, found) != 0 ||
        json_object_update(row, provenance) != 0) {
        json_decref(row);
        row = NULL;
    }
    json_decref(found);
    return row;
}

static void print_head(FILE *out, const pl_plan *plan, const pl_threshold_search *search)
{
    const pl_scenario *scenario = plan->cases[search->test_case].descriptor;
    const pl_threshold *t = scenario->threshold;
    const pl_param *param = &scenario->params[search->param];
    const bool plain = strcmp(param->unit, "1") == 0;
    const double critical = critical_value(plan, search);
    pl_folding folding;
    FILE *folded = pl_folding_begin(&folding, out);
    const char *side = side_of(search);
    fprintf(folded, "%s: critical %s%s%s, searched from %g to %g%s%s%s\n", scenario->name, t->param,
            plain ? "" : ", ", plain ? "" : param->unit, t->low, t->high,
            side == NULL ? "" : ", holds ", side == NULL ? "" : side, side == NULL ? "" : " it");
    if (isnan(critical)) {
        fprintf(folded, "  no closed form\n");
    } else {
        fprintf(folded, "  closed form: %.9g = %s\n", critical, t->formula);
    }
    pl_folding_end(&folding);
}

static void add_row(pl_table *table, const pl_plan *plan, const pl_threshold_search *search)
{
    const double value = value_of(search), critical = critical_value(plan, search);
    const double error = value - critical;
    pl_table_add(table, plan->configurations[search->configuration].label);
    if (isnan(value)) {
        const char *reason = search->reason;
        pl_text_buffer text = {0};
        pl_text_format(&text, "%s%s%s (%d %s)", outcome_of(search), reason[0] != '\0' ? ": " : "",
                       reason, search->runs, search->runs == 1 ? "run" : "runs");
        pl_table_add_span(table, text.failed ? "" : text.data);
        table->texts.failed |= text.failed;
        pl_text_free(&text);
        return;
    }
    pl_table_number(table, value, 9);
    pl_table_number(table, (search->bisection.high - search->bisection.low) / 2, 2);
    pl_table_format_cell(table, isnan(critical) ? "-" : "%.2e", error);
    pl_table_format_cell(table, isnan(critical) ? "-" : "%.2e", error / critical);
    pl_table_format_cell(table, "%d", search->runs);
}

void pl_threshold_print(FILE *out, const pl_plan *plan, const pl_threshold_search *searches,
                        int count)
{
    pl_table table = {.indent = 2};
    pl_table_columns(&table, "engine|>value|>±|>error|>relative|>runs");
    for (int i = 0; i < count; ++i) {
        add_row(&table, plan, &searches[i]);
    }
    for (int i = 0; i < count; i = table.last) {
        for (table.first = table.last = i;
             table.last < count && searches[table.last].test_case == searches[i].test_case;) {
            table.last += 1;
        }
        fprintf(out, "%s", i == 0 ? "" : "\n");
        print_head(out, plan, &searches[i]);
        pl_table_print(&table, out);
    }
    pl_table_free(&table);
}
