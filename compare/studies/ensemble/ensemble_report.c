#include "ensemble_report.h"

#include "plumb/jitter.h"
#include "runner/execute.h"
#include "two_sample.h"
#include "verdict.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct pl_text_table {
    char **cells; /* (count), the heads first */
    int count, columns;
} pl_text_table;

/* The next cell, row by row. A '|' in it is escaped, control characters become '?'. */
static void pl_text_table_add(pl_text_table *table, const char *text)
{
    if (table == NULL) {
        return;
    }
    char **grown = realloc(table->cells, ((size_t)table->count + 1) * sizeof *grown);
    char *cell = malloc(2 * strlen(text) + 1);
    if (grown != NULL) {
        table->cells = grown;
    }
    if (grown == NULL || cell == NULL) {
        free(cell);
        return;
    }
    char *to = cell;
    for (const char *from = text; *from != '\0'; ++from) {
        if (*from == '|') {
            *to++ = '\\';
        }
        *to++ = (unsigned char)*from < 0x20 ? '?' : *from;
    }
    *to = '\0';
    table->cells[table->count++] = cell;
}

/* NULL when out of memory, which the others allow: they then do nothing. */
static pl_text_table *pl_text_table_begin(const char *const *heads, int columns)
{
    pl_text_table *table = calloc(1, sizeof *table);
    if (table != NULL) {
        table->columns = columns;
        for (int i = 0; i < columns; ++i) {
            pl_text_table_add(table, heads[i]);
        }
    }
    return table;
}

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
pl_text_table_format(pl_text_table *table, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    pl_text_table_add(table, text);
}

/* Code points of UTF-8. */
static int width_of(const char *text)
{
    int width = 0;
    for (; *text != '\0'; ++text) {
        width += ((unsigned char)*text & 0xc0) != 0x80;
    }
    return width;
}

static int column_width(const pl_text_table *table, int column)
{
    int widest = 3;
    for (int i = column; i < table->count; i += table->columns) {
        int width = width_of(table->cells[i]);
        widest = width > widest ? width : widest;
    }
    return widest;
}

static void write_rule(const pl_text_table *table, FILE *out)
{
    for (int k = 0; k < table->columns; ++k) {
        fputs("|-", out);
        for (int i = column_width(table, k); i > 0; --i) {
            fputc('-', out);
        }
        fputc('-', out);
    }
    fputs("|\n", out);
}

/* Writes a table that has rows, with an empty line after it, and frees it. */
static void pl_text_table_end(pl_text_table *table, FILE *out)
{
    if (table == NULL) {
        return;
    }
    for (int i = 0; i < table->count && table->count > table->columns; ++i) {
        const int column = i % table->columns;
        const char *cell = table->cells[i];
        fprintf(out, "| %s%*s ", cell, column_width(table, column) - width_of(cell), "");
        if (column == table->columns - 1) {
            fputs("|\n", out);
        }
        if (i == table->columns - 1) {
            write_rule(table, out);
        }
    }
    if (table->count > table->columns) {
        fputc('\n', out);
    }
    for (int i = 0; i < table->count; ++i) {
        free(table->cells[i]);
    }
    free(table->cells);
    free(table);
}

static void number(double value, char text[32])
{
    if (isnan(value)) {
        snprintf(text, 32, "-");
    } else {
        snprintf(text, 32, "%.3g", value);
    }
}

/* "16 ok" or "14 ok, 2 crashed", and what is missing. */
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

static void horizon_text(const pl_horizon *horizon, char text[48])
{
    if (!horizon->known) {
        snprintf(text, 48, "unknown");
    } else if (isinf(horizon->time)) {
        snprintf(text, 48, "> %.3g s", horizon->last_time);
    } else {
        snprintf(text, 48, "%.3g s", horizon->time);
    }
}

static void add_engines(FILE *out, const pl_ensembles *all, const pl_ensemble_view *views,
                        int test_case)
{
    static const char *const heads[] = {"Engine",     "Members",      "Horizon",   "Energy grew in",
                                        "by at most", "Fell through", "Not finite"};
    pl_text_table *table = pl_text_table_begin(heads, 7);
    for (int i = 0; i < all->count; ++i) {
        const pl_observations *observed = &views[i].observed;
        char outcomes[160], horizon[48], growth[32];
        if (all->items[i].test_case != test_case) {
            continue;
        }
        outcomes_text(observed, all->members, outcomes, sizeof outcomes);
        horizon_text(&views[i].horizon, horizon);
        number(observed->invariants.energy_growth, growth);
        pl_text_table_add(table, all->items[i].name);
        pl_text_table_add(table, outcomes);
        pl_text_table_add(table, horizon);
        pl_text_table_format(table, "%d", observed->invariants.energy_grew);
        pl_text_table_add(table, growth);
        pl_text_table_format(table, "%d", observed->invariants.fell_through);
        pl_text_table_format(table, "%d", observed->invariants.not_finite);
    }
    pl_text_table_end(table, out);
}

