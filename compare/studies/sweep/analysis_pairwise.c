#include "analysis_pairwise.h"

#include "analysis_bootstrap.h"

#include <math.h>
#include <stdlib.h>

/* What is at hand while comparisons are fought. */
typedef struct workspace {
    pl_front_reading *readings;   /* (engine_count): of the scene as measured */
    pl_front_reading *replicates; /* (engine_count x PL_BOOTSTRAP_REPLICATES): resampled */
    double *values;               /* (PL_BOOTSTRAP_REPLICATES) */
    double *logs; /* (pair_count x PL_SWEEP_LEVELS x PL_BOOTSTRAP_REPLICATES): sums over scenes */
} workspace;

static pl_attained_by attained_by(bool ours, bool other)
{
    if (ours && other) {
        return PL_ATTAINED_BY_BOTH;
    }
    return ours    ? PL_ATTAINED_BY_OURS_ONLY
           : other ? PL_ATTAINED_BY_OTHER_ONLY
                   : PL_ATTAINED_BY_NEITHER;
}

/* Their number over ours, where `offset` says which of a reading's numbers. */
static double ratio_of(const pl_front_reading *ours, const pl_front_reading *other, size_t offset)
{
    return ((const double *)other)[offset] / ((const double *)ours)[offset];
}

static pl_sweep_ratio with_interval(const workspace *a, const pl_sweep_pair *pair, size_t offset,
                                    bool resampled)
{
    pl_sweep_ratio ratio = {ratio_of(&a->readings[pair->ours], &a->readings[pair->other], offset),
                            (double)NAN, (double)NAN};
    if (!resampled || isnan(ratio.value)) {
        return ratio;
    }
    const pl_front_reading *ours = a->replicates + (size_t)pair->ours * PL_BOOTSTRAP_REPLICATES;
    const pl_front_reading *other = a->replicates + (size_t)pair->other * PL_BOOTSTRAP_REPLICATES;
    for (int replicate = 0; replicate < PL_BOOTSTRAP_REPLICATES; ++replicate) {
        a->values[replicate] = ratio_of(&ours[replicate], &other[replicate], offset);
    }
    pl_bootstrap_interval(a->values, PL_BOOTSTRAP_REPLICATES, &ratio.low, &ratio.high);
    return ratio;
}

enum {
    COST = 0,
    COST_BETWEEN = COST + PL_SWEEP_LEVELS,
    ERROR = COST_BETWEEN + PL_SWEEP_LEVELS,
    ERROR_BETWEEN = ERROR + PL_SWEEP_TIMES
};
_Static_assert(sizeof(pl_front_reading) == (ERROR_BETWEEN + PL_SWEEP_TIMES) * sizeof(double),
               "a reading is a row of numbers, which the places above index");

/* Adds this scene's part of the geometric means. */
static void add_to_means(const workspace *a, pl_sweep_analysis *analysis, int index,
                         const pl_pairwise_comparison *comparison)
{
    pl_sweep_pair *pair = &analysis->pairs[index];
    const pl_front_reading *ours = a->replicates + (size_t)pair->ours * PL_BOOTSTRAP_REPLICATES;
    const pl_front_reading *other = a->replicates + (size_t)pair->other * PL_BOOTSTRAP_REPLICATES;
    pair->scenes++;
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        pair->both[k] += comparison->at_error[k] == PL_ATTAINED_BY_BOTH;
        pair->ours_only[k] += comparison->at_error[k] == PL_ATTAINED_BY_OURS_ONLY;
        pair->other_only[k] += comparison->at_error[k] == PL_ATTAINED_BY_OTHER_ONLY;
        if (comparison->at_error[k] != PL_ATTAINED_BY_BOTH) {
            continue;
        }
        bool known = !isnan(comparison->speed[k].low);
        double *logs =
            a->logs + ((size_t)index * PL_SWEEP_LEVELS + (size_t)k) * PL_BOOTSTRAP_REPLICATES;
        pair->mean[k].value += log(comparison->speed[k].value);
        for (int replicate = 0; replicate < PL_BOOTSTRAP_REPLICATES; ++replicate) {
            logs[replicate] +=
                known ? log(ratio_of(&ours[replicate], &other[replicate], COST + (size_t)k))
                      : (double)NAN;
        }
    }
}

