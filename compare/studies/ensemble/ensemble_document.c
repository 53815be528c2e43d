/* The document of plumb.ensemble/1. */
#include "base/heap.h"
#include "ensemble.h"
#include "sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the document says of one scene. */
typedef struct scene {
    const json_t *all;               /* ensembles, of all scenes */
    json_t *ensembles, *comparisons; /* of this scene */
    int members;
} scene;

/* The ensemble that a comparison has as `key`, "a" or "b". */
static const json_t *side(const scene *s, const json_t *comparison, const char *key)
{
    return json_array_get(s->all, (size_t)pl_study_integer(comparison, key));
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
    const int missing = s->members - pl_study_integer(ensemble, "results");
    for (int i = 0; i < PL_OUTCOME_COUNT; ++i) {
        const char *name = pl_outcome_name((pl_outcome)i);
        const int count = pl_study_integer(outcomes, name);
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
    const double time = pl_study_number(horizon, "time");
    if (!is_known) {
        pl_table_add(table, "unknown");
    } else if (isnan(time)) {
        pl_table_format_cell(table, "> %.3g s", pl_study_number(horizon, "last_time"));
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
    json_array_foreach(s->ensembles, index, ensemble)
    {
        char *outcomes = outcomes_text(s, ensemble);
        pl_table_add(&table, pl_json_get_text(ensemble, "name"));
        pl_table_add(&table, outcomes);
        add_horizon(&table, json_object_get(ensemble, "horizon"));
        pl_table_format_cell(&table, "%d", pl_study_integer(ensemble, "invariants.energy_grew"));
        pl_table_number(&table, pl_study_number(ensemble, "invariants.energy_growth"), 3);
        pl_table_format_cell(&table, "%d", pl_study_integer(ensemble, "invariants.fell_through"));
        pl_table_format_cell(&table, "%d", pl_study_integer(ensemble, "invariants.not_finite"));
        free(outcomes);
    }
    pl_document_table(document, "Members", &table);
}

/* The mean and the standard deviation of an observable. */
static void add_observable(pl_table *table, const json_t *sample)
{
    char never[48] = "", text[2][32] = {"-", "-"};
    const double numbers[] = {pl_study_number(sample, "mean"),
                              pl_study_number(sample, "standard_deviation")};
    const int unsettled = pl_study_integer(sample, "unsettled");
    for (int i = 0; i < 2; ++i) {
        if (!isnan(numbers[i])) {
            snprintf(text[i], sizeof text[i], "%.3g", numbers[i]);
        }
    }
    if (unsettled > 0) {
        snprintf(never, sizeof never, " (%d of %zu never)", unsettled,
                 json_array_size(json_object_get(sample, "values")));
    }
    pl_table_format_cell(table, "%s ± %s%s", text[0], text[1], never);
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
    json_array_foreach(s->ensembles, index, ensemble)
    {
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
    pl_table_format_cell(table, "%.4g", pl_study_number(observable_of(a, name), "mean"));
    pl_table_format_cell(table, "%.4g", pl_study_number(observable_of(b, name), "mean"));
    pl_table_number(table, pl_study_number(c, "energy_distance_ratio"), 3);
    pl_table_format_cell(table, "%.3g", pl_study_number(c, "ks"));
    pl_table_number(table, pl_study_number(c, "ks_ratio"), 3);
    pl_table_format_cell(table, "%.2g", pl_study_number(c, "p_corrected"));
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
        json_array_foreach(s->comparisons, index, c)
        {
            if (strcmp(pl_json_get_text(c, "observable"), pl_metric_table[i].name) == 0) {
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
    json_array_foreach(s->ensembles, index, ensemble)
    {
        const json_t *values = json_object_get(observable_of(ensemble, info->name), "values");
        double *numbers = pl_heap_new(json_array_size(values), sizeof *numbers);
        json_array_foreach((json_t *)values, k, value)
        {
            numbers[k] = json_number_value(value);
        }
        if (json_array_size(values) > 0) {
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
    int apart = 0;
    size_t index;
    const json_t *c;
    json_array_foreach(s->comparisons, index, c)
    {
        const char *finding = pl_json_get_text(c, "finding");
        if (finding[0] != '\0') {
            apart += 1;
            pl_document_item(document, "%s.", finding);
        }
    }
    if (index > 0) {
        pl_document_paragraph(document, "%d of %zu comparisons tell the two apart.", apart, index);
    }
}

static void add_scene(const scene *s, pl_document *document)
{
    const json_t *first = json_array_get(s->ensembles, 0);
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
    static const char *const of_scene[] = {"case", NULL};
    const json_t *all = json_object_get(conclusion, "ensembles");
    const double jitter = pl_study_number(conclusion, "jitter");
    size_t index;
    const char *number;
    json_t *scenes = pl_study_groups(all, of_scene), *ensembles, *c;
    document->title = "Ensembles, compared by their end states";
    pl_document_paragraph(
        document,
        "Each ensemble has %d members. Every member starts with each body displaced by up to %g of "
        "its size along each axis and turned by up to %g rad, the same for every engine (seed "
        "%lld). Horizon: when the members of one engine lie farther apart than 1 %% of the "
        "smallest body. Energy grew: members in which it rose, in a step or above the start, by "
        "more than %g of the scene's. Fell through: members with a body beyond a plane. Means are "
        "followed by the standard deviation over members.",
        pl_study_integer(conclusion, "members"), jitter, jitter,
        (long long)json_integer_value(json_object_get(conclusion, "seed")),
        pl_study_number(conclusion, "energy_growth_allowed"));
    pl_document_paragraph(
        document,
        "Told apart: p below %g, by permutation of the energy distance, corrected (Holm) over all "
        "%zu comparisons. The floor is what two ensembles of the same engine differ by on the "
        "mean, from its split halves: the larger of the two engines'.",
        pl_study_number(conclusion, "significance"),
        json_array_size(json_object_get(conclusion, "comparisons")));
    json_object_foreach(scenes, number, ensembles)
    {
        const scene s = {all, ensembles, json_array(), pl_study_integer(conclusion, "members")};
        json_array_foreach(json_object_get(conclusion, "comparisons"), index, c)
        {
            if (json_equal(json_object_get(side(&s, c, "a"), "case"),
                           json_object_get(json_array_get(ensembles, 0), "case"))) {
                json_array_append(s.comparisons, c);
            }
        }
        add_scene(&s, document);
        json_decref(s.comparisons);
    }
    json_decref(scenes);
}

const pl_study pl_ensemble_study = {.name = "ensemble",
                                    .kind = "ensemble",
                                    .conclude = pl_ensemble_conclude,
                                    .document = fill_document};
