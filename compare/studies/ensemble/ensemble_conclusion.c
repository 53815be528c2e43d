/* Concludes from the results of ensembles: plumb.ensemble/1. */
#include "ensemble.h"

#include "base/heap.h"
#include "plumb/jitter.h"
#include "sample.h"
#include "two_sample.h"
#include "verdict.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Ensembles ---- */

typedef struct conclusion {
    json_t *groups;          /* results by what tells ensembles apart */
    pl_ensemble_view *views; /* (count) */
    int count;
    int members;
    const char *folder;
    json_t *before; /* the conclusion that the folder has; NULL: none */
} conclusion;

static pl_status check_results(const json_t *results, pl_error *error)
{
    size_t index;
    const json_t *result;
    json_array_foreach((json_t *)results, index, result)
    {
        if (!json_is_object(pl_study_get(result, "study.case")) ||
            !json_is_integer(json_object_get(result, "member")) ||
            pl_study_integer(result, "member") < 0 ||
            pl_study_integer(result, "ensemble.members") < 1) {
            return pl_fail(error, PL_BAD_INPUT,
                           "results[%zu]: expected a member of an ensemble, with study.case, "
                           "member and ensemble.members",
                           index);
        }
    }
    return PL_OK;
}

/* The largest number of members that was asked for. */
static int most_members(const json_t *results)
{
    size_t index;
    const json_t *result;
    int most = 1;
    json_array_foreach((json_t *)results, index, result)
    {
        const int members = pl_study_integer(result, "ensemble.members");
        most = members > most ? members : most;
    }
    return most;
}

/* The results of an ensemble by member. Of two results of a member the later one counts: the other is of an older edition
 * of the scene. */
static void order_members(const json_t *group, int members, pl_ensemble_view *view)
{
    json_t **newest = pl_heap_new((size_t)members, sizeof(json_t *)), *result;
    size_t index;
    view->results = json_array();
    view->runs = json_array();
    json_array_foreach((json_t *)group, index, result)
    {
        newest[pl_study_integer(result, "member") % members] = result;
        view->place = pl_study_integer(result, "ensemble.place");
    }
    for (int k = 0; k < members; ++k) {
        json_array_append(view->results, newest[k]);
        json_array_append(view->runs, json_object_get(newest[k], "run"));
    }
    free(newest);
}

static int compare_views(const void *left, const void *right)
{
    const pl_ensemble_view *a = left, *b = right;
    return a->place != b->place ? a->place - b->place : strcmp(a->key, b->key);
}

/* Groups the results. Members of another setting have numbers from the number of the setting times the members on: others
 * are of a study with fewer members. */
static void group_results(conclusion *c, const json_t *results)
{
    static const char *const same[] = {
        "scenario", "params", "engine", "engine_binary", "profile", "label", "seed", "study", NULL};
    json_t *counted = json_array(), *item;
    size_t index;
    const char *key;
    c->members = most_members(results);
    json_array_foreach((json_t *)results, index, item)
    {
        if (pl_study_integer(item, "member") / c->members ==
            pl_study_integer(item, "study.setting")) {
            json_array_append(counted, item);
        }
    }
    c->groups = pl_study_groups(counted, same);
    c->views = pl_heap_new(json_object_size(c->groups), sizeof *c->views);
    json_object_foreach(c->groups, key, item)
    {
        c->views[c->count].key = key;
        order_members(item, c->members, &c->views[c->count++]);
    }
    qsort(c->views, (size_t)c->count, sizeof *c->views, compare_views);
    json_decref(counted);
}

static const json_t *first_of(const pl_ensemble_view *view)
{
    return json_array_get(view->results, 0);
}

/* The number of what a result has at these paths: they are numbered in the order in which they come. */
static int number_of(json_t *numbers, const json_t *result, const char *const *paths)
{
    char *key = pl_study_key(result, paths);
    if (json_object_get(numbers, key) == NULL) {
        json_object_set_new(numbers, key, json_integer((json_int_t)json_object_size(numbers)));
    }
    const json_int_t number = json_integer_value(json_object_get(numbers, key));
    free(key);
    return (int)number;
}

