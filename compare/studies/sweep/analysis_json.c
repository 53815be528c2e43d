/* The analysis of a sweep as plumb.sweep/2. */
#include "analysis.h"

#include "results/result.h"

#include <math.h>
#include <string.h>

static json_t *number(double value)
{
    return pl_json_number_or_null(value);
}

static json_t *text(const char *value)
{
    return pl_json_text(value);
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

static json_t *ratio_json(const pl_sweep_ratio *ratio)
{
    if (isnan(ratio->value)) {
        return json_null();
    }
    return json_pack("{s:o, s:o, s:o}", "value", number(ratio->value), "low", number(ratio->low),
                     "high", number(ratio->high));
}

static const char *attained_name(pl_attained_by attained)
{
    static const char *const names[] = {"neither", "first only", "second only", "both"};
    return names[attained];
}

static json_t *engines_json(const pl_sweep_analysis *analysis)
{
    json_t *array = json_array();
    for (int i = 0; i < analysis->engine_count; ++i) {
        const pl_sweep_engine *engine = &analysis->engines[i];
        json_array_append_new(array, json_pack("{s:o, s:b, s:b, s:b}", "name", text(engine->name),
                                               "home", (int)engine->is_home, "all_profiles",
                                               (int)(engine->kind == PL_SWEEP_WHOLE), "as_shipped",
                                               (int)(engine->kind == PL_SWEEP_SHIPPED)));
    }
    return array;
}

static json_t *point_json(const pl_sweep_point *point)
{
    static const char *const states[] = {"ok", "failed", "unmeasured", "unsupported"};
    json_t *costs = json_array();
    for (int i = 0; i < point->sample_count; ++i) {
        json_array_append_new(costs, json_real(point->samples[i].cost));
    }
    json_t *object = json_pack(
        "{s:i, s:i, s:i, s:o, s:O?, s:f, s:s, s:o, s:o, s:i}", "scene", point->scene, "engine",
        point->engines[PL_SWEEP_WHOLE], "profile", point->engines[PL_SWEEP_PROFILE], "label",
        text(point->label), "settings", json_object_get(point->row, "settings"), "dt", point->dt,
        "state", states[point->state], "outcome", text(point->outcome), "reason",
        point->reason[0] == '\0' ? json_null() : text(point->reason), "repeats", point->repeats);
    if (object != NULL) {
        json_object_set_new(object, "changes", json_integer(point->changes));
        json_object_set_new(object, "change",
                            point->change[0] == '\0' ? json_null() : text(point->change));
        json_object_set_new(object, "as_shipped",
                            json_boolean(point->engines[PL_SWEEP_SHIPPED] >= 0));
    }
    if (object != NULL && point->state == PL_SWEEP_OK) {
        json_object_set_new(object, "cost", number(point->cost));
        json_object_set_new(object, "cost_mad", number(point->cost_mad));
        json_object_set_new(object, "costs", json_incref(costs));
        json_object_set_new(object, "error", number(point->error));
        json_object_set_new(object, "error_as_found", number(point->raw_error));
        json_object_set_new(object, "instructions", number(point->instructions));
    }
    json_decref(costs);
    return object;
}

static json_t *points_json(const pl_sweep_analysis *analysis)
{
    json_t *array = json_array();
    for (int i = 0; i < analysis->point_count; ++i) {
        json_array_append_new(array, point_json(&analysis->points[i]));
    }
    return array;
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
                     pl_sweep_curve_settings(curve), "ok", curve->ok, "failed", curve->failed,
                     "unmeasured", curve->unmeasured, "front",
                     places(curve->front, curve->front_count), "cheapest_at_level",
                     places(curve->cheapest, PL_SWEEP_LEVELS), "cost_at_level", costs,
                     "most_exact_at_time", places(curve->most_exact, PL_SWEEP_TIMES));
}

/* Who reached a level, the ratios there, and the settings that they are of. */
static json_t *level_json(const pl_sweep_scene *scene, const pl_sweep_pair *pair, int index, int k)
{
    const pl_pairwise_comparison *comparison = &scene->comparisons[index];
    return json_pack(
        "{s:s, s:o, s:o, s:o, s:o, s:o}", "reached", attained_name(comparison->at_error[k]),
        "first_point", place(scene->curves[pair->first].cheapest[k]), "second_point",
        place(scene->curves[pair->second].cheapest[k]), "speed", ratio_json(&comparison->speed[k]),
        "speed_between", ratio_json(&comparison->speed_between[k]), "instructions",
        number(comparison->instructions[k]));
}

