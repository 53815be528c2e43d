/* The analysis of a sweep as plumb.sweep/2. */
#include "analysis.h"

#include "base/heap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static json_t *number(double value)
{
    return pl_json_number_or_null(value);
}

static json_t *text(const char *value)
{
    return pl_json_text(value);
}

/* The text, or null if it is empty. */
static json_t *text_or_null(const char *value)
{
    return value[0] == '\0' ? json_null() : text(value);
}

/* An index; null for none. */
static json_t *place(int index)
{
    return index < 0 ? json_null() : json_integer(index);
}

static json_t *places(const int *indices, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; ++i) {
        json_array_append_new(array, place(indices[i]));
    }
    return array;
}

static json_t *numbers(const double *values, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; ++i) {
        json_array_append_new(array, number(values[i]));
    }
    return array;
}

/* An array of what `make` gives for each index; what is NULL is left out. */
static json_t *list(const pl_sweep_analysis *analysis, int count,
                    json_t *(*make)(const pl_sweep_analysis *analysis, int index))
{
    json_t *array = json_array();
    for (int i = 0; i < count; ++i) {
        json_array_append_new(array, make(analysis, i));
    }
    return array;
}

static json_t *ratio_json(const pl_sweep_ratio *ratio)
{
    return isnan(ratio->value) ? json_null()
                               : json_pack("{s:o, s:o, s:o}", "value", number(ratio->value), "low",
                                           number(ratio->low), "high", number(ratio->high));
}

static json_t *attained_json(pl_attained_by attained)
{
    static const char *const names[] = {"neither", "first only", "second only", "both"};
    return json_string(names[attained]);
}

static json_t *engine_json(const pl_sweep_analysis *analysis, int i)
{
    const pl_sweep_engine *engine = &analysis->engines[i];
    return json_pack("{s:o, s:b, s:b, s:b}", "name", text(engine->name), "home",
                     (int)engine->is_home, "all_profiles", (int)(engine->kind == PL_SWEEP_WHOLE),
                     "as_shipped", (int)(engine->kind == PL_SWEEP_SHIPPED));
}

/* ---- Points and scenes ---- */

static void add_numbers(const pl_sweep_point *point, json_t *object)
{
    json_t *costs = json_array();
    for (int i = 0; i < point->sample_count; ++i) {
        json_array_append_new(costs, json_real(point->samples[i].cost));
    }
    json_t *values = json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "cost", number(point->cost),
                               "cost_mad", number(point->cost_mad), "costs", costs, "error",
                               number(point->error), "error_as_found", number(point->raw_error),
                               "instructions", number(point->instructions));
    json_object_update(object, values);
    json_decref(values);
}

static json_t *point_json(const pl_sweep_analysis *analysis, int i)
{
    static const char *const states[] = {"ok", "failed", "unmeasured", "unsupported"};
    const pl_sweep_point *point = &analysis->points[i];
    json_t *object = json_pack(
        "{s:i, s:i, s:i, s:b, s:o, s:O?, s:f, s:s, s:o, s:o, s:i, s:i, s:o}", "scene", point->scene,
        "engine", point->engines[PL_SWEEP_WHOLE], "profile", point->engines[PL_SWEEP_PROFILE],
        "as_shipped", (int)(point->engines[PL_SWEEP_SHIPPED] >= 0), "label",
        text(point->row->label), "settings", json_object_get(point->row->result, "settings"), "dt",
        point->dt, "state", states[point->state], "outcome",
        text(pl_outcome_name(point->row->outcome)), "reason", text_or_null(point->reason),
        "repeats", point->repeats, "changes", point->changes, "change",
        text_or_null(point->change));
    if (point->state == PL_SWEEP_OK) {
        add_numbers(point, object);
    }
    return object;
}

