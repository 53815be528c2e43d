#include "analysis.h"

#include "analysis_front.h"
#include "analysis_noise.h"
#include "analysis_order.h"
#include "analysis_pairwise.h"
#include "analysis_profile.h"
#include "analysis_rows.h"

#include <stdlib.h>

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
