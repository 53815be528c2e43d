#include "analysis_pairwise.h"

#include "analysis_bootstrap.h"

#include <math.h>
#include <stdlib.h>

/* What is at hand while duels are fought. */
typedef struct arena {
    pl_front_reading *readings; /* (engine_count): of the problem as measured */
    pl_front_reading *draws;    /* (engine_count x PL_SWEEP_DRAWS): resampled */
    double *values;             /* (PL_SWEEP_DRAWS) */
    double *logs; /* (pair_count x PL_SWEEP_LEVELS x PL_SWEEP_DRAWS): sums over problems */
} arena;

static pl_sweep_reach reach_of(bool ours, bool other)
{
    if (ours && other) {
        return PL_SWEEP_BOTH;
    }
    return ours ? PL_SWEEP_OURS_ONLY : other ? PL_SWEEP_OTHER_ONLY : PL_SWEEP_NEITHER;
}

/* Their number over ours, where `offset` says which of a reading's numbers. */
static double ratio_of(const pl_front_reading *ours, const pl_front_reading *other, size_t offset)
{
    return ((const double *)other)[offset] / ((const double *)ours)[offset];
}

static pl_sweep_ratio with_interval(const arena *a, const pl_sweep_pair *pair, size_t offset,
                                    bool resampled)
{
    pl_sweep_ratio ratio = {ratio_of(&a->readings[pair->ours], &a->readings[pair->other], offset),
                            (double)NAN, (double)NAN};
    if (!resampled || isnan(ratio.value)) {
        return ratio;
    }
    const pl_front_reading *ours = a->draws + (size_t)pair->ours * PL_SWEEP_DRAWS;
    const pl_front_reading *other = a->draws + (size_t)pair->other * PL_SWEEP_DRAWS;
    for (int draw = 0; draw < PL_SWEEP_DRAWS; ++draw) {
        a->values[draw] = ratio_of(&ours[draw], &other[draw], offset);
    }
    pl_sweep_interval(a->values, PL_SWEEP_DRAWS, &ratio.low, &ratio.high);
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

/* Adds this problem's part of the geometric means. */
static void add_to_means(const arena *a, pl_sweep_analysis *analysis, int index,
                         const pl_sweep_duel *duel)
{
    pl_sweep_pair *pair = &analysis->pairs[index];
    const pl_front_reading *ours = a->draws + (size_t)pair->ours * PL_SWEEP_DRAWS;
    const pl_front_reading *other = a->draws + (size_t)pair->other * PL_SWEEP_DRAWS;
    pair->problems++;
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        pair->both[k] += duel->reach[k] == PL_SWEEP_BOTH;
        pair->ours_only[k] += duel->reach[k] == PL_SWEEP_OURS_ONLY;
        pair->other_only[k] += duel->reach[k] == PL_SWEEP_OTHER_ONLY;
        if (duel->reach[k] != PL_SWEEP_BOTH) {
            continue;
        }
        bool known = !isnan(duel->speed[k].low);
        double *logs = a->logs + ((size_t)index * PL_SWEEP_LEVELS + (size_t)k) * PL_SWEEP_DRAWS;
        pair->mean[k].value += log(duel->speed[k].value);
        for (int draw = 0; draw < PL_SWEEP_DRAWS; ++draw) {
            logs[draw] +=
                known ? log(ratio_of(&ours[draw], &other[draw], COST + (size_t)k)) : (double)NAN;
        }
    }
}

