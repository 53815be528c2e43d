/* Bisection of critical values by rounds of isolated runs. */
#include "threshold.h"

#include "base/folding.h"
#include "base/heap.h"
#include "base/program_name.h"
#include "studies/bisection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

json_t *pl_threshold_study_of(const pl_scenario *scenario, const pl_threshold *threshold,
                              const double *params)
{
    const double critical = threshold->critical == NULL ? (double)NAN : threshold->critical(params);
    return json_pack("{s:s, s:s, s:s, s:f, s:f, s:f, s:b, s:b, s:o, s:s?}", "name", "threshold",
                     "param", threshold->param, "unit",
                     scenario->params[pl_scenario_param(scenario, threshold->param)].unit, "low",
                     threshold->low, "high", threshold->high, "tolerance", threshold->tolerance,
                     "holds_below", (int)threshold->holds_below, "either_side",
                     (int)threshold->either_side, "closed_form", pl_json_number_or_null(critical),
                     "formula", threshold->critical == NULL ? NULL : threshold->formula);
}

static double number_of(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static pl_bisection begin(const json_t *study)
{
    const pl_threshold threshold = {
        .low = number_of(study, "low"),
        .high = number_of(study, "high"),
        .tolerance = number_of(study, "tolerance"),
        .holds_below = json_is_true(json_object_get(study, "holds_below")),
        .either_side = json_is_true(json_object_get(study, "either_side"))};
    return pl_bisection_begin(&threshold);
}

/* ---- Running ---- */

/* The search of one case on one configuration. */
typedef struct search {
    int test_case, configuration; /* indices in the plan */
    int param;                    /* index of the searched parameter in the scenario's */
    pl_bisection bisection;
    int most; /* trials that it can take */
    bool is_over;
    char run[17]; /* hash of the trial in progress; empty: none */
} search;

typedef struct searches {
    const pl_plan *plan;
    search *items; /* (count), by case and then by configuration */
    int count, over;
    FILE *out; /* NULL: no progress is shown */
    pl_progress bar;
} searches;

/* Counts a search that is over. Where the bar cannot be drawn again, a line a trial would be hundreds of lines. */
static void show_end(searches *all, const search *s, const char *outcome)
{
    const int trials = s->bisection.trials;
    ++all->over;
    all->bar.total -= s->most - trials;
    if (all->out != NULL && !all->bar.terminal) {
        pl_print_line(all->out, "[%d/%d] %s  %s  %s", all->over, all->count,
                      all->plan->cases[s->test_case].name,
                      all->plan->configurations[s->configuration].label,
                      s->bisection.state == PL_BISECTION_SEARCHING ? outcome : "searched");
    }
}

/* A trial's outcome may belong to several searches: two labels of one engine. */
static pl_status take(void *user, json_t *result, pl_error *error)
{
    (void)error;
    searches *all = user;
    const char *run = pl_json_get_text(result, "run");
    const char *outcome = pl_json_get_text(result, "outcome");
    const bool holds = strcmp(outcome, "ok") == 0;
    for (int i = 0; i < all->count; ++i) {
        search *s = &all->items[i];
        if (strcmp(s->run, run) != 0) {
            continue;
        }
        s->run[0] = '\0';
        if (holds || strcmp(outcome, "collapsed") == 0) {
            pl_bisection_take(&s->bisection, holds);
        }
        s->is_over = s->bisection.state != PL_BISECTION_SEARCHING ||
                     (!holds && strcmp(outcome, "collapsed") != 0);
        if (s->is_over) {
            show_end(all, s, outcome);
        }
    }
    return PL_OK;
}

/* Adds the next trial of a search to the round. */
static pl_status add_trial(pl_plan *round, const pl_case *test_case, search *s, pl_error *error)
{
    const pl_scenario *scenario = test_case->descriptor;
    double values[PL_MAX_PARAMS];
    int index = -1;
    memcpy(values, test_case->params, sizeof values);
    values[s->param] = pl_bisection_next(&s->bisection);
    round->study = test_case->study;
    pl_status status = pl_plan_add_values(round, scenario, values, &index, error);
    if (status != PL_OK) {
        return status;
    }
    if (index < 0) {
        return pl_fail(error, PL_FAILED, "%s: %s=%.17g gives the scene of another value",
                       scenario->name, scenario->params[s->param].name, values[s->param]);
    }
    const pl_planned_run planned = {.test_case = &round->cases[index],
                                    .configuration = &round->configurations[s->configuration]};
    pl_plan_add_pairing(round, index, s->configuration);
    pl_planned_run_hash(round, &planned, s->run);
    return PL_OK;
}

/* One trial of every search that is not over; *any is false when there was none. */
static pl_status run_round(searches *all, const pl_execution_def *how, bool *any,
                           int *signal_number, pl_error *error)
{
    pl_plan round = {.configurations = all->plan->configurations,
                     .configuration_count = all->plan->configuration_count,
                     .repeats = 1,
                     .seed = all->plan->seed};
    pl_status status = PL_OK;
    *any = false;
    for (int i = 0; i < all->count && status == PL_OK; ++i) {
        search *s = &all->items[i];
        if (!s->is_over) {
            *any = true;
            status = add_trial(&round, &all->plan->cases[s->test_case], s, error);
        }
    }
    if (status == PL_OK && *any) {
        pl_execution_def execution = *how;
        execution.plan = &round;
        execution.progress = NULL;
        execution.bar = all->bar.terminal ? &all->bar : NULL;
        execution.user = all;
        execution.take = take;
        status = pl_execute(&execution, signal_number, error);
    }
    round.configurations = NULL; /* the plan's */
    pl_plan_free(&round);
    return status;
}

pl_status pl_threshold_run(const pl_plan *plan, const pl_execution_def *how, int *signal_number,
                           pl_error *error)
{
    searches all = {.plan = plan, .out = how->progress};
    long total = 0;
    bool any = true;
    for (int i = 0; i < plan->case_count * plan->configuration_count; ++i) {
        const pl_case *test_case = &plan->cases[i / plan->configuration_count];
        search added = {.test_case = i / plan->configuration_count,
                        .configuration = i % plan->configuration_count,
                        .param = pl_scenario_param(test_case->descriptor,
                                                   pl_json_get_text(test_case->study, "param")),
                        .bisection = begin(test_case->study)};
        added.most = pl_bisection_most_trials(&added.bisection);
        total += added.most;
        pl_push(&all.items, &all.count, &added, sizeof added);
    }
    if (how->progress != NULL) {
        all.bar = pl_progress_begin(how->progress, total, pl_monotonic_seconds());
    }
    pl_status status = PL_OK;
    while (status == PL_OK && any && *signal_number == 0) {
        status = run_round(&all, how, &any, signal_number, error);
    }
    if (how->progress != NULL) {
        pl_progress_end(&all.bar);
    }
    free(all.items);
    return status;
}

/* ---- Concluding ---- */

/* What the trials of one search have in common. */
static char *key_of(const json_t *result)
{
    static const char *const same[] = {"scenario", "engine", "engine_binary", "profile",
                                       "label",    "seed",   "study"};
    json_t *key = json_array();
    json_t *params = json_copy(json_object_get(result, "params"));
    const json_t *study = json_object_get(result, "study");
    json_object_del(params, pl_json_get_text(study, "param"));
    json_array_append_new(key, params);
    for (size_t i = 0; i < sizeof same / sizeof same[0]; ++i) {
        json_array_append(key, json_object_get(result, same[i]));
    }
    char *text = pl_result_to_line(key);
    json_decref(key);
    return text;
}

/* The trial at a value; NULL: it was not made. */
static const json_t *find_trial(const json_t *trials, const char *param, double value)
{
    size_t index;
    const json_t *trial;
    json_array_foreach((json_t *)trials, index, trial)
    {
        if (number_of(json_object_get(trial, "params"), param) == value) {
            return trial;
        }
    }
    return NULL;
}

/* Searches again, in the trials that were made. *ended is the trial whose outcome ended the search, neither ok nor
 * collapsed; NULL: none. */
static pl_bisection repeat_search(const json_t *trials, const json_t *study, int *runs,
                                  const json_t **ended)
{
    pl_bisection bisection = begin(study);
    *ended = NULL;
    *runs = 0;
    while (bisection.state == PL_BISECTION_SEARCHING) {
        const json_t *trial =
            find_trial(trials, pl_json_get_text(study, "param"), pl_bisection_next(&bisection));
        if (trial == NULL) {
            break;
        }
        const char *outcome = pl_json_get_text(trial, "outcome");
        const bool holds = strcmp(outcome, "ok") == 0;
        ++*runs;
        if (!holds && strcmp(outcome, "collapsed") != 0) {
            *ended = trial;
            break;
        }
        pl_bisection_take(&bisection, holds);
    }
    return bisection;
}

/* The keys of a trial that also hold for its search. */
static json_t *identity_of(const json_t *trial, const char *param)
{
    static const char *const kept[] = {
        "scenario", "engine",         "engine_version", "engine_binary", "engine_spec",
        "profile",  "engine_runtime", "threads",        "as_shipped",    "label",
        "settings", "seed",           "primary_error",  "acceptance",    "conformance",
        "host",     PL_PROGRAM,       "command",        "started"};
    json_t *row = json_object();
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; ++i) {
        json_t *value = json_object_get(trial, kept[i]);
        if (value != NULL) {
            json_object_set(row, kept[i], value);
        }
    }
    json_t *params = json_copy(json_object_get(trial, "params"));
    json_object_del(params, param);
    json_object_set_new(row, "params", params);
    return row;
}