static void compare_pair(const workspace *a, pl_sweep_analysis *analysis,
                         const pl_sweep_scene *scene, int index)
{
    const pl_sweep_pair *pair = &analysis->pairs[index];
    const pl_sweep_curve *ours = &scene->curves[pair->ours];
    const pl_sweep_curve *other = &scene->curves[pair->other];
    pl_pairwise_comparison *comparison = &scene->comparisons[index];
    comparison->run = scene->primary_error[0] != '\0' && pl_sweep_curve_was_run(ours) &&
                      pl_sweep_curve_was_run(other);
    if (!comparison->run) {
        return;
    }
    bool resampled = !isnan(scene->noise);
    for (size_t k = 0; k < PL_SWEEP_LEVELS; ++k) {
        comparison->at_error[k] = attained_by(ours->cheapest[k] >= 0, other->cheapest[k] >= 0);
        comparison->speed[k] = with_interval(a, pair, COST + k, resampled);
        comparison->speed_between[k] = with_interval(a, pair, COST_BETWEEN + k, resampled);
        comparison->instructions[k] = comparison->at_error[k] == PL_ATTAINED_BY_BOTH
                                          ? analysis->points[other->cheapest[k]].instructions /
                                                analysis->points[ours->cheapest[k]].instructions
                                          : (double)NAN;
    }
    for (size_t k = 0; k < PL_SWEEP_TIMES; ++k) {
        comparison->at_cost[k] = attained_by(ours->most_exact[k] >= 0, other->most_exact[k] >= 0);
        comparison->exactness[k] = with_interval(a, pair, ERROR + k, resampled);
        comparison->exactness_between[k] = with_interval(a, pair, ERROR_BETWEEN + k, resampled);
    }
    add_to_means(a, analysis, index, comparison);
}

static void read_as_measured(const workspace *a, const pl_sweep_analysis *analysis,
                             const pl_sweep_scene *scene, pl_sweep_sample *front)
{
    for (int e = 0; e < analysis->engine_count; ++e) {
        const pl_sweep_curve *curve = &scene->curves[e];
        for (int i = 0; i < curve->front_count; ++i) {
            const pl_sweep_point *point = &analysis->points[curve->front[i]];
            front[i] = (pl_sweep_sample){point->cost, point->error};
        }
        pl_front_read(front, curve->front_count, &a->readings[e]);
    }
}

static void finish_means(const workspace *a, pl_sweep_analysis *analysis)
{
    for (int i = 0; i < analysis->pair_count; ++i) {
        for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
            pl_sweep_ratio *mean = &analysis->pairs[i].mean[k];
            const int count = analysis->pairs[i].both[k];
            double *logs =
                a->logs + ((size_t)i * PL_SWEEP_LEVELS + (size_t)k) * PL_BOOTSTRAP_REPLICATES;
            mean->value = count == 0 ? (double)NAN : exp(mean->value / count);
            mean->low = mean->high = (double)NAN;
            if (count == 0) {
                continue;
            }
            for (int replicate = 0; replicate < PL_BOOTSTRAP_REPLICATES; ++replicate) {
                logs[replicate] = exp(logs[replicate] / count);
            }
            pl_bootstrap_interval(logs, PL_BOOTSTRAP_REPLICATES, &mean->low, &mean->high);
        }
    }
}

static pl_status make_pairs(pl_sweep_analysis *analysis, pl_error *error)
{
    const size_t count = (size_t)analysis->engine_count;
    analysis->pairs = calloc(count * count + 1, sizeof *analysis->pairs);
    if (analysis->pairs == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu engines", count);
    }
    for (int i = 0; i < analysis->engine_count; ++i) {
        for (int k = 0; k < analysis->engine_count; ++k) {
            const pl_sweep_engine *a = &analysis->engines[i], *b = &analysis->engines[k];
            if (a->ours && !b->ours && a->whole == b->whole) {
                analysis->pairs[analysis->pair_count++] = (pl_sweep_pair){.ours = i, .other = k};
            }
        }
    }
    return PL_OK;
}

pl_status pl_compare_pairwise(pl_sweep_analysis *analysis, pl_error *error)
{
    pl_status status = make_pairs(analysis, error);
    if (status != PL_OK) {
        return status;
    }
    const size_t engines = (size_t)analysis->engine_count + 1;
    const size_t pairs = (size_t)analysis->pair_count + 1;
    pl_sweep_sample *front = calloc((size_t)analysis->point_count + 1, sizeof *front);
    workspace a = {.readings = calloc(engines, sizeof *a.readings),
                   .replicates = calloc(engines * PL_BOOTSTRAP_REPLICATES, sizeof *a.replicates),
                   .values = calloc(PL_BOOTSTRAP_REPLICATES, sizeof *a.values),
                   .logs =
                       calloc(pairs * PL_SWEEP_LEVELS * PL_BOOTSTRAP_REPLICATES, sizeof *a.logs)};
    if (front == NULL || a.readings == NULL || a.replicates == NULL || a.values == NULL ||
        a.logs == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for %zu pairs of engines", pairs);
    }
    for (int p = 0; p < analysis->scene_count && status == PL_OK; ++p) {
        pl_sweep_scene *scene = &analysis->scenes[p];
        scene->comparisons = calloc(pairs, sizeof *scene->comparisons);
        if (scene->comparisons == NULL) {
            status = pl_fail(error, PL_NO_MEMORY, "out of memory for %zu pairs of engines", pairs);
            break;
        }
        read_as_measured(&a, analysis, scene, front);
        status = pl_bootstrap(analysis, scene, a.replicates, error);
        for (int i = 0; i < analysis->pair_count && status == PL_OK; ++i) {
            compare_pair(&a, analysis, scene, i);
        }
    }
    if (status == PL_OK) {
        finish_means(&a, analysis);
    }
    free(front);
    free(a.readings);
    free(a.replicates);
    free(a.values);
    free(a.logs);
    return status;
}
