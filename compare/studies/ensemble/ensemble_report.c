/* Evaluates an ensemble's runs, and writes the outcome as Markdown, as text and as plumb.ensemble/1. */
#include "ensemble_report.h"

#include "base/text_page.h"
#include "plumb/jitter.h"
#include "runner/execute.h"
#include "two_sample.h"
#include "verdict.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct report {
    const pl_plan *plan;
    const pl_ensembles *all;
    pl_ensemble_view *views; /* (all->count) */
    pl_verdicts verdicts;
    pl_text_page page;
} report;

/* ---- Summary ---- */

/* "16 ok" or "14 ok, 2 crashed", and how many are missing. */
static void outcomes_text(const pl_observations *observed, int members, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < PL_OUTCOME_COUNT && used < size; ++i) {
        if (observed->outcomes[i] > 0) {
            used += (size_t)snprintf(text + used, size - used, "%s%d %s", used == 0 ? "" : ", ",
                                     observed->outcomes[i], pl_outcome_name((pl_outcome)i));
        }
    }
    if (observed->results < members && used < size) {
        snprintf(text + used, size - used, "%s%d missing", used == 0 ? "" : ", ",
                 members - observed->results);
    }
}

static void add_engines(report *r, int test_case)
{
    pl_table table = {0};
    pl_table_columns(&table, "Engine|Members|Horizon|Energy grew in|by at most|Fell through|"
                             "Not finite");
    for (int i = 0; i < r->all->count; ++i) {
        const pl_observations *observed = &r->views[i].observed;
        const pl_horizon *horizon = &r->views[i].horizon;
        char outcomes[160];
        if (r->all->items[i].test_case != test_case) {
            continue;
        }
        outcomes_text(observed, r->all->members, outcomes, sizeof outcomes);
        pl_table_add(&table, r->all->items[i].name);
        pl_table_add(&table, outcomes);
        if (!horizon->known) {
            pl_table_add(&table, "unknown");
        } else {
            pl_table_format_cell(&table, isinf(horizon->time) ? "> %.3g s" : "%.3g s",
                                 fmin(horizon->time, horizon->last_time));
        }
        pl_table_format_cell(&table, "%d", observed->invariants.energy_grew);
        pl_table_number(&table, observed->invariants.energy_growth, 3);
        pl_table_format_cell(&table, "%d", observed->invariants.fell_through);
        pl_table_format_cell(&table, "%d", observed->invariants.not_finite);
    }
    pl_text_page_table(&r->page, &table);
}

/* The mean and the standard deviation of every observable and ensemble. */
static void add_observables(report *r, int test_case)
{
    pl_table table = {0};
    pl_table_column(&table, PL_LEFT, "Engine");
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[i];
        if (pl_is_observable(i)) {
            pl_table_column(&table, PL_LEFT, "%s (%s)", info->name, info->unit);
        }
    }
    for (int k = 0; k < r->all->count; ++k) {
        if (r->all->items[k].test_case != test_case) {
            continue;
        }
        pl_table_add(&table, r->all->items[k].name);
        for (int i = 0; i < PL_METRIC_COUNT; ++i) {
            const pl_sample *sample = &r->views[k].observed.samples[i];
            if (!pl_is_observable(i)) {
                continue;
            }
            char mean[32] = "-", deviation[32] = "-", never[48] = "";
            if (!isnan(sample->mean)) {
                snprintf(mean, sizeof mean, "%.3g", sample->mean);
            }
            if (!isnan(sample->deviation)) {
                snprintf(deviation, sizeof deviation, "%.3g", sample->deviation);
            }
            if (sample->unsettled > 0) {
                snprintf(never, sizeof never, " (%d of %d never)", sample->unsettled,
                         sample->count);
            }
            pl_table_format_cell(&table, "%s ± %s%s", mean, deviation, never);
        }
    }
    pl_text_page_table(&r->page, &table);
}

/* A distance over its floor; NAN where there is no floor. */
static double floor_ratio(double value, double floor)
{
    return floor > 0 ? value / floor : (double)NAN;
}

