/* Lists where the front of another engine is ahead of that of the home engine. */
#include "analysis_parts.h"

#include "base/heap.h"

#include <math.h>
#include <stdlib.h>

/* Without an interval, times within 10 % are equal. */
static const double equal_within = 0.1;

static bool is_within_noise(const pl_sweep_ratio *speed)
{
    return isnan(speed->low) ? speed->value * (1 + equal_within) > 1 : speed->high >= 1;
}

static bool is_fine(const pl_sweep_loss *loss)
{
    return loss->level >= PL_SWEEP_MATCHED_LEVEL;
}

/* Fine ones first, in them those beyond noise, in those the ones that were not reached. */
static int rank_of(const pl_sweep_loss *loss)
{
    return 4 * !is_fine(loss) + 2 * loss->within_noise + (loss->attained == PL_ATTAINED_BY_BOTH);
}

static int compare_losses(const void *left, const void *right)
{
    const pl_sweep_loss *a = left, *b = right;
    int order = rank_of(a) - rank_of(b);
    if (order == 0 && a->attained == PL_ATTAINED_BY_BOTH && a->speed.value != b->speed.value) {
        return a->speed.value < b->speed.value ? -1 : 1;
    }
    order = order != 0 ? order : a->scene - b->scene;
    order = order != 0 ? order : a->pair - b->pair;
    return order != 0 ? order : a->level - b->level;
}

static void note_loss(pl_sweep_analysis *analysis, int p, int pair, int level)
{
    const pl_sweep_scene *scene = &analysis->scenes[p];
    const pl_pairwise_comparison *comparison = &scene->comparisons[pair];
    const pl_attained_by attained = comparison->at_error[level];
    const pl_sweep_ratio *speed = &comparison->ratios[PL_SPEED + level];
    analysis->compared += attained != PL_ATTAINED_BY_NEITHER;
    if (attained != PL_ATTAINED_BY_SECOND_ONLY &&
        !(attained == PL_ATTAINED_BY_BOTH && speed->value < 1)) {
        return;
    }
    pl_sweep_loss loss = {
        .scene = p,
        .pair = pair,
        .level = level,
        .attained = attained,
        .first = scene->curves[analysis->pairs[pair].first].cheapest[level],
        .second = scene->curves[analysis->pairs[pair].second].cheapest[level],
        .speed = *speed,
        .within_noise = attained == PL_ATTAINED_BY_BOTH && is_within_noise(speed),
    };
    analysis->fine_losses += is_fine(&loss);
    pl_push(&analysis->losses, &analysis->loss_count, &loss, sizeof loss);
}

void pl_list_losses(pl_sweep_analysis *analysis)
{
    for (int p = 0; p < analysis->scene_count; ++p) {
        for (int i = 0; i < analysis->pair_count; ++i) {
            const pl_sweep_engine *first = &analysis->engines[analysis->pairs[i].first];
            const bool counts = first->is_home && first->kind == analysis->shown;
            for (int k = 0; k < PL_SWEEP_LEVELS && counts && analysis->scenes[p].comparisons[i].run;
                 ++k) {
                note_loss(analysis, p, i, k);
            }
        }
    }
    if (analysis->loss_count > 0) {
        qsort(analysis->losses, (size_t)analysis->loss_count, sizeof *analysis->losses,
              compare_losses);
    }
}