static json_t *curve_json(const pl_sweep_analysis *analysis, const pl_sweep_curve *curve,
                          int engine)
{
    json_t *costs = json_array();
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        int reached = curve->cheapest[k];
        json_array_append_new(costs,
                              reached < 0 ? json_null() : number(analysis->points[reached].cost));
    }
    return json_pack("{s:i, s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:o}", "engine", engine, "settings",
                     curve->tried, "ok", curve->ok, "failed", curve->failed, "unmeasured",
                     curve->unmeasured, "front", places(curve->front, curve->front_count),
                     "cheapest_at_level", places(curve->cheapest, PL_SWEEP_LEVELS), "cost_at_level",
                     costs, "most_exact_at_time", places(curve->most_exact, PL_SWEEP_TIMES));
}

/* Who reached a level, the ratios there, and the settings that they are of. */
static json_t *level_json(const pl_sweep_scene *scene, const pl_sweep_pair *pair, int index, int k)
{
    const pl_pairwise_comparison *comparison = &scene->comparisons[index];
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "reached",
                     attained_json(comparison->at_error[k]), "first_point",
                     place(scene->curves[pair->first].cheapest[k]), "second_point",
                     place(scene->curves[pair->second].cheapest[k]), "speed",
                     ratio_json(&comparison->ratios[PL_SPEED + k]), "speed_between",
                     ratio_json(&comparison->ratios[PL_SPEED_BETWEEN + k]), "instructions",
                     number(comparison->instructions[k]));
}

static json_t *times_json(const pl_pairwise_comparison *comparison)
{
    json_t *times = json_array();
    for (int k = 0; k < PL_SWEEP_TIMES; ++k) {
        if (comparison->at_cost[k] != PL_ATTAINED_BY_NEITHER) {
            json_array_append_new(
                times,
                json_pack("{s:f, s:o, s:o, s:o}", "time", pl_sweep_times[k], "reached",
                          attained_json(comparison->at_cost[k]), "exactness",
                          ratio_json(&comparison->ratios[PL_EXACTNESS + k]), "exactness_between",
                          ratio_json(&comparison->ratios[PL_EXACTNESS_BETWEEN + k])));
        }
    }
    return times;
}

/* Whether a pair has an entry of its own; one as shipped is in that of the whole engines. */
static bool is_listed(const pl_sweep_analysis *analysis, int pair)
{
    return analysis->engines[analysis->pairs[pair].first].kind != PL_SWEEP_SHIPPED;
}

/* Whether tables show a pair. */
static bool is_shown(const pl_sweep_analysis *analysis, int pair)
{
    return analysis->engines[analysis->pairs[pair].first].kind == analysis->shown;
}

/* A pair of whole engines also has the same as shipped. */
static json_t *comparison_json(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                               int index)
{
    const pl_sweep_pair *pair = &analysis->pairs[index];
    const int shipped = pair->shipped;
    json_t *levels = json_array();
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        json_t *level = level_json(scene, pair, index, k);
        json_object_set_new(level, "level", json_real(pl_sweep_levels[k]));
        if (shipped >= 0 && scene->comparisons[shipped].run) {
            json_object_set_new(level, "as_shipped",
                                level_json(scene, &analysis->pairs[shipped], shipped, k));
        }
        json_array_append_new(levels, level);
    }
    return json_pack("{s:i, s:i, s:b, s:o, s:o}", "first", pair->first, "second", pair->second,
                     "shown", (int)is_shown(analysis, index), "levels", levels, "times",
                     times_json(&scene->comparisons[index]));
}