static void add_comparisons(report *r, int test_case)
{
    pl_table table = {.keys = 3};
    pl_table_columns(&table, "Observable|Engine A|Engine B|Mean A|Mean B|Energy distance / floor|"
                             "KS|KS / floor|Corrected p|Verdict");
    for (int k = 0; k < PL_METRIC_COUNT; ++k) {
        for (int i = 0; i < r->verdicts.count; ++i) {
            const pl_sample_test *c = &r->verdicts.items[i];
            if (c->observable != k || r->all->items[c->a].test_case != test_case) {
                continue;
            }
            pl_table_add(&table, pl_metric_table[k].name);
            pl_table_add(&table, r->all->items[c->a].name);
            pl_table_add(&table, r->all->items[c->b].name);
            pl_table_format_cell(&table, "%.4g", r->views[c->a].observed.samples[k].mean);
            pl_table_format_cell(&table, "%.4g", r->views[c->b].observed.samples[k].mean);
            pl_table_number(&table, floor_ratio(c->energy, c->energy_floor), 3);
            pl_table_format_cell(&table, "%.3g", c->ks);
            pl_table_number(&table, floor_ratio(c->ks, c->ks_floor), 3);
            pl_table_format_cell(&table, "%.2g", c->corrected);
            pl_table_add(&table, c->apart ? "told apart" : "not told apart");
        }
    }
    pl_text_page_table(&r->page, &table);
}

static void add_differences(report *r, int test_case)
{
    int apart = 0, tests = 0;
    for (int i = 0; i < r->verdicts.count; ++i) {
        const pl_sample_test *c = &r->verdicts.items[i];
        if (r->all->items[c->a].test_case != test_case) {
            continue;
        }
        tests += 1;
        if (c->apart) {
            char sentence[512];
            pl_sample_test_sentence(r->views, c, sentence, sizeof sentence);
            pl_text_page_item(&r->page, "%s.", sentence);
            apart += 1;
        }
    }
    if (tests > 0) {
        pl_text_page_paragraph(&r->page, "%d of %d comparisons tell the two apart.", apart, tests);
    }
}

/* The name with the parameters, by which two cases of one scenario differ. */
static void add_title(report *r, const pl_case *test_case)
{
    const pl_scenario *descriptor = test_case->descriptor;
    pl_text_buffer params = {0};
    for (int i = 0; i < descriptor->param_count; ++i) {
        if (!isnan(test_case->params[i])) {
            pl_text_format(&params, "%s%s = %.6g", params.length == 0 ? "" : ", ",
                           descriptor->params[i].name, test_case->params[i]);
        }
    }
    pl_text_page_heading(&r->page, 2, "%s", test_case->name);
    if (params.length > 0) {
        pl_text_page_paragraph(&r->page, "%s", params.data);
    }
    r->page.out->failed |= params.failed;
    pl_text_free(&params);
}

/* Returns the summary, malloc'd, for a terminal of this width, or as Markdown for 0; NULL when out of
 * memory. */
static char *summary_text(report *r, int width)
{
    pl_text_buffer text = {0};
    r->page = (pl_text_page){.out = &text, .width = width};
    pl_text_page *page = &r->page;
    pl_text_page_heading(page, 1, "Ensembles of %d members", r->all->members);
    pl_text_page_paragraph(
        page,
        "Every member starts with each body displaced by up to %g of its size along each axis and "
        "turned by up to %g rad, the same for every engine (seed %llu). Horizon: when the members "
        "of one engine lie farther apart than 1 %% of the smallest body. Energy grew: members in "
        "which it rose, in a step or above the start, by more than %g of the scene's. Fell "
        "through: members with a body beyond a plane. Means are followed by the standard deviation "
        "over members.",
        pl_jitter_amplitude, pl_jitter_amplitude, (unsigned long long)r->plan->seed,
        pl_energy_growth);
    pl_text_page_paragraph(
        page,
        "Told apart: p below %g, by permutation of the energy distance, corrected (Holm) over all "
        "%d comparisons. The floor is what two ensembles of the same engine differ by on the mean, "
        "from its split halves: the larger of the two engines'.",
        pl_significance, r->verdicts.count);
    for (int p = 0; p < r->all->case_count; ++p) {
        int first = 0;
        while (first < r->all->count && r->all->items[first].test_case != p) {
            ++first;
        }
        if (first < r->all->count) {
            add_title(r, &r->plan->cases[r->all->items[first].cases[0]]);
            add_differences(r, p);
            add_engines(r, p);
            add_observables(r, p);
            add_comparisons(r, p);
        }
    }
    if (text.failed) {
        pl_text_free(&text);
    }
    return text.data;
}

/* ---- plumb.ensemble/1 ---- */

static json_t *runs_json(const pl_plan *plan, const pl_ensemble *ensemble, int members)
{
    json_t *runs = json_array();
    for (int k = 0; k < members; ++k) {
        char run[17];
        pl_member_run(plan, ensemble, k, run);
        json_array_append_new(runs, json_string(run));
    }
    return runs;
}

