/* Performance profiles (Dolan and More 2002): how many scenes an engine solves within factors of the least cost. */
#include "analysis.h"

#include "base/heap.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>

/* Whether all engines of the kind were run on the scene, and it has a primary error. */
static bool belongs(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                    pl_sweep_kind kind)
{
    for (int e = 0; e < analysis->engine_count; ++e) {
        if (analysis->engines[e].kind == kind && scene->curves[e].tried == 0) {
            return false;
        }
    }
    return scene->of->row->primary_error[0] != '\0';
}

/* The engine's cost at the level; INFINITY where no point of it has that error. */
static double cost_of(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, int engine,
                      int level)
{
    const int reached = scene->curves[engine].cheapest[level];
    return reached < 0 ? (double)INFINITY : analysis->points[reached].cost;
}

/* The engine's costs at a level over the least costs of all engines of its kind, ascending. */
static json_t *ratios_json(const pl_sweep_analysis *analysis, int engine, int level)
{
    const pl_sweep_kind kind = analysis->engines[engine].kind;
    double *ratios = pl_heap_new((size_t)analysis->scene_count, sizeof *ratios);
    int count = 0;
    for (int p = 0; p < analysis->scene_count; ++p) {
        const pl_sweep_scene *scene = &analysis->scenes[p];
        const double cost = cost_of(analysis, scene, engine, level);
        double least = cost;
        for (int e = 0; e < analysis->engine_count; ++e) {
            least = analysis->engines[e].kind == kind
                        ? fmin(least, cost_of(analysis, scene, e, level))
                        : least;
        }
        if (isfinite(cost) && belongs(analysis, scene, kind)) {
            ratios[count++] = cost / least;
        }
    }
    pl_sort_numbers(ratios, count);
    json_t *array = json_array();
    for (int i = 0; i < count; ++i) {
        json_array_append_new(array, json_real(ratios[i]));
    }
    free(ratios);
    return array;
}

/* The shares of scenes that an engine solves within factors of the least cost. */
static json_t *shares_json(const json_t *ratios, int scenes)
{
    static const double factors[] = {1, 1.5, 2, 3, 5, 10, 100, (double)INFINITY};
    json_t *shares = json_array();
    for (size_t k = 0, count = 0; k < sizeof factors / sizeof factors[0] && scenes > 0; ++k) {
        while (count < json_array_size(ratios) &&
               json_number_value(json_array_get(ratios, count)) <= factors[k]) {
            ++count;
        }
        json_array_append_new(shares, json_real((double)count / scenes));
    }
    return shares;
}

static json_t *profile_json(const pl_sweep_analysis *analysis, pl_sweep_kind kind, int level)
{
    int scenes = 0;
    json_t *engines = json_array();
    for (int p = 0; p < analysis->scene_count; ++p) {
        scenes += belongs(analysis, &analysis->scenes[p], kind);
    }
    for (int e = 0; e < analysis->engine_count; ++e) {
        if (analysis->engines[e].kind == kind) {
            json_t *ratios = ratios_json(analysis, e, level);
            json_array_append_new(engines,
                                  json_pack("{s:i, s:o, s:o}", "engine", e, "ratios", ratios,
                                            "shares", shares_json(ratios, scenes)));
        }
    }
    return json_pack("{s:f, s:b, s:i, s:o}", "level", pl_sweep_levels[level], "all_profiles",
                     (int)(kind == PL_SWEEP_WHOLE), "scenes", scenes, "engines", engines);
}

json_t *pl_profiles_find(const pl_sweep_analysis *analysis)
{
    json_t *profiles = json_array();
    for (int i = 0; i < 2 * PL_SWEEP_LEVELS; ++i) {
        json_array_append_new(profiles,
                              profile_json(analysis,
                                           i < PL_SWEEP_LEVELS ? PL_SWEEP_WHOLE : PL_SWEEP_PROFILE,
                                           i % PL_SWEEP_LEVELS));
    }
    return profiles;
}
