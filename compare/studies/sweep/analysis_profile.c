#include "analysis_profile.h"

#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>

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

pl_status pl_profiles_find(pl_sweep_analysis *analysis, pl_error *error)
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
