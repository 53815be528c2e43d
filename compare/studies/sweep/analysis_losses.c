/* Where another engine's front is ahead of ours. */
#include "analysis_pairwise.h"

#include <math.h>
#include <stdlib.h>

/* Without an interval, times within 10 % are equal. */
static const double noise = 0.1;

static bool is_within_noise(const pl_sweep_ratio *speed)
{
    return isnan(speed->low) ? speed->value * (1 + noise) > 1 : speed->high >= 1;
}

static bool is_fine(const pl_sweep_loss *loss)
{
    return loss->level >= PL_SWEEP_MATCHED_LEVEL;
}

static int compare_losses(const void *left, const void *right)
{
    const pl_sweep_loss *a = left, *b = right;
    if (is_fine(a) != is_fine(b)) {
        return is_fine(a) ? -1 : 1;
    }
    if (a->within_noise != b->within_noise) {
        return a->within_noise ? 1 : -1;
    }
    if (a->reach != b->reach) {
        return a->reach == PL_SWEEP_OTHER_ONLY ? -1 : 1;
    }
    if (a->reach == PL_SWEEP_BOTH && a->speed.value != b->speed.value) {
        return a->speed.value < b->speed.value ? -1 : 1;
    }
    int order = a->problem - b->problem;
    order = order != 0 ? order : a->pair - b->pair;
    return order != 0 ? order : a->level - b->level;
}

static void look_at(pl_sweep_analysis *analysis, int p, int pair, int level)
{
    const pl_sweep_problem *problem = &analysis->problems[p];
    const pl_sweep_duel *duel = &problem->duels[pair];
    const pl_sweep_reach reach = duel->reach[level];
    const pl_sweep_ratio *speed = &duel->speed[level];
    analysis->duels_fought += reach != PL_SWEEP_NEITHER;
    if (reach != PL_SWEEP_OTHER_ONLY && !(reach == PL_SWEEP_BOTH && speed->value < 1)) {
        return;
    }
    pl_sweep_loss loss = {
        .problem = p,
        .pair = pair,
        .level = level,
        .reach = reach,
        .ours = problem->curves[analysis->pairs[pair].ours].reach[level],
        .other = problem->curves[analysis->pairs[pair].other].reach[level],
        .speed = *speed,
        .within_noise = reach == PL_SWEEP_BOTH && is_within_noise(speed),
    };
    analysis->fine_losses += is_fine(&loss);
    analysis->losses[analysis->loss_count++] = loss;
}

pl_status pl_duels_list_losses(pl_sweep_analysis *analysis, pl_error *error)
{
    size_t most = (size_t)analysis->problem_count * (size_t)analysis->pair_count * PL_SWEEP_LEVELS;
    analysis->losses = calloc(most + 1, sizeof *analysis->losses);
    if (analysis->losses == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu comparisons", most);
    }
    for (int p = 0; p < analysis->problem_count; ++p) {
        for (int i = 0; i < analysis->pair_count; ++i) {
            bool whole = analysis->engines[analysis->pairs[i].ours].whole;
            for (int k = 0; k < PL_SWEEP_LEVELS && whole && analysis->problems[p].duels[i].run;
                 ++k) {
                look_at(analysis, p, i, k);
            }
        }
    }
    qsort(analysis->losses, (size_t)analysis->loss_count, sizeof *analysis->losses, compare_losses);
    return PL_OK;
}