static json_t *scene_json(const pl_sweep_analysis *analysis, int p)
{
    const pl_sweep_scene *scene = &analysis->scenes[p];
    json_t *curves = json_array(), *comparisons = json_array();
    const pl_result_row *row = scene->of->row;
    json_t *params = json_copy(json_object_get(row->result, "params"));
    json_object_del(params, "dt");
    for (int e = 0; e < analysis->engine_count; ++e) {
        if (scene->curves[e].tried > 0) {
            json_array_append_new(curves, curve_json(analysis, &scene->curves[e], e));
        }
    }
    for (int i = 0; i < analysis->pair_count; ++i) {
        if (scene->comparisons[i].run && is_listed(analysis, i)) {
            json_array_append_new(comparisons, comparison_json(analysis, scene, i));
        }
    }
    return json_pack("{s:o, s:o, s:o, s:O?, s:o, s:o, s:o, s:o, s:o}", "name",
                     text(scene->of->name), "scenario", text(row->scenario), "params", params,
                     "seed", json_object_get(row->result, "seed"), "primary_error",
                     text(row->primary_error), "unit", text(scene->unit), "noise",
                     number(scene->noise), "curves", curves, "pairs", comparisons);
}

/* ---- All scenes ---- */

static json_t *mean_json(const pl_sweep_pair *pair, int k)
{
    return json_pack("{s:o, s:i, s:i, s:i, s:i}", "mean_speed", ratio_json(&pair->mean[k]), "both",
                     pair->reached[PL_ATTAINED_BY_BOTH][k], "first_only",
                     pair->reached[PL_ATTAINED_BY_FIRST_ONLY][k], "second_only",
                     pair->reached[PL_ATTAINED_BY_SECOND_ONLY][k], "neither",
                     pair->reached[PL_ATTAINED_BY_NEITHER][k]);
}

static json_t *pair_json(const pl_sweep_analysis *analysis, int i)
{
    const pl_sweep_pair *pair = &analysis->pairs[i];
    if (!is_listed(analysis, i)) {
        return NULL;
    }
    json_t *levels = json_array();
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        json_t *level = mean_json(pair, k);
        json_object_set_new(level, "level", json_real(pl_sweep_levels[k]));
        if (pair->shipped >= 0) {
            json_object_set_new(level, "as_shipped", mean_json(&analysis->pairs[pair->shipped], k));
        }
        json_array_append_new(levels, level);
    }
    return json_pack("{s:i, s:i, s:b, s:i, s:o}", "first", pair->first, "second", pair->second,
                     "shown", (int)is_shown(analysis, i), "scenes", pair->scenes, "levels", levels);
}

/* ---- Losses ---- */

/* Without an interval, times within 10 % are equal. */
static const double equal_within = 0.1;

/* A level at which the front of the second engine of a pair is ahead of the first, the home engine's: it is cheaper,
 * or the first has no point. */
typedef struct loss {
    json_t *json;
    int rank;
    double speed; /* < 1; NAN: the first has no point */
    int number;   /* by scene, pair and level */
} loss;

static int compare_losses(const void *left, const void *right)
{
    const loss *a = left, *b = right;
    const int by_speed = (a->speed > b->speed) - (a->speed < b->speed);
    return a->rank != b->rank ? a->rank - b->rank
           : by_speed != 0    ? by_speed
                              : a->number - b->number;
}

/* A loss whose interval contains 1 is within noise; without an interval, one above 0.9 is. Errors up to 1e-3 come first,
 * in them losses beyond noise, in those the ones where the first has no point. */
static loss make_loss(const pl_sweep_analysis *analysis, int p, int index, int level)
{
    const pl_sweep_scene *scene = &analysis->scenes[p];
    const pl_sweep_pair *pair = &analysis->pairs[index];
    const pl_sweep_curve *first = &scene->curves[pair->first];
    const pl_attained_by attained = scene->comparisons[index].at_error[level];
    const pl_sweep_ratio *speed = &scene->comparisons[index].ratios[PL_SPEED + level];
    const bool both = attained == PL_ATTAINED_BY_BOTH;
    const bool within_noise =
        both && (isnan(speed->low) ? speed->value * (1 + equal_within) > 1 : speed->high >= 1);
    json_t *json =
        json_pack("{s:i, s:i, s:i, s:f, s:o, s:o, s:o, s:o, s:b, s:i}", "scene", p, "first",
                  pair->first, "second", pair->second, "level", pl_sweep_levels[level], "reached",
                  attained_json(attained), "first_point", place(first->cheapest[level]),
                  "second_point", place(scene->curves[pair->second].cheapest[level]), "speed",
                  ratio_json(speed), "within_noise", (int)within_noise, "settings", first->tried);
    return (loss){json, 4 * (level < PL_SWEEP_MATCHED_LEVEL) + 2 * within_noise + both,
                  speed->value, 0};
}