static json_t *times_json(const pl_pairwise_comparison *comparison)
{
    json_t *times = json_array();
    for (int k = 0; k < PL_SWEEP_TIMES; ++k) {
        if (comparison->at_cost[k] == PL_ATTAINED_BY_NEITHER) {
            continue;
        }
        json_array_append_new(times, json_pack("{s:f, s:s, s:o, s:o}", "time", pl_sweep_times[k],
                                               "reached", attained_name(comparison->at_cost[k]),
                                               "exactness", ratio_json(&comparison->exactness[k]),
                                               "exactness_between",
                                               ratio_json(&comparison->exactness_between[k])));
    }
    return times;
}

/* A pair of whole engines also has the same as shipped. */
static json_t *comparison_json(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                               int index)
{
    const pl_sweep_pair *pair = &analysis->pairs[index];
    const bool has_shipped = pair->shipped >= 0 && scene->comparisons[pair->shipped].run;
    json_t *levels = json_array();
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        json_t *level = level_json(scene, pair, index, k);
        json_object_set_new(level, "level", json_real(pl_sweep_levels[k]));
        if (has_shipped) {
            json_object_set_new(
                level, "as_shipped",
                level_json(scene, &analysis->pairs[pair->shipped], pair->shipped, k));
        }
        json_array_append_new(levels, level);
    }
    return json_pack("{s:i, s:i, s:o, s:o}", "first", pair->first, "second", pair->second, "levels",
                     levels, "times", times_json(&scene->comparisons[index]));
}

/* Whether a pair has an entry of its own; one as shipped is in that of the whole engines. */
static bool is_listed(const pl_sweep_analysis *analysis, int pair)
{
    return analysis->engines[analysis->pairs[pair].first].kind != PL_SWEEP_SHIPPED;
}

static json_t *scene_json(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene)
{
    json_t *curves = json_array(), *comparisons = json_array();
    json_t *params = json_copy(json_object_get(scene->row, "params"));
    json_object_del(params, "dt");
    for (int e = 0; e < analysis->engine_count; ++e) {
        if (pl_sweep_curve_was_run(&scene->curves[e])) {
            json_array_append_new(curves, curve_json(analysis, &scene->curves[e], e));
        }
    }
    for (int i = 0; i < analysis->pair_count; ++i) {
        if (scene->comparisons[i].run && is_listed(analysis, i)) {
            json_array_append_new(comparisons, comparison_json(analysis, scene, i));
        }
    }
    return json_pack("{s:o, s:o, s:o, s:O?, s:o, s:o, s:o, s:o, s:o}", "name", text(scene->name),
                     "scenario", text(scene->scenario), "params", params, "seed",
                     json_object_get(scene->row, "seed"), "primary_error",
                     text(scene->primary_error), "unit", text(scene->unit), "noise",
                     number(scene->noise), "curves", curves, "pairs", comparisons);
}

static json_t *scenes_json(const pl_sweep_analysis *analysis)
{
    json_t *array = json_array();
    for (int i = 0; i < analysis->scene_count; ++i) {
        json_array_append_new(array, scene_json(analysis, &analysis->scenes[i]));
    }
    return array;
}

static json_t *mean_json(const pl_sweep_pair *pair, int k)
{
    return json_pack("{s:o, s:i, s:i, s:i, s:i}", "mean_speed", ratio_json(&pair->mean[k]), "both",
                     pair->both[k], "first_only", pair->first_only[k], "second_only",
                     pair->second_only[k], "neither",
                     pair->scenes - pair->both[k] - pair->first_only[k] - pair->second_only[k]);
}