static json_t *horizon_json(const pl_horizon *horizon)
{
    if (!horizon->known) {
        return json_pack("{s:n, s:s}", "time", "reason", horizon->reason);
    }
    json_t *object =
        json_pack("{s:o, s:f, s:o, s:f}", "time", pl_json_number_or_null(horizon->time),
                  "threshold", horizon->threshold, "last_spread",
                  pl_json_number_or_null(horizon->last_spread), "last_time", horizon->last_time);
    if (isinf(horizon->time)) {
        json_object_set_new(object, "reason",
                            json_sprintf("not passed within %.6g s", horizon->last_time));
    }
    return object;
}

/* Takes the horizon from `before` (NULL allowed), an earlier outcome, where that has the ensemble
 * with exactly these members' runs. */
static void recall_horizon(const json_t *before, const pl_plan *plan, const pl_ensemble *ensemble,
                           int members, pl_horizon *horizon)
{
    size_t index;
    const json_t *item;
    json_t *runs = runs_json(plan, ensemble, members);
    json_array_foreach(json_object_get(before, "ensembles"), index, item)
    {
        const json_t *old = json_object_get(item, "horizon");
        const json_t *time = json_object_get(old, "time");
        const json_t *threshold = json_object_get(old, "threshold");
        if (threshold != NULL && json_equal(json_object_get(item, "runs"), runs)) {
            *horizon = (pl_horizon){
                .known = true,
                .time = json_is_number(time) ? json_number_value(time) : (double)INFINITY,
                .threshold = json_number_value(threshold),
                .last_spread = json_number_value(json_object_get(old, "last_spread")),
                .last_time = json_number_value(json_object_get(old, "last_time"))};
            break;
        }
    }
    json_decref(runs);
}

static json_t *sample_json(const pl_sample *sample, const pl_metric_info *info)
{
    json_t *values = json_array();
    for (int i = 0; i < sample->count; ++i) {
        json_array_append_new(values, json_real(sample->values[i]));
    }
    return json_pack("{s:o, s:s, s:o, s:o, s:i}", "values", values, "unit", info->unit, "mean",
                     pl_json_number_or_null(sample->mean), "standard_deviation",
                     pl_json_number_or_null(sample->deviation), "unsettled", sample->unsettled);
}

static json_t *outcomes_json(const pl_observations *observed)
{
    json_t *outcomes = json_object();
    for (int i = 0; i < PL_OUTCOME_COUNT; ++i) {
        if (observed->outcomes[i] > 0) {
            json_object_set_new(outcomes, pl_outcome_name((pl_outcome)i),
                                json_integer(observed->outcomes[i]));
        }
    }
    return outcomes;
}

static json_t *view_json(const report *r, const pl_ensemble_view *view)
{
    const pl_ensemble *ensemble = view->ensemble;
    const pl_case *test_case = &r->plan->cases[ensemble->cases[0]];
    const pl_invariants *kept = &view->observed.invariants;
    json_t *observables = json_object();
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[i];
        if (pl_is_observable(i)) {
            json_object_set_new(observables, info->name,
                                sample_json(&view->observed.samples[i], info));
        }
    }
    json_t *invariants =
        json_pack("{s:i, s:o, s:i, s:i}", "energy_grew", kept->energy_grew, "energy_growth",
                  pl_json_number_or_null(kept->energy_growth), "fell_through", kept->fell_through,
                  "not_finite", kept->not_finite);
    return json_pack(
        "{s:i, s:o, s:s, s:s, s:i, s:b, s:f, s:o, s:i, s:o, s:o, s:o, s:o}", "problem",
        ensemble->test_case, "scenario", pl_json_text(test_case->name, strlen(test_case->name)),
        "name", ensemble->name, "label", r->plan->configurations[ensemble->configuration].label,
        "setting", ensemble->setting, "converged", (int)ensemble->reference, "dt",
        test_case->scene.dt, "runs", runs_json(r->plan, ensemble, r->all->members), "results",
        view->observed.results, "outcomes", outcomes_json(&view->observed), "invariants",
        invariants, "horizon", horizon_json(&view->horizon), "observables", observables);
}

