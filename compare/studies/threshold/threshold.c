/* Bisection of critical values by rounds of isolated runs. */
#include "threshold.h"

#include "base/folding.h"
#include "base/heap.h"
#include "base/program_name.h"
#include "studies/bisection.h"
#include "studies/searches.h"

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

/* Begins the search that `study` of a trial describes; false where it describes none. */
static bool begin(const json_t *study, pl_bisection *bisection)
{
    pl_bisection b = {.state = PL_BISECTION_SEARCHING};
    int below = 0, either = 0;
    const bool is_whole =
        json_unpack((json_t *)study, "{s:F, s:F, s:F, s:b, s:b}", "low", &b.low, "high", &b.high,
                    "tolerance", &b.tolerance, "holds_below", &below, "either_side", &either) == 0;
    b.holds_below = below != 0;
    b.either_side = either != 0;
    *bisection = b;
    return is_whole;
}

/* Whether the scene held in a trial. Another outcome than "ok" and "collapsed" ends the search: *ends. */
static bool held(const json_t *trial, bool *ends)
{
    const char *outcome = pl_json_get_text(trial, "outcome");
    const bool holds = strcmp(outcome, "ok") == 0;
    *ends = !holds && strcmp(outcome, "collapsed") != 0;
    return holds;
}

/* ---- Running ---- */

typedef struct work {
    pl_searches searches;     /* by case and then by configuration */
    pl_bisection *bisections; /* of each search */
    int over;                 /* searches that are */
    FILE *out;                /* gets a line for each search that is over; NULL: none does */
} work;

static double next(void *user, int search)
{
    return pl_bisection_next(&((work *)user)->bisections[search]);
}

static bool take(void *user, int search, const json_t *result)
{
    work *w = user;
    const pl_search *s = &w->searches.items[search];
    const pl_plan *plan = w->searches.how->plan;
    pl_bisection *b = &w->bisections[search];
    bool ends = false;
    const bool holds = held(result, &ends);
    if (!ends) {
        pl_bisection_take(b, holds);
    }
    const bool is_over = ends || b->state != PL_BISECTION_SEARCHING;
    w->over += is_over;
    if (is_over && w->out != NULL) {
        pl_print_line(w->out, "[%d/%d] %s  %s  %s", w->over, w->searches.count,
                      plan->cases[s->test_case].name, plan->configurations[s->configuration].label,
                      ends ? pl_json_get_text(result, "outcome") : "searched");
    }
    return is_over;
}

pl_status pl_threshold_run(const pl_execution_def *how, int *signal_number, pl_error *error)
{
    const pl_plan *plan = how->plan;
    const int count = plan->case_count * plan->configuration_count;
    work w = {.searches = {.how = how, .next = next, .take = take, .user = &w},
              .bisections = pl_heap_new((size_t)count, sizeof *w.bisections)};
    long total = 0;
    for (int i = 0; i < count; ++i) {
        const pl_case *test_case = &plan->cases[i / plan->configuration_count];
        pl_bisection *bisection = &w.bisections[w.searches.count];
        if (!begin(test_case->study, bisection)) {
            continue;
        }
        const pl_search added = {
            .test_case = i / plan->configuration_count,
            .configuration = i % plan->configuration_count,
            .param =
                pl_scenario_param(test_case->descriptor, pl_study_text(test_case->study, "param")),
            .study = test_case->study,
            .most = pl_bisection_most_trials(bisection)};
        total += added.most;
        pl_push(&w.searches.items, &w.searches.count, &added, sizeof added);
    }
    /* Where the bar cannot be drawn again, a line a trial would be hundreds of lines. */
    pl_progress bar = pl_progress_begin(how->progress, total, pl_monotonic_seconds());
    w.searches.bar = bar.terminal ? &bar : NULL;
    w.out = bar.terminal ? NULL : how->progress;
    const pl_status status = pl_searches_run(&w.searches, signal_number, error);
    pl_progress_end(&bar);
    free(w.searches.items);
    free(w.bisections);
    return status;
}

/* ---- Concluding ---- */

/* A result with the value that was tried as `at`, and not among its parameters. */
static json_t *trial_of(const json_t *result)
{
    const char *param = pl_study_text(result, "study.param");
    json_t *trial = json_copy((json_t *)result);
    json_t *params = json_copy(json_object_get(result, "params"));
    json_object_set(trial, "at", json_object_get(params, param));
    json_object_del(params, param);
    json_object_set_new(trial, "params", params);
    return trial;
}

/* The trial at a value; NULL: it was not made. */
static const json_t *find_trial(const json_t *trials, double value)
{
    size_t index;
    const json_t *trial;
    json_array_foreach((json_t *)trials, index, trial)
    {
        if (pl_study_number(trial, "at") == value) {
            return trial;
        }
    }
    return NULL;
}

/* Searches again, in the trials that were made. *ended is the trial whose outcome ended the search, neither ok nor
 * collapsed; NULL: none. */