/* Whether a pair can lose on a scene. */
static bool is_judged(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, int pair)
{
    return analysis->engines[analysis->pairs[pair].first].is_home && is_shown(analysis, pair) &&
           scene->comparisons[pair].run;
}

/* Counts the comparisons, by scene, pair with the home engine and level, where one or both have a point. */
static json_t *losses_json(const pl_sweep_analysis *analysis, int *compared)
{
    json_t *array = json_array();
    loss *losses = NULL;
    int count = 0;
    *compared = 0;
    for (int n = 0; n < analysis->scene_count * analysis->pair_count * PL_SWEEP_LEVELS; ++n) {
        const int level = n % PL_SWEEP_LEVELS, pair = n / PL_SWEEP_LEVELS % analysis->pair_count;
        const int p = n / PL_SWEEP_LEVELS / analysis->pair_count;
        const pl_pairwise_comparison *comparison = &analysis->scenes[p].comparisons[pair];
        if (is_judged(analysis, &analysis->scenes[p], pair)) {
            const pl_attained_by attained = comparison->at_error[level];
            *compared += attained != PL_ATTAINED_BY_NEITHER;
            if (attained == PL_ATTAINED_BY_SECOND_ONLY ||
                comparison->ratios[PL_SPEED + level].value < 1) {
                loss made = make_loss(analysis, p, pair, level);
                made.number = n;
                pl_push(&losses, &count, &made, sizeof made);
            }
        }
    }
    if (count > 0) {
        qsort(losses, (size_t)count, sizeof *losses, compare_losses);
    }
    for (int i = 0; i < count; ++i) {
        json_array_append_new(array, losses[i].json);
    }
    free(losses);
    return array;
}

/* Whether a profile has several points on a scene: other settings or time steps. */
static bool is_varied(const pl_sweep_analysis *analysis)
{
    bool found = false;
    for (int i = 0; i < analysis->scene_count * analysis->engine_count; ++i) {
        const int e = i % analysis->engine_count;
        found |= analysis->engines[e].kind == PL_SWEEP_PROFILE &&
                 analysis->scenes[i / analysis->engine_count].curves[e].tried > 1;
    }
    return found;
}

/* ---- In words ---- */

/* How many comparisons the home engine loses, or without one how many pairs were compared. */
static char *statement_of(const pl_sweep_analysis *analysis, const json_t *losses, int compared)
{
    const char *home = analysis->results->home;
    bool others = false;
    const int count = (int)json_array_size(losses);
    int within = 0, fine = 0, pairs = 0;
    size_t index;
    const json_t *item;
    for (int i = 0; i < analysis->engine_count; ++i) {
        others |= !analysis->engines[i].is_home;
    }
    json_array_foreach(losses, index, item)
    {
        within += json_is_true(json_object_get(item, "within_noise"));
        fine += pl_study_number(item, "level") <= pl_sweep_levels[PL_SWEEP_MATCHED_LEVEL];
    }
    for (int i = 0; i < analysis->pair_count; ++i) {
        pairs += is_shown(analysis, i);
    }
    if (home == NULL) {
        return pl_heap_format("%d %s of engines compared.", pairs, pairs == 1 ? "pair" : "pairs");
    }
    if (!others) {
        return pl_heap_copy("Nothing was compared: these results hold no other engine.");
    }
    if (compared == 0) {
        return pl_heap_format("Nothing was compared: on no scene did %s or another engine that was "
                              "run on it reach any of the errors.",
                              home);
    }
    if (count == 0) {
        return pl_heap_format("No losses: in none of %d comparisons (scene, engine, error) is "
                              "another engine's front ahead of that of %s.",
                              compared, home);
    }
    return pl_heap_format("Another engine's front is ahead of that of %s in %d of %d comparisons "
                          "(scene, engine, error): in %d at errors up to 1e-3, in %d at larger "
                          "ones; %d of all are within noise.",
                          home, count, compared, fine, count - fine, within);
}

