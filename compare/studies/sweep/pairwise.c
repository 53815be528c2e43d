/* Compares engines in pairs, scene by scene and over all scenes.
 *
 * Intervals of the ratios come from the bootstrap (Efron 1979). In every replicate each point gets
 * as many repeats as it has, drawn from its own with replacement, and their medians make the
 * fronts. Two or three repeats do not show their own scatter: with fewer than ten, each repeat that
 * is drawn is moved by the scene's noise (the smoothed bootstrap, Silverman and Young 1987). Each
 * point has a random stream of its own, so that the replicates of one engine do not depend on which
 * others were run. */
#include "analysis.h"

#include "base/heap.h"
#include "base/random.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>

/* With so many repeats their own scatter is used. */
enum { ENOUGH = 10 };

/* Draws the repeats of a point again, and returns their medians. `noise` is that of the scene; `scratch` has two numbers
 * for each repeat. */
static pl_sweep_sample resample(const pl_sweep_point *point, double noise, pl_random *random,
                                double *scratch)
{
    const int repeats = point->sample_count;
    const double by = repeats < ENOUGH ? noise : 0; /* standard deviation of ln(cost) */
    double *costs = scratch, *errors = scratch + repeats;
    for (int k = 0; k < repeats; ++k) {
        const int chosen = (int)(pl_random_unit(random) * repeats);
        costs[k] = point->samples[chosen].cost;
        costs[k] *= by > 0 ? exp(by * pl_random_normal(random)) : 1;
        errors[k] = point->samples[chosen].error;
    }
    return (pl_sweep_sample){pl_median(costs, repeats), pl_median(errors, repeats)};
}

/* Fills readings (engine_count x PL_BOOTSTRAP_REPLICATES, engine by engine) for the engines that
 * have points on the scene. */
static void bootstrap(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                      pl_front_reading *readings)
{
    const double noise = isnan(scene->noise) ? 0 : scene->noise;
    pl_random *random = pl_heap_new((size_t)scene->count, sizeof *random);
    pl_front_choice of = pl_front_begin(analysis, scene);
    int most = 1;
    for (int i = 0; i < of.count; ++i) {
        random[i].state = of.points[i].hash;
        most = of.points[i].sample_count > most ? of.points[i].sample_count : most;
    }
    double *scratch = pl_heap_new(2 * (size_t)most, sizeof *scratch);
    for (size_t replicate = 0; replicate < PL_BOOTSTRAP_REPLICATES; ++replicate) {
        for (int i = 0; i < of.count; ++i) {
            of.samples[i] = resample(&of.points[i], noise, &random[i], scratch);
        }
        for (int e = 0; e < analysis->engine_count; ++e) {
            if (scene->curves[e].ok > 0) {
                pl_front_of(&of, e, &readings[(size_t)e * PL_BOOTSTRAP_REPLICATES + replicate]);
            }
        }
    }
    free(random);
    pl_front_end(&of);
    free(scratch);
}

void pl_bootstrap_interval(double *values, int count, double *low, double *high)
{
    int known = 0;
    for (int i = 0; i < count; ++i) {
        if (!isnan(values[i])) {
            values[known++] = values[i];
        }
    }
    *low = *high = (double)NAN;
    if (known == 0 || known < 0.95 * count) {
        return;
    }
    pl_sort_numbers(values, known);
    int cut = (int)(0.025 * known);
    *low = values[cut];
    *high = values[known - 1 - cut];
}

/* ---- Comparisons ---- */

/* Scratch space of the comparisons. */
typedef struct workspace {
    pl_front_reading *replicates; /* (engine_count x PL_BOOTSTRAP_REPLICATES): resampled */
    double *values;               /* (PL_BOOTSTRAP_REPLICATES) */
    double *logs; /* (pair_count x PL_SWEEP_LEVELS x PL_BOOTSTRAP_REPLICATES): sums over scenes */
} workspace;

/* Who has a point: -1 is none. */
static pl_attained_by attained_by(int first, int second)
{
    return (pl_attained_by)((first >= 0 ? PL_ATTAINED_BY_FIRST_ONLY : 0) +
                            (second >= 0 ? PL_ATTAINED_BY_SECOND_ONLY : 0));
}

/* The replicates of an engine's readings. */
static const pl_front_reading *replicates_of(const workspace *a, int engine)
{
    return a->replicates + (size_t)engine * PL_BOOTSTRAP_REPLICATES;
}

/* The replicates of the sum of logarithms for a pair and a level. */
static double *logs_of(const workspace *a, int pair, int level)
{
    return a->logs + ((size_t)pair * PL_SWEEP_LEVELS + (size_t)level) * PL_BOOTSTRAP_REPLICATES;
}

/* The number of the second over that of the first. */
static double ratio_of(const pl_front_reading *first, const pl_front_reading *second, int place)
{
    return second->at[place] / first->at[place];
}

static pl_sweep_ratio with_interval(const workspace *a, const pl_sweep_scene *scene,
                                    const pl_sweep_pair *pair, int place)
{
    const pl_front_reading *first = replicates_of(a, pair->first);
    const pl_front_reading *second = replicates_of(a, pair->second);
    pl_sweep_ratio ratio = {
        ratio_of(&scene->curves[pair->first].reading, &scene->curves[pair->second].reading, place),
        (double)NAN, (double)NAN};
    if (isnan(scene->noise) || isnan(ratio.value)) {
        return ratio;
    }
    for (int replicate = 0; replicate < PL_BOOTSTRAP_REPLICATES; ++replicate) {
        a->values[replicate] = ratio_of(&first[replicate], &second[replicate], place);
    }
    pl_bootstrap_interval(a->values, PL_BOOTSTRAP_REPLICATES, &ratio.low, &ratio.high);
    return ratio;
}