static pl_bisection repeat_search(const json_t *trials, int *runs, const json_t **ended)
{
    pl_bisection bisection;
    const json_t *trial = json_array_get(trials, 0);
    begin(json_object_get(trial, "study"), &bisection);
    *ended = NULL;
    *runs = 0;
    while (bisection.state == PL_BISECTION_SEARCHING && *ended == NULL) {
        bool ends = false;
        trial = find_trial(trials, pl_bisection_next(&bisection));
        if (trial == NULL) {
            break;
        }
        ++*runs;
        const bool holds = held(trial, &ends);
        if (ends) {
            *ended = trial;
        } else {
            pl_bisection_take(&bisection, holds);
        }
    }
    return bisection;
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
    static const char *const more[] = {"host", PL_PROGRAM, "command", "started", NULL};
    const json_t *first = json_array_get(trials, 0), *ended = NULL;
    const json_t *study = json_object_get(first, "study");
    int runs = 0;
    const pl_bisection b = repeat_search(trials, &runs, &ended);
    const bool found = b.state == PL_BISECTION_FOUND;
    const double value = found ? pl_bisection_midpoint(&b) : (double)NAN;
    const double critical = pl_study_number(study, "closed_form");
    const bool is_known = !b.either_side || found;
    const char *reason = ended == NULL ? NULL : pl_json_get_text(ended, "reason");
    json_t *row = pl_study_row(first, more);
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
    static const char *const same[] = {
        "scenario", "params", "engine", "engine_binary", "profile", "label", "seed", "study", NULL};
    (void)folder;
    json_t *all = json_array(), *result;
    pl_status status = PL_OK;
    pl_bisection bisection;
    size_t index;
    const char *key;
    json_array_foreach((json_t *)results, index, result)
    {
        if (!begin(json_object_get(result, "study"), &bisection)) {
            status =
                pl_fail(error, PL_BAD_INPUT, "results[%zu].study: expected a threshold", index);
        }
        json_array_append_new(all, trial_of(result));
    }
    if (status == PL_OK) {
        json_t *searches = pl_study_groups(all, same), *trials;
        *conclusion = json_array();
        json_object_foreach(searches, key, trials)
        {
            json_array_append_new(*conclusion, conclude_search(trials));
        }
        json_decref(searches);
    }
    json_decref(all);
    return status;
}

/* ---- The document ---- */

static void add_head(pl_document *document, const json_t *row)
{
    const json_t *holds = json_object_get(row, "holds_below");
    double low = 0, high = 0;
    const char *unit = pl_json_get_text(row, "unit");
    const bool is_plain = strcmp(unit, "1") == 0;
    pl_document_heading(document, "%s: critical %s%s%s", pl_json_get_text(row, "scenario"),
                        pl_json_get_text(row, "param"), is_plain ? "" : ", ", is_plain ? "" : unit);
    const double critical = pl_study_number(row, "closed_form");
    char *closed = isnan(critical) ? pl_heap_copy("There is no closed form")
                                   : pl_heap_format("Closed form: %.9g = %s", critical,
                                                    pl_json_get_text(row, "formula"));
    json_unpack((json_t *)row, "{s:[F, F]}", "searched", &low, &high);
    pl_document_paragraph(document, "Searched from %g to %g%s. %s.", low, high,
                          !json_is_boolean(holds) ? ""
                          : json_is_true(holds)   ? ", holds below it"
                                                  : ", holds above it",
                          closed);
    free(closed);
}

static void add_row(pl_table *table, json_t *plot, const json_t *row)
{
    double low = 0, high = 0;
    const double value = pl_study_number(row, "value");
    const int runs = pl_study_integer(row, "runs");
    pl_table_add(table, pl_json_get_text(row, "label"));
    if (isnan(value)) {
        const char *reason = pl_json_get_text(row, "reason");
        pl_table_add_span(table, "%s%s%s (%d %s)", pl_json_get_text(row, "finding"),
                          reason[0] != '\0' ? ": " : "", reason, runs, runs == 1 ? "run" : "runs");
        return;
    }
    json_unpack((json_t *)row, "{s:[F, F]}", "bracket", &low, &high);
    pl_table_number(table, value, 9);
    pl_table_number(table, (high - low) / 2, 2);
    pl_table_number(table, pl_study_number(row, "error"), 3);
    pl_table_number(table, pl_study_number(row, "relative_error"), 3);
    pl_table_format_cell(table, "%d", runs);
    pl_plot_row(plot, pl_json_get_text(row, "label"), (const double[]){low, value, high}, 3);
}

/* The searches of one scene. */
static void add_scene(pl_document *document, const json_t *rows)
{
    pl_table table = {0};
    const json_t *first = json_array_get(rows, 0), *row;
    const char *param = pl_json_get_text(first, "param");
    char *axis = pl_heap_format("%s (%s)", param, pl_json_get_text(first, "unit"));
    char *caption = pl_heap_format("%s: critical %s of each engine, with its bracket",
                                   pl_json_get_text(first, "scenario"), param);
    json_t *plot = pl_plot_make(PL_PLOT_INTERVALS, caption, axis, NULL);
    size_t index;
    add_head(document, first);
    pl_table_columns(&table, "engine|>value|>±|>error|>relative|>runs");
    json_array_foreach((json_t *)rows, index, row)
    {
        add_row(&table, plot, row);
    }
    pl_plot_rule(plot, pl_study_number(first, "closed_form"));
    pl_document_plot(document, plot);
    pl_document_table(document, "Critical values", &table);
    free(axis);
    free(caption);
}

static void fill_document(const json_t *conclusion, pl_document *document)
{
    static const char *const same[] = {"scenario", "params", "param", "searched", "seed", NULL};
    document->title = "Critical values, found by bisection";
    pl_study_add_groups(document, conclusion, same, add_scene);
}

const pl_study pl_threshold_study = {
    .name = "threshold", .kind = "threshold", .conclude = conclude, .document = fill_document};
