/* The document of plumb.ensemble/1. */
#include "base/heap.h"
#include "ensemble.h"
#include "ensemble_report.h"
#include "sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double number_of(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static int integer_of(const json_t *object, const char *key)
{
    return (int)json_integer_value(json_object_get(object, key));
}

/* What the document says of one scene. */
typedef struct scene {
    const json_t *conclusion, *ensembles; /* of all scenes */
    int number;                           /* `case` of its ensembles */
} scene;

static bool has(const scene *s, const json_t *ensemble)
{
    return integer_of(ensemble, "case") == s->number;
}

/* The ensemble that a comparison has as `key`, "a" or "b". */
static const json_t *side(const scene *s, const json_t *comparison, const char *key)
{
    return json_array_get(s->ensembles, (size_t)integer_of(comparison, key));
}

static const json_t *observable_of(const json_t *ensemble, const char *name)
{
    return json_object_get(json_object_get(ensemble, "observables"), name);
}

/* ---- Tables ---- */

/* "16 ok" or "14 ok, 2 crashed", and how many are missing. The caller frees. */
static char *outcomes_text(const scene *s, const json_t *ensemble)
{
    pl_text_buffer text = {0};
    const json_t *outcomes = json_object_get(ensemble, "outcomes");
    const int missing = integer_of(s->conclusion, "members") - integer_of(ensemble, "results");
    for (int i = 0; i < PL_OUTCOME_COUNT; ++i) {
        const char *name = pl_outcome_name((pl_outcome)i);
        const int count = integer_of(outcomes, name);
        if (count > 0) {
            pl_text_format(&text, "%s%d %s", text.length == 0 ? "" : ", ", count, name);
        }
    }
    if (missing > 0) {
        pl_text_format(&text, "%s%d missing", text.length == 0 ? "" : ", ", missing);
    }
    return pl_text_take(&text);
}

static void add_horizon(pl_table *table, const json_t *horizon)
{
    const bool is_known = json_object_get(horizon, "threshold") != NULL;
    const double time = number_of(horizon, "time");
    if (!is_known) {
        pl_table_add(table, "unknown");
    } else if (isnan(time)) {
        pl_table_format_cell(table, "> %.3g s", number_of(horizon, "last_time"));
    } else {
        pl_table_format_cell(table, "%.3g s", time);
    }
}

static void add_engines(const scene *s, pl_document *document)
{
    size_t index;
    const json_t *ensemble;
    pl_table table = {0};
    pl_table_columns(&table, "Engine|Members|Horizon|Energy grew in|by at most|Fell through|"
                             "Not finite");
    json_array_foreach((json_t *)s->ensembles, index, ensemble)
    {
        const json_t *kept = json_object_get(ensemble, "invariants");
        if (!has(s, ensemble)) {
            continue;
        }
        char *outcomes = outcomes_text(s, ensemble);
        pl_table_add(&table, pl_json_get_text(ensemble, "name"));
        pl_table_add(&table, outcomes);
        add_horizon(&table, json_object_get(ensemble, "horizon"));
        pl_table_format_cell(&table, "%d", integer_of(kept, "energy_grew"));
        pl_table_number(&table, number_of(kept, "energy_growth"), 3);
        pl_table_format_cell(&table, "%d", integer_of(kept, "fell_through"));
        pl_table_format_cell(&table, "%d", integer_of(kept, "not_finite"));
        free(outcomes);
    }
    pl_document_table(document, "Members", &table);
}

/* The mean and the standard deviation of an observable. */
static void add_observable(pl_table *table, const json_t *sample)
{
    char mean[32] = "-", deviation[32] = "-", never[48] = "";
    const int unsettled = integer_of(sample, "unsettled");
    if (!isnan(number_of(sample, "mean"))) {
        snprintf(mean, sizeof mean, "%.3g", number_of(sample, "mean"));
    }
    if (!isnan(number_of(sample, "standard_deviation"))) {
        snprintf(deviation, sizeof deviation, "%.3g", number_of(sample, "standard_deviation"));
    }
    if (unsettled > 0) {
        snprintf(never, sizeof never, " (%d of %zu never)", unsettled,
                 json_array_size(json_object_get(sample, "values")));
    }
    pl_table_format_cell(table, "%s ± %s%s", mean, deviation, never);
}

static void add_observables(const scene *s, pl_document *document)
{
    size_t index;
    const json_t *ensemble;
    pl_table table = {0};
    pl_table_column(&table, PL_LEFT, "Engine");
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[i];
        if (pl_is_observable(i)) {
            pl_table_column(&table, PL_LEFT, "%s (%s)", info->name, info->unit);
        }
    }
    json_array_foreach((json_t *)s->ensembles, index, ensemble)
    {
        if (!has(s, ensemble)) {
            continue;
        }
        pl_table_add(&table, pl_json_get_text(ensemble, "name"));
        for (int i = 0; i < PL_METRIC_COUNT; ++i) {
            if (pl_is_observable(i)) {
                add_observable(&table, observable_of(ensemble, pl_metric_table[i].name));
            }
        }
    }
    pl_document_table(document, "Mean and standard deviation of each observable", &table);
}