/* "found", "never holds", "always holds", "reversed", the outcome that ended it, or "searching". */
static const char *finding_of(const pl_bisection *bisection, const json_t *ended)
{
    static const char *const names[] = {[PL_BISECTION_SEARCHING] = "searching",
                                        [PL_BISECTION_FOUND] = "found",
                                        [PL_BISECTION_NEVER_HOLDS] = "never holds",
                                        [PL_BISECTION_ALWAYS_HOLDS] = "always holds",
                                        [PL_BISECTION_REVERSED] = "reversed"};
    return ended != NULL ? pl_json_get_text(ended, "outcome") : names[bisection->state];
}

/* plumb.threshold/1 of the trials of one search. */
static json_t *conclude_search(const json_t *trials)
{
    const json_t *first = json_array_get(trials, 0), *ended = NULL;
    const json_t *study = json_object_get(first, "study");
    int runs = 0;
    const pl_bisection b = repeat_search(trials, study, &runs, &ended);
    const bool found = b.state == PL_BISECTION_FOUND;
    const double value = found ? pl_bisection_midpoint(&b) : (double)NAN;
    const double critical = number_of(study, "closed_form");
    const bool is_known = !b.either_side || found;
    const char *reason = ended == NULL ? NULL : pl_json_get_text(ended, "reason");
    json_t *row = identity_of(first, pl_json_get_text(study, "param"));
    json_t *conclusion = json_pack(
        "{s:s, s:O, s:O, s:s, s:s?, s:o, s:[o,o], s:[O,O], s:o, s:O, s:O, s:O, s:o, s:o, s:i}",
        "schema", "plumb.threshold/1", "param", json_object_get(study, "param"), "unit",
        json_object_get(study, "unit"), "finding", finding_of(&b, ended), "reason", reason, "value",
        pl_json_number_or_null(value), "bracket",
        pl_json_number_or_null(found ? b.low : (double)NAN),
        pl_json_number_or_null(found ? b.high : (double)NAN), "searched",
        json_object_get(study, "low"), json_object_get(study, "high"), "holds_below",
        is_known ? json_boolean(b.holds_below) : json_null(), "tolerance",
        json_object_get(study, "tolerance"), "closed_form", json_object_get(study, "closed_form"),
        "formula", json_object_get(study, "formula"), "error",
        pl_json_number_or_null(value - critical), "relative_error",
        pl_json_number_or_null((value - critical) / critical), "runs", runs);
    json_object_update(row, conclusion);
    json_decref(conclusion);
    return row;
}