/* Adds this scene's part of the geometric means. */
static void add_to_means(const workspace *a, pl_sweep_analysis *analysis, int index,
                         const pl_pairwise_comparison *comparison)
{
    pl_sweep_pair *pair = &analysis->pairs[index];
    const pl_front_reading *first = replicates_of(a, pair->first);
    const pl_front_reading *second = replicates_of(a, pair->second);
    ++pair->scenes;
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        ++pair->reached[comparison->at_error[k]][k];
        if (comparison->at_error[k] != PL_ATTAINED_BY_BOTH) {
            continue;
        }
        bool known = !isnan(comparison->ratios[PL_SPEED + k].low);
        double *logs = logs_of(a, index, k);
        pair->mean[k].value += log(comparison->ratios[PL_SPEED + k].value);
        for (int replicate = 0; replicate < PL_BOOTSTRAP_REPLICATES; ++replicate) {
            logs[replicate] +=
                known ? log(ratio_of(&first[replicate], &second[replicate], PL_SPEED + k))
                      : (double)NAN;
        }
    }
}

static void compare_pair(const workspace *a, pl_sweep_analysis *analysis,
                         const pl_sweep_scene *scene, int index)
{
    const pl_sweep_pair *pair = &analysis->pairs[index];
    const pl_sweep_curve *first = &scene->curves[pair->first];
    const pl_sweep_curve *second = &scene->curves[pair->second];
    pl_pairwise_comparison *comparison = &scene->comparisons[index];
    comparison->run =
        scene->of->row->primary_error[0] != '\0' && first->tried > 0 && second->tried > 0;
    if (!comparison->run) {
        return;
    }
    for (int i = 0; i < PL_READINGS; ++i) {
        comparison->ratios[i] = with_interval(a, scene, pair, i);
    }
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        comparison->at_error[k] = attained_by(first->cheapest[k], second->cheapest[k]);
        comparison->instructions[k] = comparison->at_error[k] == PL_ATTAINED_BY_BOTH
                                          ? analysis->points[second->cheapest[k]].instructions /
                                                analysis->points[first->cheapest[k]].instructions
                                          : (double)NAN;
    }
    for (int k = 0; k < PL_SWEEP_TIMES; ++k) {
        comparison->at_cost[k] = attained_by(first->most_exact[k], second->most_exact[k]);
    }
    add_to_means(a, analysis, index, comparison);
}

static void finish_means(const workspace *a, pl_sweep_analysis *analysis)
{
    for (int i = 0; i < analysis->pair_count; ++i) {
        for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
            pl_sweep_ratio *mean = &analysis->pairs[i].mean[k];
            const int count = analysis->pairs[i].reached[PL_ATTAINED_BY_BOTH][k];
            double *logs = logs_of(a, i, k);
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

/* The engine with all its profiles that one as shipped is of. */
static int whole_of(const pl_sweep_analysis *analysis, int shipped)
{
    const pl_sweep_point *point = analysis->points;
    while (point->engines[PL_SWEEP_SHIPPED] != shipped) {
        ++point;
    }
    return point->engines[PL_SWEEP_WHOLE];
}

/* Gives a pair as shipped to the pair of the same whole engines. */
static void link_shipped(const pl_sweep_analysis *analysis, int shipped)
{
    const pl_sweep_pair *own = &analysis->pairs[shipped];
    const int first = whole_of(analysis, own->first), second = whole_of(analysis, own->second);
    for (int i = 0; i < analysis->pair_count; ++i) {
        pl_sweep_pair *pair = &analysis->pairs[i];
        if (pair->first == first && pair->second == second && pair->shipped < 0) {
            pair->shipped = shipped;
        }
    }
}

static void make_pairs(pl_sweep_analysis *analysis)
{
    for (int i = 0; i < analysis->engine_count; ++i) {
        for (int k = i + 1; k < analysis->engine_count && analysis->engines[i].is_first; ++k) {
            const pl_sweep_engine *a = &analysis->engines[i], *b = &analysis->engines[k];
            if (a->kind == b->kind && !(a->is_home && b->is_home)) {
                const pl_sweep_pair pair = {.first = i, .second = k, .shipped = -1};
                pl_push(&analysis->pairs, &analysis->pair_count, &pair, sizeof pair);
            }
        }
    }
    for (int i = 0; i < analysis->pair_count; ++i) {
        if (analysis->engines[analysis->pairs[i].first].kind == PL_SWEEP_SHIPPED) {
            link_shipped(analysis, i);
        }
    }
}

void pl_compare_pairwise(pl_sweep_analysis *analysis)
{
    make_pairs(analysis);
    const size_t engines = (size_t)analysis->engine_count;
    const size_t pairs = (size_t)analysis->pair_count;
    workspace a = {
        .replicates = pl_heap_new(engines * PL_BOOTSTRAP_REPLICATES, sizeof *a.replicates),
        .values = pl_heap_new(PL_BOOTSTRAP_REPLICATES, sizeof *a.values),
        .logs = pl_heap_new(pairs * PL_SWEEP_LEVELS * PL_BOOTSTRAP_REPLICATES, sizeof *a.logs)};
    for (int p = 0; p < analysis->scene_count; ++p) {
        pl_sweep_scene *scene = &analysis->scenes[p];
        scene->comparisons = pl_heap_new(pairs, sizeof *scene->comparisons);
        bootstrap(analysis, scene, a.replicates);
        for (int i = 0; i < analysis->pair_count; ++i) {
            compare_pair(&a, analysis, scene, i);
        }
    }
    finish_means(&a, analysis);
    free(a.replicates);
    free(a.values);
    free(a.logs);
}