/* Which engines' adapters conformance checks have not verified; "" where all have. */
static char *unverified_of(const pl_sweep_analysis *analysis)
{
    pl_text_buffer said = {0};
    for (int i = 0; i < analysis->engine_count; ++i) {
        const pl_sweep_engine *engine = &analysis->engines[i];
        if (engine->unverified != NULL) {
            pl_text_format(&said, "%s %s",
                           said.length > 0
                               ? ""
                               : "Not verified, so that a difference may be the adapter's: run "
                                 "plumb check-engine",
                           engine->unverified[0] != '\0' ? engine->unverified : engine->name);
        }
    }
    pl_text_add(&said, said.length > 0 ? "." : "");
    return pl_text_take(&said);
}

/* Sets the text, unless it is empty, and frees it. */
static void set_said(json_t *json, const char *key, char *said)
{
    if (said[0] != '\0') {
        json_object_set_new(json, key, text(said));
    }
    free(said);
}

json_t *pl_sweep_to_json(const pl_sweep_analysis *analysis)
{
    int compared;
    json_t *losses = losses_json(analysis, &compared);
    json_t *json = json_pack(
        "{s:s, s:i, s:b, s:f, s:i, s:o, s:o, s:b, s:b, s:o, s:o, s:o, s:o, s:o, s:o, s:o}",
        "schema", "plumb.sweep/2", "runs", analysis->results->row_count, "varied",
        (int)is_varied(analysis), "error_floor", pl_sweep_error_floor, "draws",
        PL_BOOTSTRAP_REPLICATES, "levels", numbers(pl_sweep_levels, PL_SWEEP_LEVELS), "times",
        numbers(pl_sweep_times, PL_SWEEP_TIMES), "several_hosts",
        (int)analysis->results->several_hosts, "several_builds", (int)analysis->several_builds,
        "engines", list(analysis, analysis->engine_count, engine_json), "losses", losses, "pairs",
        list(analysis, analysis->pair_count, pair_json), "profiles", pl_profiles_find(analysis),
        "orders", pl_orders_find(analysis), "scenes",
        list(analysis, analysis->scene_count, scene_json), "points",
        list(analysis, analysis->point_count, point_json));
    if (analysis->results->home != NULL) {
        json_object_set_new(json, "home", json_string(analysis->results->home));
    }
    char *statement = statement_of(analysis, losses, compared);
    set_said(json, "statement",
             analysis->unjudged == 0
                 ? pl_heap_copy(statement)
                 : pl_heap_format("%s %d of %d scenes have no primary error and are not judged.",
                                  statement, analysis->unjudged, analysis->scene_count));
    set_said(json, "warning",
             pl_heap_format("%s%s",
                            analysis->results->several_hosts
                                ? "These runs come from several processors: ratios of time between "
                                  "them mean little. "
                                : "",
                            analysis->several_builds
                                ? "These runs come from several builds of plumb or versions of an "
                                  "engine, which share a front here. "
                                : ""));
    set_said(json, "unverified", unverified_of(analysis));
    free(statement);
    return json;
}

json_t *pl_sweep_conclude(const pl_result_table *results)
{
    pl_sweep_analysis analysis;
    pl_sweep_analyse(results, &analysis);
    json_t *conclusion = pl_sweep_to_json(&analysis);
    pl_sweep_analysis_free(&analysis);
    return conclusion;
}