static pl_status conclude(const json_t *results, const char *folder, json_t **conclusion,
                          pl_error *error)
{
    (void)folder;
    json_t *all = json_object(), *trials, *result;
    size_t index;
    const char *key;
    json_array_foreach((json_t *)results, index, result)
    {
        if (!isfinite(begin(json_object_get(result, "study")).tolerance)) {
            json_decref(all);
            return pl_fail(error, PL_BAD_INPUT, "results[%zu].study: expected a threshold", index);
        }
        char *text = key_of(result);
        if (json_object_get(all, text) == NULL) {
            json_object_set_new(all, text, json_array());
        }
        json_array_append(json_object_get(all, text), result);
        free(text);
    }
    *conclusion = json_array();
    json_object_foreach(all, key, trials)
    {
        json_array_append_new(*conclusion, conclude_search(trials));
    }
    json_decref(all);
    return PL_OK;
}

/* ---- The document ---- */

static bool is_same_scene(const json_t *a, const json_t *b)
{
    static const char *const keys[] = {"scenario", "params", "param", "searched", "seed"};
    bool same = true;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        same = same && json_equal(json_object_get(a, keys[i]), json_object_get(b, keys[i]));
    }
    return same;
}

static void add_head(pl_document *document, const json_t *row)
{
    const json_t *holds = json_object_get(row, "holds_below"),
                 *searched = json_object_get(row, "searched");
    const char *unit = pl_json_get_text(row, "unit");
    const bool is_plain = strcmp(unit, "1") == 0;
    pl_document_heading(document, "%s: critical %s%s%s", pl_json_get_text(row, "scenario"),
                        pl_json_get_text(row, "param"), is_plain ? "" : ", ", is_plain ? "" : unit);
    char *closed = json_is_number(json_object_get(row, "closed_form"))
                       ? pl_heap_format("Closed form: %.9g = %s", number_of(row, "closed_form"),
                                        pl_json_get_text(row, "formula"))
                       : pl_heap_copy("There is no closed form");
    pl_document_paragraph(document, "Searched from %g to %g%s. %s.",
                          json_number_value(json_array_get(searched, 0)),
                          json_number_value(json_array_get(searched, 1)),
                          !json_is_boolean(holds) ? ""
                          : json_is_true(holds)   ? ", holds below it"
                                                  : ", holds above it",
                          closed);
    free(closed);
}

