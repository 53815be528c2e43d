#include "analysis.h"

#include "analysis_parts.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>

/* Sums over points, of the logarithms of their repeats' costs. */
typedef struct spread {
    double squares; /* of the deviations from the point's mean */
    int freedom;
} spread;

static spread spread_of(const pl_sweep_point *points, int count)
{
    spread all = {0, 0};
    for (int i = 0; i < count; ++i) {
        const pl_sweep_point *point = &points[i];
        double mean = 0;
        for (int k = 0; k < point->sample_count; ++k) {
            mean += log(point->samples[k].cost) / point->sample_count;
        }
        for (int k = 0; k < point->sample_count; ++k) {
            const double off = log(point->samples[k].cost) - mean;
            all.squares += off * off;
        }
        all.freedom += point->sample_count > 1 ? point->sample_count - 1 : 0;
    }
    return all;
}

/* Sets the noise of every scene from its points that were repeated, or, where these are few, from
 * those of all scenes: the machine makes the noise, not the engine. */
static void pl_sweep_take_noise(pl_sweep_analysis *analysis)
{
    const int enough = 10;
    const spread everywhere = spread_of(analysis->points, analysis->point_count);
    for (int p = 0; p < analysis->scene_count; ++p) {
        pl_sweep_scene *scene = &analysis->scenes[p];
        const spread own = spread_of(analysis->points + scene->first, scene->count);
        const spread *known = own.freedom >= enough ? &own : &everywhere;
        scene->noise = known->freedom > 0 ? sqrt(known->squares / known->freedom) : (double)NAN;
    }
}

/* All engines of the kind were run on the scene, and it has an error to be judged by. */
static bool belongs(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, bool whole)
{
    for (int e = 0; e < analysis->engine_count; ++e) {
        if (analysis->engines[e].whole == whole && !pl_sweep_curve_was_run(&scene->curves[e])) {
            return false;
        }
    }
    return scene->primary_error[0] != '\0';
}

/* What the engine pays for the level; INFINITY where it does not reach it. */
static double cost_of(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, int engine,
                      int level)
{
    int reached = scene->curves[engine].cheapest[level];
    return reached < 0 ? (double)INFINITY : analysis->points[reached].cost;
}

static void add_scene(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                      pl_sweep_profile *profile)
{
    double least = (double)INFINITY;
    for (int e = 0; e < analysis->engine_count; ++e) {
        if (analysis->engines[e].whole == profile->whole) {
            least = fmin(least, cost_of(analysis, scene, e, profile->level));
        }
    }
    profile->scenes++;
    for (int e = 0; e < analysis->engine_count && isfinite(least); ++e) {
        double cost = cost_of(analysis, scene, e, profile->level);
        if (analysis->engines[e].whole == profile->whole && isfinite(cost)) {
            double *ratios = profile->ratios + (size_t)e * (size_t)analysis->scene_count;
            ratios[profile->counts[e]++] = cost / least;
        }
    }
}

/* From curves to the profile of each level, of whole engines and of profiles. */
static pl_status pl_profiles_find(pl_sweep_analysis *analysis, pl_error *error)
{
    const size_t engines = (size_t)analysis->engine_count;
    const size_t scenes = (size_t)analysis->scene_count;
    analysis->profiles = calloc(2 * PL_SWEEP_LEVELS, sizeof *analysis->profiles);
    if (analysis->profiles == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for profiles");
    }
    for (int i = 0; i < 2 * PL_SWEEP_LEVELS; ++i) {
        pl_sweep_profile *profile = &analysis->profiles[analysis->profile_count++];
        *profile = (pl_sweep_profile){.level = i % PL_SWEEP_LEVELS,
                                      .whole = i < PL_SWEEP_LEVELS,
                                      .counts = calloc(engines + 1, sizeof(int)),
                                      .ratios = calloc(engines * scenes + 1, sizeof(double))};
        if (profile->counts == NULL || profile->ratios == NULL) {
            return pl_fail(error, PL_NO_MEMORY, "out of memory for profiles of %zu engines",
                           engines);
        }
        for (int p = 0; p < analysis->scene_count; ++p) {
            if (belongs(analysis, &analysis->scenes[p], profile->whole)) {
                add_scene(analysis, &analysis->scenes[p], profile);
            }
        }
        for (size_t e = 0; e < engines; ++e) {
            pl_sort_numbers(profile->ratios + e * scenes, profile->counts[e]);
        }
    }
    return PL_OK;
}

double pl_sweep_share(const pl_sweep_analysis *analysis, const pl_sweep_profile *profile,
                      int engine, double tau)
{
    const double *ratios = profile->ratios + (size_t)engine * (size_t)analysis->scene_count;
    int within = 0;
    while (within < profile->counts[engine] && ratios[within] <= tau) {
        ++within;
    }
    return profile->scenes == 0 ? (double)NAN : (double)within / profile->scenes;
}

