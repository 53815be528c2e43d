/* Makes the analysis of a sweep from its parts: noise and curves. */
#include "analysis.h"

#include "base/heap.h"
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

/* Sets the noise of every scene from its points that were repeated; where these are few, from those
 * of all scenes, because the noise is of the machine and not of the engine. */
static void estimate_noise(pl_sweep_analysis *analysis)
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

/* ---- Curves ---- */

static void find_curve(const pl_front_choice *of, int first, int engine, pl_sweep_curve *curve)
{
    for (int i = 0; i < of->count; ++i) {
        const pl_sweep_point *point = &of->points[i];
        if (pl_sweep_point_is_of(point, engine)) {
            curve->ok += point->state == PL_SWEEP_OK;
            curve->failed += point->state == PL_SWEEP_FAILED;
            curve->unmeasured += point->state == PL_SWEEP_UNMEASURED;
            curve->tried += point->state != PL_SWEEP_UNSUPPORTED;
        }
    }
    const int count = pl_front_of(of, engine, &curve->reading);
    for (int i = 0; i < count; ++i) {
        const int point = first + of->order[i];
        pl_push(&curve->front, &curve->front_count, &point, sizeof point);
    }
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        const int i = pl_front_cheapest(of->front, count, pl_sweep_levels[k]);
        curve->cheapest[k] = i < 0 ? -1 : curve->front[i];
    }
    for (int k = 0; k < PL_SWEEP_TIMES; ++k) {
        const int i = pl_front_most_exact(of->front, count, pl_sweep_times[k]);
        curve->most_exact[k] = i < 0 ? -1 : curve->front[i];
    }
}

static void find_curves(pl_sweep_analysis *analysis, pl_sweep_scene *scene)
{
    pl_front_choice of = pl_front_begin(analysis, scene);
    for (int i = 0; i < scene->count; ++i) {
        of.samples[i] = (pl_sweep_sample){of.points[i].cost, of.points[i].error};
    }
    analysis->unjudged += scene->of->row->primary_error[0] == '\0';
    scene->curves = pl_heap_new((size_t)analysis->engine_count, sizeof *scene->curves);
    for (int e = 0; e < analysis->engine_count; ++e) {
        find_curve(&of, scene->first, e, &scene->curves[e]);
    }
    pl_front_end(&of);
}

void pl_sweep_analyse(const pl_result_table *results, pl_sweep_analysis *analysis)
{
    *analysis = (pl_sweep_analysis){.results = results};
    pl_sweep_gather(analysis);
    estimate_noise(analysis);
    for (int p = 0; p < analysis->scene_count; ++p) {
        find_curves(analysis, &analysis->scenes[p]);
    }
    pl_compare_pairwise(analysis);
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
    free(analysis->points);
    free(analysis->engines);
    free(analysis->scenes);
    free(analysis->pairs);
    *analysis = (pl_sweep_analysis){0};
}