static void fight(const arena *a, pl_sweep_analysis *analysis, const pl_sweep_problem *problem,
                  int index)
{
    const pl_sweep_pair *pair = &analysis->pairs[index];
    const pl_sweep_curve *ours = &problem->curves[pair->ours];
    const pl_sweep_curve *other = &problem->curves[pair->other];
    pl_sweep_duel *duel = &problem->duels[index];
    duel->run = problem->primary_error[0] != '\0' && pl_sweep_curve_was_run(ours) &&
                pl_sweep_curve_was_run(other);
    if (!duel->run) {
        return;
    }
    bool resampled = !isnan(problem->noise);
    for (size_t k = 0; k < PL_SWEEP_LEVELS; ++k) {
        duel->reach[k] = reach_of(ours->reach[k] >= 0, other->reach[k] >= 0);
        duel->speed[k] = with_interval(a, pair, COST + k, resampled);
        duel->speed_between[k] = with_interval(a, pair, COST_BETWEEN + k, resampled);
        duel->instructions[k] = duel->reach[k] == PL_SWEEP_BOTH
                                    ? analysis->points[other->reach[k]].instructions /
                                          analysis->points[ours->reach[k]].instructions
                                    : (double)NAN;
    }
    for (size_t k = 0; k < PL_SWEEP_TIMES; ++k) {
        duel->afford[k] = reach_of(ours->best[k] >= 0, other->best[k] >= 0);
        duel->exactness[k] = with_interval(a, pair, ERROR + k, resampled);
        duel->exactness_between[k] = with_interval(a, pair, ERROR_BETWEEN + k, resampled);
    }
    add_to_means(a, analysis, index, duel);
}

static void read_as_measured(const arena *a, const pl_sweep_analysis *analysis,
                             const pl_sweep_problem *problem, pl_sweep_sample *front)
{
    for (int e = 0; e < analysis->engine_count; ++e) {
        const pl_sweep_curve *curve = &problem->curves[e];
        for (int i = 0; i < curve->front_count; ++i) {
            const pl_sweep_point *point = &analysis->points[curve->front[i]];
            front[i] = (pl_sweep_sample){point->cost, point->error};
        }
        pl_front_read(front, curve->front_count, &a->readings[e]);
    }
}

static void finish_means(const arena *a, pl_sweep_analysis *analysis)
{
    for (int i = 0; i < analysis->pair_count; ++i) {
        for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
            pl_sweep_ratio *mean = &analysis->pairs[i].mean[k];
            const int count = analysis->pairs[i].both[k];
            double *logs = a->logs + ((size_t)i * PL_SWEEP_LEVELS + (size_t)k) * PL_SWEEP_DRAWS;
            mean->value = count == 0 ? (double)NAN : exp(mean->value / count);
            mean->low = mean->high = (double)NAN;
            if (count == 0) {
                continue;
            }
            for (int draw = 0; draw < PL_SWEEP_DRAWS; ++draw) {
                logs[draw] = exp(logs[draw] / count);
            }
            pl_sweep_interval(logs, PL_SWEEP_DRAWS, &mean->low, &mean->high);
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

pl_status pl_duels_fight(pl_sweep_analysis *analysis, pl_error *error)
{
    pl_status status = make_pairs(analysis, error);
    if (status != PL_OK) {
        return status;
    }
    const size_t engines = (size_t)analysis->engine_count + 1;
    const size_t pairs = (size_t)analysis->pair_count + 1;
    pl_sweep_sample *front = calloc((size_t)analysis->point_count + 1, sizeof *front);
    arena a = {.readings = calloc(engines, sizeof *a.readings),
               .draws = calloc(engines * PL_SWEEP_DRAWS, sizeof *a.draws),
               .values = calloc(PL_SWEEP_DRAWS, sizeof *a.values),
               .logs = calloc(pairs * PL_SWEEP_LEVELS * PL_SWEEP_DRAWS, sizeof *a.logs)};
    if (front == NULL || a.readings == NULL || a.draws == NULL || a.values == NULL ||
        a.logs == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for %zu pairs of engines", pairs);
    }
    for (int p = 0; p < analysis->problem_count && status == PL_OK; ++p) {
        pl_sweep_problem *problem = &analysis->problems[p];
        problem->duels = calloc(pairs, sizeof *problem->duels);
        if (problem->duels == NULL) {
            status = pl_fail(error, PL_NO_MEMORY, "out of memory for %zu pairs of engines", pairs);
            break;
        }
        read_as_measured(&a, analysis, problem, front);
        status = pl_sweep_draw(analysis, problem, a.draws, error);
        for (int i = 0; i < analysis->pair_count && status == PL_OK; ++i) {
            fight(&a, analysis, problem, i);
        }
    }
    if (status == PL_OK) {
        finish_means(&a, analysis);
    }
    free(front);
    free(a.readings);
    free(a.draws);
    free(a.values);
    free(a.logs);
    return status;
}