/* "value +- deviation" of every observable and ensemble. */
static void add_observables(FILE *out, const pl_ensembles *all, const pl_ensemble_view *views,
                            int test_case)
{
    const char *heads[PL_OBSERVABLE_COUNT + 1] = {"Engine"};
    char head[PL_OBSERVABLE_COUNT][64];
    for (int i = 0; i < PL_OBSERVABLE_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[pl_observables[i]];
        snprintf(head[i], sizeof head[i], "%s (%s)", info->name, info->unit);
        heads[i + 1] = head[i];
    }
    pl_text_table *table = pl_text_table_begin(heads, PL_OBSERVABLE_COUNT + 1);
    for (int k = 0; k < all->count; ++k) {
        if (all->items[k].test_case != test_case) {
            continue;
        }
        pl_text_table_add(table, all->items[k].name);
        for (int i = 0; i < PL_OBSERVABLE_COUNT; ++i) {
            const pl_sample *sample = &views[k].observed.samples[i];
            char mean[32], deviation[32];
            number(sample->mean, mean);
            number(sample->deviation, deviation);
            if (sample->unsettled > 0) {
                pl_text_table_format(table, "%s ± %s (%d of %d never)", mean, deviation,
                                     sample->unsettled, sample->count);
            } else {
                pl_text_table_format(table, "%s ± %s", mean, deviation);
            }
        }
    }
    pl_text_table_end(table, out);
}

static void add_ratio(pl_text_table *table, double value, double floor)
{
    char text[32];
    number(floor > 0 ? value / floor : (double)NAN, text);
    pl_text_table_add(table, text);
}

static void add_comparisons(FILE *out, const pl_ensembles *all, const pl_ensemble_view *views,
                            const pl_verdicts *verdicts, int test_case)
{
    static const char *const heads[] = {
        "Observable", "Engine A",   "Engine B",    "Mean A", "Mean B", "Energy distance / floor",
        "KS",         "KS / floor", "Corrected p", "Verdict"};
    pl_text_table *table = pl_text_table_begin(heads, 10);
    for (int k = 0; k < PL_OBSERVABLE_COUNT; ++k) {
        for (int i = 0; i < verdicts->count; ++i) {
            const pl_sample_test *c = &verdicts->items[i];
            if (c->observable != k || all->items[c->a].test_case != test_case) {
                continue;
            }
            pl_text_table_add(table, pl_metric_table[pl_observables[k]].name);
            pl_text_table_add(table, all->items[c->a].name);
            pl_text_table_add(table, all->items[c->b].name);
            pl_text_table_format(table, "%.4g", views[c->a].observed.samples[k].mean);
            pl_text_table_format(table, "%.4g", views[c->b].observed.samples[k].mean);
            add_ratio(table, c->energy, c->energy_floor);
            pl_text_table_format(table, "%.3g", c->ks);
            add_ratio(table, c->ks, c->ks_floor);
            pl_text_table_format(table, "%.2g", c->corrected);
            pl_text_table_add(table, c->apart ? "told apart" : "not told apart");
        }
    }
    pl_text_table_end(table, out);
}

static void add_differences(FILE *out, const pl_ensembles *all, const pl_ensemble_view *views,
                            const pl_verdicts *verdicts, int test_case)
{
    int apart = 0, tests = 0;
    for (int i = 0; i < verdicts->count; ++i) {
        const pl_sample_test *c = &verdicts->items[i];
        if (all->items[c->a].test_case != test_case) {
            continue;
        }
        tests += 1;
        if (c->apart) {
            char sentence[512];
            pl_sample_test_sentence(views, c, sentence, sizeof sentence);
            fprintf(out, "- %s.\n", sentence);
            apart += 1;
        }
    }
    if (tests > 0) {
        fprintf(out, "%s%d of %d comparisons tell the two apart.\n\n", apart > 0 ? "\n" : "", apart,
                tests);
    }
}

/* The asked parameters, which two cases of one scenario differ by. */
static void add_title(FILE *out, const pl_case *test_case)
{
    const pl_scenario *descriptor = test_case->descriptor;
    fprintf(out, "## %s\n\n", test_case->name);
    if (descriptor != NULL) {
        for (int i = 0; i < descriptor->param_count; ++i) {
            fprintf(out, "%s%s = %.6g", i == 0 ? "" : ", ", descriptor->params[i].name,
                    test_case->params[i]);
        }
        fprintf(out, "\n\n");
    }
}

