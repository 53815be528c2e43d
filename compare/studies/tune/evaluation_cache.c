#include "evaluation_cache.h"

#include <math.h>
#include <string.h>

bool is_over(const pl_evaluation_cache *cache)
{
    return cache->status != PL_OK || cache->found->stopped || cache->found->count >= cache->limit;
}

pl_unit_point units_of(const pl_evaluation_cache *cache, const pl_evaluation *evaluation)
{
    pl_unit_point at = {.u = {0}};
    for (int i = 0; i < cache->def->parameter_count; ++i) {
        at.u[i] = pl_tune_unit(&cache->def->parameters[i], evaluation->values[i]);
    }
    return at;
}

/* The place of a point among the evaluations; -1: it is new. */
static int place_of(const pl_search_result *found, const pl_evaluation *evaluation, int parameters)
{
    for (int i = 0; i < found->count; ++i) {
        bool same = true;
        for (int k = 0; k < parameters && same; ++k) {
            same = found->evaluations[i].values[k] == evaluation->values[k];
        }
        if (same) {
            return i;
        }
    }
    return -1;
}

bool pl_evaluation_is_better(const pl_evaluation *a, const pl_evaluation *b)
{
    const bool a_meets = a->excess <= 0, b_meets = b->excess <= 0;
    if (a_meets != b_meets) {
        return a_meets;
    }
    if (!a_meets && a->holds != b->holds) {
        return a->holds;
    }
    if (!a_meets && a->excess != b->excess) {
        return a->excess < b->excess;
    }
    return a->cost < b->cost;
}

int evaluate(pl_evaluation_cache *cache, const pl_unit_point *point)
{
    const pl_search_def *def = cache->def;
    pl_search_result *found = cache->found;
    pl_evaluation evaluation = {.cost = (double)INFINITY, .excess = PL_SEARCH_WORST};
    for (int k = 0; k < def->parameter_count; ++k) {
        evaluation.values[k] = pl_tune_value(&def->parameters[k], point->u[k]);
    }
    const int place = place_of(found, &evaluation, def->parameter_count);
    if (place >= 0 || is_over(cache)) {
        return place;
    }
    cache->status = def->measure(def->user, &evaluation, &found->stopped, cache->error);
    if (cache->status != PL_OK || found->stopped) {
        return -1;
    }
    found->evaluations[found->count] = evaluation;
    if (found->best < 0 || pl_evaluation_is_better(&evaluation, &found->evaluations[found->best])) {
        found->best = found->count;
        found->met = evaluation.excess <= 0;
    }
    return found->count++;
}