/* Counts an engine's points on a scene. */
static void count_points(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, int engine,
                         pl_sweep_curve *curve)
{
    for (int i = scene->first; i < scene->first + scene->count; ++i) {
        const pl_sweep_point *point = &analysis->points[i];
        if (pl_sweep_point_is_of(point, engine)) {
            curve->ok += point->state == PL_SWEEP_OK;
            curve->failed += point->state == PL_SWEEP_FAILED;
            curve->unmeasured += point->state == PL_SWEEP_UNMEASURED;
        }
    }
}

/* `samples` has a place for each point of the analysis; those that are ok are filled. */
static pl_status find_curve(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                            int engine, const pl_sweep_sample *samples, pl_sweep_sample *front,
                            pl_sweep_curve *curve, pl_error *error)
{
    count_points(analysis, scene, engine, curve);
    curve->front = calloc((size_t)curve->ok + 1, sizeof *curve->front);
    if (curve->front == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d points", curve->ok);
    }
    for (int i = scene->first; i < scene->first + scene->count; ++i) {
        const pl_sweep_point *point = &analysis->points[i];
        if (point->state == PL_SWEEP_OK && pl_sweep_point_is_of(point, engine)) {
            curve->front[curve->front_count++] = i;
        }
    }
    curve->front_count = pl_front_find(samples, curve->front, curve->front_count);
    for (int i = 0; i < curve->front_count; ++i) {
        front[i] = samples[curve->front[i]];
    }
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        int i = pl_front_cheapest(front, curve->front_count, pl_sweep_levels[k]);
        curve->cheapest[k] = i < 0 ? -1 : curve->front[i];
    }
    for (int k = 0; k < PL_SWEEP_TIMES; ++k) {
        int i = pl_front_most_exact(front, curve->front_count, pl_sweep_times[k]);
        curve->most_exact[k] = i < 0 ? -1 : curve->front[i];
    }
    return PL_OK;
}

static pl_status find_curves(pl_sweep_analysis *analysis, pl_error *error)
{
    pl_status status = PL_OK;
    const size_t points = (size_t)analysis->point_count;
    pl_sweep_sample *samples = calloc(2 * points + 1, sizeof *samples), *front = samples + points;
    if (samples == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu points", points);
    }
    for (size_t i = 0; i < points; ++i) {
        samples[i] = (pl_sweep_sample){analysis->points[i].cost, analysis->points[i].error};
    }
    for (int p = 0; p < analysis->scene_count && status == PL_OK; ++p) {
        pl_sweep_scene *scene = &analysis->scenes[p];
        analysis->unjudged += scene->primary_error[0] == '\0';
        scene->curves = calloc((size_t)analysis->engine_count + 1, sizeof *scene->curves);
        if (scene->curves == NULL) {
            status = pl_fail(error, PL_NO_MEMORY, "out of memory for curves");
        }
        for (int e = 0; e < analysis->engine_count && status == PL_OK; ++e) {
            status = find_curve(analysis, scene, e, samples, front, &scene->curves[e], error);
        }
    }
    free(samples);
    return status;
}

pl_status pl_sweep_analyse(const json_t *results, pl_sweep_analysis *analysis, pl_error *error)
{
    *analysis = (pl_sweep_analysis){.results = results};
    pl_status status = pl_sweep_gather(results, analysis, error);
    if (status == PL_OK) {
        pl_sweep_take_noise(analysis);
        status = find_curves(analysis, error);
    }
    if (status == PL_OK) {
        status = pl_compare_pairwise(analysis, error);
    }
    if (status == PL_OK) {
        status = pl_list_losses(analysis, error);
    }
    if (status == PL_OK) {
        status = pl_orders_find(analysis, error);
    }
    if (status == PL_OK) {
        status = pl_profiles_find(analysis, error);
    }
    return status;
}

void pl_sweep_analysis_free(pl_sweep_analysis *analysis)
{
    for (int i = 0; i < analysis->point_count; ++i) {
        free(analysis->points[i].samples);
    }
    for (int p = 0; p < analysis->scene_count; ++p) {
        pl_sweep_scene *scene = &analysis->scenes[p];
        for (int e = 0; scene->curves != NULL && e < analysis->engine_count; ++e) {
            free(scene->curves[e].front);
        }
        free(scene->curves);
        free(scene->comparisons);
    }
    for (int i = 0; i < analysis->profile_count; ++i) {
        free(analysis->profiles[i].counts);
        free(analysis->profiles[i].ratios);
    }
    free(analysis->points);
    free(analysis->engines);
    free(analysis->scenes);
    free(analysis->pairs);
    free(analysis->losses);
    free(analysis->orders);
    free(analysis->profiles);
    *analysis = (pl_sweep_analysis){0};
}