static void add_introduction(FILE *out, const pl_plan *plan, const pl_ensembles *all,
                             const pl_verdicts *verdicts)
{
    fprintf(out,
            "# Ensembles of %d members\n\n"
            "Every member starts with each body displaced by up to %g of its size along each axis\n"
            "and turned by up to %g rad, the same for every engine (seed %llu). Horizon: when the\n"
            "members of one engine lie farther apart than 1 %% of the smallest body. Energy grew:\n"
            "members in which it rose, in a step or above the start, by more than %g of the\n"
            "scene's. Fell through: members with a body beyond a plane. Means are followed by the\n"
            "standard deviation over members.\n\n"
            "Told apart: p below %g, by permutation of the energy distance, corrected (Holm) over\n"
            "all %d comparisons. The floor is what two ensembles of the same engine differ by on\n"
            "the mean, from its split halves: the larger of the two engines'.\n\n",
            all->members, pl_jitter_amplitude, pl_jitter_amplitude, (unsigned long long)plan->seed,
            pl_energy_growth, pl_significance, verdicts->count);
}

/* malloc'd; NULL when out of memory. */
static char *pl_ensemble_summary(const pl_plan *plan, const pl_ensembles *ensembles,
                                 const pl_ensemble_view *views, const pl_verdicts *verdicts)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL) {
        return NULL;
    }
    add_introduction(out, plan, ensembles, verdicts);
    for (int p = 0; p < ensembles->case_count; ++p) {
        const pl_ensemble *first = NULL;
        for (int i = 0; i < ensembles->count && first == NULL; ++i) {
            first = ensembles->items[i].test_case == p ? &ensembles->items[i] : NULL;
        }
        if (first == NULL) {
            continue;
        }
        add_title(out, &plan->cases[first->cases[0]]);
        add_differences(out, ensembles, views, verdicts, p);
        add_engines(out, ensembles, views, p);
        add_observables(out, ensembles, views, p);
        add_comparisons(out, ensembles, views, verdicts, p);
    }
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

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

/* The horizon that such an object holds of the ensemble with exactly these members' runs; false
 * where it has none. `before` may be NULL. */