static void add_row(pl_table *table, json_t *plot, const json_t *row)
{
    const json_t *bracket = json_object_get(row, "bracket");
    const double low = json_number_value(json_array_get(bracket, 0)),
                 high = json_number_value(json_array_get(bracket, 1));
    const double value = number_of(row, "value");
    const int runs = (int)json_integer_value(json_object_get(row, "runs"));
    pl_table_add(table, pl_json_get_text(row, "label"));
    if (isnan(value)) {
        const char *reason = pl_json_get_text(row, "reason");
        char *text =
            pl_heap_format("%s%s%s (%d %s)", pl_json_get_text(row, "finding"),
                           reason[0] != '\0' ? ": " : "", reason, runs, runs == 1 ? "run" : "runs");
        pl_table_add_span(table, text);
        free(text);
        return;
    }
    pl_table_number(table, value, 9);
    pl_table_number(table, (high - low) / 2, 2);
    pl_table_number(table, number_of(row, "error"), 3);
    pl_table_number(table, number_of(row, "relative_error"), 3);
    pl_table_format_cell(table, "%d", runs);
    pl_plot_row(plot, pl_json_get_text(row, "label"), (const double[]){low, value, high}, 3);
}

/* The searches of one scene, from the first one on. */
static void add_scene(pl_document *document, const json_t *conclusion, const json_t *first)
{
    pl_table table = {0};
    char *axis = pl_heap_format("%s (%s)", pl_json_get_text(first, "param"),
                                pl_json_get_text(first, "unit"));
    char *caption =
        pl_heap_format("%s: critical %s of each engine, with its bracket",
                       pl_json_get_text(first, "scenario"), pl_json_get_text(first, "param"));
    json_t *plot = pl_plot_make(PL_PLOT_INTERVALS, caption, axis, NULL);
    size_t index;
    const json_t *row;
    add_head(document, first);
    pl_table_columns(&table, "engine|>value|>±|>error|>relative|>runs");
    json_array_foreach((json_t *)conclusion, index, row)
    {
        if (is_same_scene(first, row)) {
            add_row(&table, plot, row);
        }
    }
    pl_plot_rule(plot, number_of(first, "closed_form"));
    pl_document_plot(document, plot);
    pl_document_table(document, "Critical values", &table);
    free(axis);
    free(caption);
}

static void fill_document(const json_t *conclusion, pl_document *document)
{
    const size_t count = json_array_size(conclusion);
    document->title = "Critical values, found by bisection";
    for (size_t i = 0; i < count; ++i) {
        const json_t *row = json_array_get(conclusion, i);
        size_t first = 0;
        while (!is_same_scene(json_array_get(conclusion, first), row)) {
            ++first;
        }
        if (first == i) {
            add_scene(document, conclusion, row);
        }
    }
}

const pl_study pl_threshold_study = {
    .name = "threshold", .kind = "threshold", .conclude = conclude, .document = fill_document};