static json_t *pairs_json(const pl_sweep_analysis *analysis)
{
    json_t *array = json_array();
    for (int i = 0; i < analysis->pair_count; ++i) {
        const pl_sweep_pair *pair = &analysis->pairs[i];
        json_t *levels = json_array();
        for (int k = 0; k < PL_SWEEP_LEVELS && is_listed(analysis, i); ++k) {
            json_t *level = mean_json(pair, k);
            json_object_set_new(level, "level", json_real(pl_sweep_levels[k]));
            if (pair->shipped >= 0) {
                json_object_set_new(level, "as_shipped",
                                    mean_json(&analysis->pairs[pair->shipped], k));
            }
            json_array_append_new(levels, level);
        }
        if (is_listed(analysis, i)) {
            json_array_append_new(array, json_pack("{s:i, s:i, s:i, s:O}", "first", pair->first,
                                                   "second", pair->second, "scenes", pair->scenes,
                                                   "levels", levels));
        }
        json_decref(levels);
    }
    return array;
}

static json_t *losses_json(const pl_sweep_analysis *analysis)
{
    json_t *array = json_array();
    for (int i = 0; i < analysis->loss_count; ++i) {
        const pl_sweep_loss *loss = &analysis->losses[i];
        const pl_sweep_pair *pair = &analysis->pairs[loss->pair];
        json_array_append_new(
            array,
            json_pack("{s:i, s:i, s:i, s:f, s:s, s:o, s:o, s:o, s:b}", "scene", loss->scene,
                      "first", pair->first, "second", pair->second, "level",
                      pl_sweep_levels[loss->level], "reached", attained_name(loss->attained),
                      "first_point", place(loss->first), "second_point", place(loss->second),
                      "speed", ratio_json(&loss->speed), "within_noise", (int)loss->within_noise));
    }
    return array;
}

static json_t *orders_json(const pl_sweep_analysis *analysis)
{
    static const char *const kinds[] = {"found", "too few time steps", "exact", "not converging"};
    json_t *array = json_array();
    for (int i = 0; i < analysis->order_count; ++i) {
        const pl_sweep_order *order = &analysis->orders[i];
        json_array_append_new(
            array,
            json_pack("{s:i, s:i, s:i, s:s, s:o, s:o, s:o, s:o, s:i, s:i}", "scene", order->scene,
                      "engine", order->engine, "point", order->first, "finding", kinds[order->kind],
                      "order", number(order->order), "deviation", number(order->deviation),
                      "dt_low", number(order->dt_low), "dt_high", number(order->dt_high), "used",
                      order->used, "total", order->total));
    }
    return array;
}

static json_t *profiles_json(const pl_sweep_analysis *analysis)
{
    json_t *array = json_array();
    for (int i = 0; i < analysis->profile_count; ++i) {
        const pl_sweep_profile *profile = &analysis->profiles[i];
        json_t *engines = json_array();
        for (int e = 0; e < analysis->engine_count; ++e) {
            const double *ratios = profile->ratios + (size_t)e * (size_t)analysis->scene_count;
            if (analysis->engines[e].kind == profile->kind) {
                json_array_append_new(engines, json_pack("{s:i, s:o}", "engine", e, "ratios",
                                                         numbers(ratios, profile->counts[e])));
            }
        }
        json_array_append_new(array, json_pack("{s:f, s:b, s:i, s:o}", "level",
                                               pl_sweep_levels[profile->level], "all_profiles",
                                               (int)(profile->kind == PL_SWEEP_WHOLE), "scenes",
                                               profile->scenes, "engines", engines));
    }
    return array;
}

json_t *pl_sweep_to_json(const pl_sweep_analysis *analysis)
{
    return json_pack(
        "{s:s, s:i, s:f, s:i, s:o, s:o, s:b, s:b, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "schema",
        "plumb.sweep/2", "runs", analysis->run_count, "error_floor", pl_sweep_error_floor, "draws",
        PL_BOOTSTRAP_REPLICATES, "levels", numbers(pl_sweep_levels, PL_SWEEP_LEVELS), "times",
        numbers(pl_sweep_times, PL_SWEEP_TIMES), "several_hosts", (int)analysis->several_hosts,
        "several_builds", (int)analysis->several_builds, "engines", engines_json(analysis),
        "losses", losses_json(analysis), "pairs", pairs_json(analysis), "profiles",
        profiles_json(analysis), "orders", orders_json(analysis), "scenes", scenes_json(analysis),
        "points", points_json(analysis));
}