static bool pl_horizon_recall(const json_t *before, const pl_plan *plan,
                              const pl_ensemble *ensemble, int members, pl_horizon *horizon)
{
    bool found = false;
    size_t index;
    const json_t *item;
    json_t *runs = runs_json(plan, ensemble, members);
    json_array_foreach(json_object_get(before, "ensembles"), index, item)
    {
        const json_t *old = json_object_get(item, "horizon");
        const json_t *time = json_object_get(old, "time");
        const json_t *threshold = json_object_get(old, "threshold");
        if (!found && threshold != NULL && json_equal(json_object_get(item, "runs"), runs)) {
            found = true;
            *horizon = (pl_horizon){
                .known = true,
                .time = json_is_number(time) ? json_number_value(time) : (double)INFINITY,
                .threshold = json_number_value(threshold),
                .last_spread = json_number_value(json_object_get(old, "last_spread")),
                .last_time = json_number_value(json_object_get(old, "last_time"))};
        }
    }
    json_decref(runs);
    return found;
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

static json_t *view_json(const pl_plan *plan, const pl_ensemble_view *view, int members)
{
    const pl_ensemble *ensemble = view->ensemble;
    const pl_case *test_case = &plan->cases[ensemble->cases[0]];
    const pl_invariants *kept = &view->observed.invariants;
    json_t *observables = json_object();
    for (int i = 0; i < PL_OBSERVABLE_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[pl_observables[i]];
        json_object_set_new(observables, info->name, sample_json(&view->observed.samples[i], info));
    }
    json_t *invariants =
        json_pack("{s:i, s:o, s:i, s:i}", "energy_grew", kept->energy_grew, "energy_growth",
                  pl_json_number_or_null(kept->energy_growth), "fell_through", kept->fell_through,
                  "not_finite", kept->not_finite);
    return json_pack(
        "{s:i, s:o, s:s, s:s, s:i, s:b, s:f, s:o, s:i, s:o, s:o, s:o, s:o}", "problem",
        ensemble->test_case, "scenario", pl_json_text(test_case->name, strlen(test_case->name)),
        "name", ensemble->name, "label", plan->configurations[ensemble->configuration].label,
        "setting", ensemble->setting, "converged", (int)ensemble->reference, "dt",
        test_case->scene.dt, "runs", runs_json(plan, ensemble, members), "results",
        view->observed.results, "outcomes", outcomes_json(&view->observed), "invariants",
        invariants, "horizon", horizon_json(&view->horizon), "observables", observables);
}

static json_t *ratio_json(double value, double floor)
{
    return pl_json_number_or_null(floor > 0 ? value / floor : (double)NAN);
}

static json_t *comparison_json(const pl_ensemble_view *views, const pl_sample_test *c)
{
    char sentence[512] = "";
    if (c->apart) {
        pl_sample_test_sentence(views, c, sentence, sizeof sentence);
    }
    return json_pack(
        "{s:i, s:i, s:s, s:f, s:o, s:o, s:f, s:o, s:o, s:f, s:f, s:s, s:o}", "a", c->a, "b", c->b,
        "observable", pl_metric_table[pl_observables[c->observable]].name, "energy_distance",
        c->energy, "energy_distance_floor", pl_json_number_or_null(c->energy_floor),
        "energy_distance_ratio", ratio_json(c->energy, c->energy_floor), "ks", c->ks, "ks_floor",
        pl_json_number_or_null(c->ks_floor), "ks_ratio", ratio_json(c->ks, c->ks_floor), "p", c->p,
        "p_corrected", c->corrected, "verdict", c->apart ? "told apart" : "not told apart",
        "finding", c->apart ? json_string(sentence) : json_null());
}

/* A new reference; NULL when out of memory. */
static json_t *pl_ensemble_to_json(const pl_plan *plan, const pl_ensembles *ensembles,
                                   const pl_ensemble_view *views, const pl_verdicts *verdicts)
{
    json_t *all = json_array(), *comparisons = json_array();
    for (int i = 0; i < ensembles->count; ++i) {
        json_array_append_new(all, view_json(plan, &views[i], ensembles->members));
    }
    for (int i = 0; i < verdicts->count; ++i) {
        json_array_append_new(comparisons, comparison_json(views, &verdicts->items[i]));
    }
    return json_pack("{s:s, s:i, s:I, s:f, s:f, s:i, s:f, s:o, s:o}", "schema", "plumb.ensemble/1",
                     "members", ensembles->members, "seed", (json_int_t)plan->seed, "jitter",
                     pl_jitter_amplitude, "significance", pl_significance, "permutations",
                     PL_PERMUTATION_DRAWS, "energy_growth_allowed", pl_energy_growth, "ensembles",
                     all, "comparisons", comparisons);
}

static pl_status look(const pl_plan *plan, const pl_ensemble *ensemble, int members,
                      const json_t *by_run, const char *folder, const json_t *before,
                      pl_ensemble_view *view, pl_error *error)
{
    view->ensemble = ensemble;
    pl_status status =
        pl_observations_gather(plan, ensemble, members, by_run, &view->observed, error);
    if (status == PL_OK) {
        status = pl_horizon_find(plan, ensemble, members, folder, &view->horizon, error);
    }
    if (status == PL_OK && !view->horizon.known) {
        pl_horizon_recall(before, plan, ensemble, members, &view->horizon);
    }
    return status;
}

pl_status pl_ensemble_conclude(const pl_plan *plan, const pl_ensembles *ensembles,
                               const json_t *results, const char *folder, const json_t *before,
                               pl_ensemble_outcome *outcome, pl_error *error)
{
    pl_verdicts verdicts = {.count = 0};
    json_t *by_run = pl_results_by_run(results);
    pl_ensemble_view *views = calloc((size_t)ensembles->count + 1, sizeof *views);
    pl_status status = by_run == NULL || views == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "out of memory for the outcome")
                           : PL_OK;
    *outcome = (pl_ensemble_outcome){.json = NULL};
    for (int i = 0; i < ensembles->count && status == PL_OK; ++i) {
        status = look(plan, &ensembles->items[i], ensembles->members, by_run, folder, before,
                      &views[i], error);
    }
    if (status == PL_OK) {
        status = pl_verdicts_reach(views, ensembles->count, &verdicts, error);
    }
    if (status == PL_OK) {
        outcome->comparisons = verdicts.count;
        outcome->json = pl_ensemble_to_json(plan, ensembles, views, &verdicts);
        outcome->summary = pl_ensemble_summary(plan, ensembles, views, &verdicts);
        if (outcome->json == NULL || outcome->summary == NULL) {
            status = pl_fail(error, PL_NO_MEMORY, "out of memory for the outcome");
        }
    }
    for (int i = 0; i < ensembles->count && views != NULL; ++i) {
        pl_observations_free(&views[i].observed);
    }
    pl_verdicts_free(&verdicts);
    free(views);
    json_decref(by_run);
    return status;
}

void pl_ensemble_outcome_free(pl_ensemble_outcome *outcome)
{
    json_decref(outcome->json);
    free(outcome->summary);
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