static void add_comparison(const scene *s, pl_table *table, const json_t *c)
{
    const char *name = pl_json_get_text(c, "observable");
    const json_t *a = side(s, c, "a"), *b = side(s, c, "b");
    const char *verdict = pl_json_get_text(c, "verdict");
    pl_table_add(table, name);
    pl_table_add(table, pl_json_get_text(a, "name"));
    pl_table_add(table, pl_json_get_text(b, "name"));
    pl_table_format_cell(table, "%.4g", number_of(observable_of(a, name), "mean"));
    pl_table_format_cell(table, "%.4g", number_of(observable_of(b, name), "mean"));
    pl_table_number(table, number_of(c, "energy_distance_ratio"), 3);
    pl_table_format_cell(table, "%.3g", number_of(c, "ks"));
    pl_table_number(table, number_of(c, "ks_ratio"), 3);
    pl_table_format_cell(table, "%.2g", number_of(c, "p_corrected"));
    pl_table_add(table, verdict);
    if (strcmp(verdict, "told apart") == 0) {
        pl_table_style(table, "poor");
    }
}

static void add_comparisons(const scene *s, pl_document *document)
{
    size_t index;
    const json_t *c;
    pl_table table = {.keys = 3};
    pl_table_columns(&table, "Observable|Engine A|Engine B|Mean A|Mean B|Energy distance / floor|"
                             "KS|KS / floor|Corrected p|Verdict");
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        json_array_foreach(json_object_get(s->conclusion, "comparisons"), index, c)
        {
            if (has(s, side(s, c, "a")) &&
                strcmp(pl_json_get_text(c, "observable"), pl_metric_table[i].name) == 0) {
                add_comparison(s, &table, c);
            }
        }
    }
    pl_document_table(document, "Comparisons", &table);
}

/* ---- Plots and sentences ---- */

/* The values of an observable in each ensemble. */
static void add_plot(const scene *s, const pl_metric_info *info, pl_document *document)
{
    size_t index, k;
    const json_t *ensemble, *value;
    char *caption = pl_heap_format("%s of each member, and quartiles", info->name);
    char *axis = pl_heap_format("%s (%s)", info->name, info->unit);
    json_t *plot = pl_plot_make(PL_PLOT_SAMPLES, caption, axis, NULL);
    json_array_foreach((json_t *)s->ensembles, index, ensemble)
    {
        const json_t *values = json_object_get(observable_of(ensemble, info->name), "values");
        double *numbers = pl_heap_new(json_array_size(values), sizeof *numbers);
        json_array_foreach((json_t *)values, k, value)
        {
            numbers[k] = json_number_value(value);
        }
        if (has(s, ensemble) && json_array_size(values) > 0) {
            pl_plot_row(plot, pl_json_get_text(ensemble, "name"), numbers,
                        (int)json_array_size(values));
        }
        free(numbers);
    }
    pl_document_plot(document, plot);
    free(caption);
    free(axis);
}

static void add_differences(const scene *s, pl_document *document)
{
    int apart = 0, tests = 0;
    size_t index;
    const json_t *c;
    json_array_foreach(json_object_get(s->conclusion, "comparisons"), index, c)
    {
        const char *finding = pl_json_get_text(c, "finding");
        if (has(s, side(s, c, "a"))) {
            tests += 1;
            apart += finding[0] != '\0';
            if (finding[0] != '\0') {
                pl_document_item(document, "%s.", finding);
            }
        }
    }
    if (tests > 0) {
        pl_document_paragraph(document, "%d of %d comparisons tell the two apart.", apart, tests);
    }
}

/* The scene of the ensemble `first`. */
static void add_scene(const scene *s, const json_t *first, pl_document *document)
{
    char *params = pl_study_params(json_object_get(first, "params"));
    pl_document_heading(document, "%s", pl_json_get_text(first, "scenario"));
    if (params[0] != '\0') {
        pl_document_paragraph(document, "%s", params);
    }
    add_differences(s, document);
    add_engines(s, document);
    add_observables(s, document);
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        if (pl_is_observable(i)) {
            add_plot(s, &pl_metric_table[i], document);
        }
    }
    add_comparisons(s, document);
    free(params);
}

static void fill_document(const json_t *conclusion, pl_document *document)
{
    scene s = {.conclusion = conclusion, .ensembles = json_object_get(conclusion, "ensembles")};
    const double jitter = number_of(conclusion, "jitter");
    size_t index;
    const json_t *ensemble;
    document->title = "Ensembles, compared by their end states";
    pl_document_paragraph(
        document,
        "Each ensemble has %d members. Every member starts with each body displaced by up to %g of "
        "its size along each axis and turned by up to %g rad, the same for every engine (seed "
        "%lld). Horizon: when the members of one engine lie farther apart than 1 %% of the "
        "smallest body. Energy grew: members in which it rose, in a step or above the start, by "
        "more than %g of the scene's. Fell through: members with a body beyond a plane. Means are "
        "followed by the standard deviation over members.",
        integer_of(conclusion, "members"), jitter, jitter,
        (long long)json_integer_value(json_object_get(conclusion, "seed")),
        number_of(conclusion, "energy_growth_allowed"));
    pl_document_paragraph(
        document,
        "Told apart: p below %g, by permutation of the energy distance, corrected (Holm) over all "
        "%zu comparisons. The floor is what two ensembles of the same engine differ by on the "
        "mean, from its split halves: the larger of the two engines'.",
        number_of(conclusion, "significance"),
        json_array_size(json_object_get(conclusion, "comparisons")));
    s.number = -1;
    json_array_foreach((json_t *)s.ensembles, index, ensemble)
    {
        if (integer_of(ensemble, "case") > s.number) {
            s.number = integer_of(ensemble, "case");
            add_scene(&s, ensemble, document);
        }
    }
}

const pl_study pl_ensemble_study = {.name = "ensemble",
                                    .kind = "ensemble",
                                    .conclude = pl_ensemble_conclude,
                                    .document = fill_document};
