/* Concludes from the results of ensembles: plumb.ensemble/1. */
#include "ensemble_report.h"

#include "base/heap.h"
#include "plumb/jitter.h"
#include "two_sample.h"
#include "verdict.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Ensembles ---- */

/* An ensemble: the results of its members. */
typedef struct group {
    char *key;
    int place;       /* in the order of the command */
    json_t *members; /* the numbers of the members -> the newest result */
    json_t *results; /* (members): by number */
    json_t *runs;    /* (members): their hashes */
} group;

typedef struct conclusion {
    group *groups;           /* (count) */
    pl_ensemble_view *views; /* (count) */
    int count;
    int members;
    pl_verdicts verdicts;
    const char *folder;
    json_t *before; /* the conclusion that the folder has; NULL: none */
} conclusion;

static int integer_of(const json_t *object, const char *key)
{
    return (int)json_integer_value(json_object_get(object, key));
}

static const json_t *ensemble_of(const json_t *result)
{
    return json_object_get(result, "ensemble");
}

static pl_status check_results(const json_t *results, pl_error *error)
{
    size_t index;
    const json_t *result;
    json_array_foreach((json_t *)results, index, result)
    {
        if (!json_is_object(json_object_get(json_object_get(result, "study"), "case")) ||
            !json_is_integer(json_object_get(result, "member")) ||
            integer_of(ensemble_of(result), "members") < 1) {
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
    int most = 0;
    json_array_foreach((json_t *)results, index, result)
    {
        const int members = integer_of(ensemble_of(result), "members");
        most = members > most ? members : most;
    }
    return most;
}

/* Adds a result to its ensemble. Of two results of a member the later one counts: the other is of an older edition of
 * the scene. */
static void add_result(conclusion *c, json_t *result)
{
    static const char *const same[] = {
        "scenario", "params", "engine", "engine_binary", "profile", "label", "seed", "study", NULL};
    char *key = pl_study_key(result, same), member[16];
    int i = 0;
    while (i < c->count && strcmp(c->groups[i].key, key) != 0) {
        ++i;
    }
    if (i == c->count) {
        const group added = {.key = pl_heap_copy(key), .members = json_object()};
        pl_push(&c->groups, &c->count, &added, sizeof added);
    }
    c->groups[i].place = integer_of(ensemble_of(result), "place");
    snprintf(member, sizeof member, "%d", integer_of(result, "member"));
    json_object_set(c->groups[i].members, member, result);
    free(key);
}

static int compare_members(const void *left, const void *right)
{
    const json_t *const *a = left, *const *b = right;
    return integer_of(*a, "member") - integer_of(*b, "member");
}

/* Orders the results of a group by member. */
static void order_members(group *g)
{
    const size_t count = json_object_size(g->members);
    json_t **sorted = pl_heap_new(count, sizeof(json_t *)), *result;
    const char *member;
    size_t next = 0;
    json_object_foreach(g->members, member, result)
    {
        sorted[next++] = result;
    }
    qsort(sorted, count, sizeof(json_t *), compare_members);
    g->results = json_array();
    g->runs = json_array();
    for (size_t i = 0; i < count; ++i) {
        json_array_append(g->results, sorted[i]);
        json_array_append(g->runs, json_object_get(sorted[i], "run"));
    }
    free(sorted);
}

static int compare_groups(const void *left, const void *right)
{
    const group *a = left, *b = right;
    return a->place != b->place ? a->place - b->place : strcmp(a->key, b->key);
}

/* Groups the results. Members of another setting have numbers from the number of the setting times the members on: others
 * are of a study with fewer members. */
static void group_results(conclusion *c, const json_t *results)
{
    size_t index;
    json_t *result;
    c->members = most_members(results);
    json_array_foreach((json_t *)results, index, result)
    {
        if (c->members > 0 && integer_of(result, "member") / c->members ==
                                  integer_of(json_object_get(result, "study"), "setting")) {
            add_result(c, result);
        }
    }
    for (int i = 0; i < c->count; ++i) {
        order_members(&c->groups[i]);
    }
    if (c->count > 0) {
        qsort(c->groups, (size_t)c->count, sizeof *c->groups, compare_groups);
    }
}

/* The number of a key: keys are numbered in the order in which they come. Takes the key. */
static int number_of(json_t *numbers, char *key)
{
    const json_t *known = json_object_get(numbers, key);
    const int number =
        known == NULL ? (int)json_object_size(numbers) : (int)json_integer_value(known);
    json_object_set_new(numbers, key, json_integer(number));
    free(key);
    return number;
}

static const json_t *first_of(const group *g)
{
    return json_array_get(g->results, 0);
}

/* Numbers the scenes, the settings and the configurations of the ensembles, and names them. */
static void number_ensembles(conclusion *c)
{
    static const char *const configuration[] = {"engine", "engine_binary", "profile", "label",
                                                NULL};
    json_t *scenes = json_object(), *settings = json_object(), *configurations = json_object();
    for (int i = 0; i < c->count; ++i) {
        pl_ensemble_view *view = &c->views[i];
        const json_t *first = first_of(&c->groups[i]), *study = json_object_get(first, "study");
        const char *label = pl_json_get_text(first, "label"),
                   *against = pl_json_get_text(study, "against");
        char *params = pl_result_to_line(json_object_get(study, "case"));
        view->ensemble = (pl_ensemble){
            .test_case =
                number_of(scenes, pl_heap_format("%s %s %d", pl_json_get_text(first, "scenario"),
                                                 params, integer_of(first, "seed"))),
            .setting =
                against[0] == '\0'
                    ? 0
                    : 1 + number_of(settings,
                                    pl_heap_format("%d %s", integer_of(study, "setting"), against)),
            .reference = json_is_true(json_object_get(study, "converged")),
            .configuration = number_of(configurations, pl_study_key(first, configuration))};
        snprintf(view->name, sizeof view->name, against[0] == '\0' ? "%.250s" : "%.150s [%.100s]",
                 label, against);
        free(params);
    }
    json_decref(scenes);
    json_decref(settings);
    json_decref(configurations);
}

/* Takes the horizon from the conclusion before, if that has an ensemble of exactly these runs. */
static void recall_horizon(const conclusion *c, const json_t *runs, pl_horizon *horizon)
{
    size_t index;
    const json_t *item;
    json_array_foreach(json_object_get(c->before, "ensembles"), index, item)
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
}

static void observe(conclusion *c)
{
    char *trajectories = pl_heap_format("%s/trajectories", c->folder);
    for (int i = 0; i < c->count; ++i) {
        const group *g = &c->groups[i];
        pl_ensemble_view *view = &c->views[i];
        const json_t *size = json_object_get(ensemble_of(first_of(g)), "least_size");
        pl_observations_gather(g->results, &view->observed);
        pl_horizon_find(trajectories, g->runs, json_number_value(size), &view->horizon);
        if (!view->horizon.known) {
            recall_horizon(c, g->runs, &view->horizon);
        }
    }
    free(trajectories);
}

/* ---- plumb.ensemble/1 ---- */

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

static json_t *view_json(const group *g, const pl_ensemble_view *view)
{
    const json_t *first = first_of(g), *study = json_object_get(first, "study");
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
        "{s:i, s:O, s:O, s:o, s:O, s:O, s:b, s:O, s:O, s:i, s:o, s:o, s:o, s:o}", "case",
        view->ensemble.test_case, "scenario", json_object_get(first, "scenario"), "params",
        json_object_get(study, "case"), "name", pl_json_text(view->name), "label",
        json_object_get(first, "label"), "setting", json_object_get(study, "setting"), "converged",
        (int)view->ensemble.reference, "dt",
        json_object_get(json_object_get(first, "settings"), "dt"), "runs", g->runs, "results",
        view->observed.results, "outcomes", outcomes_json(&view->observed), "invariants",
        invariants, "horizon", horizon_json(&view->horizon), "observables", observables);
}

/* A distance over its floor; NAN where there is no floor. */
static double floor_ratio(double value, double floor)
{
    return floor > 0 ? value / floor : (double)NAN;
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

static json_t *conclusion_json(const conclusion *c)
{
    json_t *all = json_array(), *comparisons = json_array();
    for (int i = 0; i < c->count; ++i) {
        json_array_append_new(all, view_json(&c->groups[i], &c->views[i]));
    }
    for (int i = 0; i < c->verdicts.count; ++i) {
        json_array_append_new(comparisons, comparison_json(c->views, &c->verdicts.items[i]));
    }
    return json_pack(
        "{s:s, s:i, s:O, s:f, s:f, s:i, s:f, s:o, s:o}", "schema", "plumb.ensemble/1", "members",
        c->members, "seed", json_object_get(first_of(&c->groups[0]), "seed"), "jitter",
        pl_jitter_amplitude, "significance", pl_significance, "permutations", PL_PERMUTATION_DRAWS,
        "energy_growth_allowed", pl_energy_growth, "ensembles", all, "comparisons", comparisons);
}

static void free_conclusion(conclusion *c)
{
    for (int i = 0; i < c->count; ++i) {
        free(c->groups[i].key);
        json_decref(c->groups[i].members);
        json_decref(c->groups[i].results);
        json_decref(c->groups[i].runs);
        pl_observations_free(&c->views[i].observed);
    }
    pl_verdicts_free(&c->verdicts);
    free(c->groups);
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
    c.views = pl_heap_new((size_t)c.count, sizeof *c.views);
    number_ensembles(&c);
    observe(&c);
    c.verdicts = pl_verdicts_reach(c.views, c.count);
    *outcome = conclusion_json(&c);
    free_conclusion(&c);
    free(path);
    return PL_OK;
}