/* Numbers the scenes, the settings and the configurations of the ensembles, and names them. */
static void number_ensembles(conclusion *c)
{
    static const char *const scene[] = {"scenario", "study.case", "seed", NULL};
    static const char *const setting[] = {"study.setting", "study.against", NULL};
    static const char *const configuration[] = {"engine", "engine_binary", "profile", "label",
                                                NULL};
    json_t *scenes = json_object(), *settings = json_object(), *configurations = json_object();
    for (int i = 0; i < c->count; ++i) {
        pl_ensemble_view *view = &c->views[i];
        const json_t *first = first_of(view);
        const char *label = pl_json_get_text(first, "label"),
                   *against = pl_study_text(first, "study.against");
        view->ensemble = (pl_ensemble){
            .test_case = number_of(scenes, first, scene),
            .setting = against[0] == '\0' ? 0 : 1 + number_of(settings, first, setting),
            .reference = json_is_true(pl_study_get(first, "study.converged")),
            .configuration = number_of(configurations, first, configuration)};
        snprintf(view->name, sizeof view->name, against[0] == '\0' ? "%.250s" : "%.150s [%.100s]",
                 label, against);
    }
    json_decref(scenes);
    json_decref(settings);
    json_decref(configurations);
}

/* The horizon that the conclusion before has of exactly these runs; NULL: none. */
static json_t *recall_horizon(const conclusion *c, const json_t *runs)
{
    size_t index;
    const json_t *item;
    json_array_foreach(json_object_get(c->before, "ensembles"), index, item)
    {
        if (json_equal(json_object_get(item, "runs"), runs)) {
            return json_object_get(item, "horizon");
        }
    }
    return NULL;
}

static void observe(conclusion *c)
{
    char *trajectories = pl_heap_format("%s/trajectories", c->folder);
    for (int i = 0; i < c->count; ++i) {
        pl_ensemble_view *view = &c->views[i];
        pl_observations_gather(view->results, &view->observed);
        view->horizon = pl_horizon_find(trajectories, view->runs,
                                        pl_study_number(first_of(view), "ensemble.least_size"));
        json_t *before = recall_horizon(c, view->runs);
        if (json_object_get(view->horizon, "threshold") == NULL &&
            json_object_get(before, "threshold") != NULL) {
            json_decref(view->horizon);
            view->horizon = json_incref(before);
        }
    }
    free(trajectories);
}

/* ---- plumb.ensemble/1 ---- */

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

static json_t *view_json(const pl_ensemble_view *view)
{
    const json_t *first = first_of(view);
    const pl_observations *observed = &view->observed;
    json_t *observables = json_object();
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[i];
        if (pl_is_observable(i)) {
            json_object_set_new(observables, info->name, sample_json(&observed->samples[i], info));
        }
    }
    return json_pack(
        "{s:i, s:O, s:O, s:o, s:O, s:O, s:b, s:O, s:O, s:i, s:O, s:O, s:O, s:o}", "case",
        view->ensemble.test_case, "scenario", json_object_get(first, "scenario"), "params",
        pl_study_get(first, "study.case"), "name", pl_json_text(view->name), "label",
        json_object_get(first, "label"), "setting", pl_study_get(first, "study.setting"),
        "converged", (int)view->ensemble.reference, "dt", pl_study_get(first, "settings.dt"),
        "runs", view->runs, "results", (int)json_array_size(view->results), "outcomes",
        observed->outcomes, "invariants", observed->invariants, "horizon", view->horizon,
        "observables", observables);
}

static json_t *conclusion_json(const conclusion *c)
{
    json_t *all = json_array();
    for (int i = 0; i < c->count; ++i) {
        json_array_append_new(all, view_json(&c->views[i]));
    }
    return json_pack("{s:s, s:i, s:O, s:f, s:f, s:i, s:f, s:o, s:o}", "schema", "plumb.ensemble/1",
                     "members", c->members, "seed", json_object_get(first_of(&c->views[0]), "seed"),
                     "jitter", pl_jitter_amplitude, "significance", pl_significance, "permutations",
                     PL_PERMUTATION_DRAWS, "energy_growth_allowed", pl_energy_growth, "ensembles",
                     all, "comparisons", pl_verdicts_reach(c->views, c->count));
}

static void free_conclusion(conclusion *c)
{
    for (int i = 0; i < c->count; ++i) {
        json_decref(c->views[i].results);
        json_decref(c->views[i].runs);
        json_decref(c->views[i].horizon);
        pl_observations_free(&c->views[i].observed);
    }
    json_decref(c->groups);
    free(c->views);
    json_decref(c->before);
}

pl_status pl_ensemble_conclude(const json_t *results, const char *folder, json_t **outcome,
                               pl_error *error)
{
    conclusion c = {.folder = folder};
    pl_status status = check_results(results, error);
    if (status != PL_OK) {
        return status;
    }
    char *path = pl_heap_format("%s/ensemble.json", folder);
    c.before = json_load_file(path, 0, NULL);
    group_results(&c, results);
    number_ensembles(&c);
    observe(&c);
    *outcome = conclusion_json(&c);
    free_conclusion(&c);
    free(path);
    return PL_OK;
}