static json_t *comparison_json(const pl_ensemble_view *views, const pl_sample_test *c)
{
    char sentence[512] = "";
    if (c->apart) {
        pl_sample_test_sentence(views, c, sentence, sizeof sentence);
    }
    return json_pack(
        "{s:i, s:i, s:s, s:f, s:o, s:o, s:f, s:o, s:o, s:f, s:f, s:s, s:o}", "a", c->a, "b", c->b,
        "observable", pl_metric_table[c->observable].name, "energy_distance", c->energy,
        "energy_distance_floor", pl_json_number_or_null(c->energy_floor), "energy_distance_ratio",
        pl_json_number_or_null(floor_ratio(c->energy, c->energy_floor)), "ks", c->ks, "ks_floor",
        pl_json_number_or_null(c->ks_floor), "ks_ratio",
        pl_json_number_or_null(floor_ratio(c->ks, c->ks_floor)), "p", c->p, "p_corrected",
        c->corrected, "verdict", c->apart ? "told apart" : "not told apart", "finding",
        c->apart ? json_string(sentence) : json_null());
}

static json_t *report_json(const report *r)
{
    json_t *all = json_array(), *comparisons = json_array();
    for (int i = 0; i < r->all->count; ++i) {
        json_array_append_new(all, view_json(r, &r->views[i]));
    }
    for (int i = 0; i < r->verdicts.count; ++i) {
        json_array_append_new(comparisons, comparison_json(r->views, &r->verdicts.items[i]));
    }
    return json_pack("{s:s, s:i, s:I, s:f, s:f, s:i, s:f, s:o, s:o}", "schema", "plumb.ensemble/1",
                     "members", r->all->members, "seed", (json_int_t)r->plan->seed, "jitter",
                     pl_jitter_amplitude, "significance", pl_significance, "permutations",
                     PL_PERMUTATION_DRAWS, "energy_growth_allowed", pl_energy_growth, "ensembles",
                     all, "comparisons", comparisons);
}

/* ---- Outcome ---- */

pl_status pl_ensemble_conclude(const pl_plan *plan, const pl_ensembles *ensembles,
                               const json_t *results, const char *folder, const json_t *before,
                               int width, pl_ensemble_outcome *outcome, pl_error *error)
{
    const int members = ensembles->members;
    json_t *by_run = pl_results_by_run(results);
    pl_ensemble_view *views = calloc((size_t)ensembles->count + 1, sizeof *views);
    report r = {.plan = plan, .all = ensembles, .views = views};
    pl_status status = by_run == NULL || views == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "out of memory for the outcome")
                           : PL_OK;
    *outcome = (pl_ensemble_outcome){.json = NULL};
    for (int i = 0; i < ensembles->count && status == PL_OK; ++i) {
        const pl_ensemble *ensemble = &ensembles->items[i];
        pl_ensemble_view *view = &views[i];
        view->ensemble = ensemble;
        status = pl_observations_gather(plan, ensemble, members, by_run, &view->observed, error);
        if (status == PL_OK) {
            status = pl_horizon_find(plan, ensemble, members, folder, &view->horizon, error);
        }
        if (status == PL_OK && !view->horizon.known) {
            recall_horizon(before, plan, ensemble, members, &view->horizon);
        }
    }
    if (status == PL_OK) {
        status = pl_verdicts_reach(views, ensembles->count, &r.verdicts, error);
    }
    if (status == PL_OK) {
        *outcome = (pl_ensemble_outcome){.comparisons = r.verdicts.count,
                                         .json = report_json(&r),
                                         .summary = summary_text(&r, 0),
                                         .text = summary_text(&r, width)};
        if (outcome->json == NULL || outcome->summary == NULL || outcome->text == NULL) {
            status = pl_fail(error, PL_NO_MEMORY, "out of memory for the outcome");
        }
    }
    for (int i = 0; i < ensembles->count && views != NULL; ++i) {
        pl_observations_free(&views[i].observed);
    }
    pl_verdicts_free(&r.verdicts);
    free(views);
    json_decref(by_run);
    return status;
}

void pl_ensemble_outcome_free(pl_ensemble_outcome *outcome)
{
    json_decref(outcome->json);
    free(outcome->summary);
    free(outcome->text);
    *outcome = (pl_ensemble_outcome){.json = NULL};
}

void pl_ensemble_clear(const pl_plan *plan, const pl_ensembles *ensembles, const char *folder)
{
    for (int i = 0; i < ensembles->count; ++i) {
        for (int k = 0; k < ensembles->members; ++k) {
            char run[17];
            pl_member_run(plan, &ensembles->items[i], k, run);
            char *path = pl_positions_path(folder, run);
            if (path != NULL) {
                unlink(path);
            }
            free(path);
        }
    }
    rmdir(folder);
}
