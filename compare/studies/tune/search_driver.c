#include "search_driver.h"

#include "base/random.h"
#include "evaluation_cache.h"

#include <math.h>
#include <stdlib.h>

/* Of the budget: up to where the sweep and then NLopt may go. */
static const double sweep_part = 0.4, model_part = 0.75;

/* The root above 1 of x^(parameters + 1) = x + 1, by the fixed point of x = (1 + x)^(1 /
 * (parameters + 1)). */
static double golden_ratio(int parameters)
{
    double x = 2;
    for (int i = 0; i < 60; ++i) {
        x = pow(1 + x, 1.0 / (parameters + 1));
    }
    return x;
}

/* The starts, then the additive recurrence of the generalised golden ratio (Roberts 2018), shifted
 * by the seed. Axes that spend no time stay at their starts in half of the points, each by itself:
 * what is shipped is often right, and of several options at once most combinations are wrong. */
void sample_space(pl_evaluation_cache *cache)
{
    const pl_search_def *def = cache->def;
    const int parameters = def->parameter_count, most_misses = 1000;
    const double ratio = golden_ratio(parameters);
    pl_random random = {.state = def->seed};
    pl_unit_point point = {.u = {0}}, shift = point;
    for (int k = 0; k < parameters; ++k) {
        shift.u[k] = pl_random_unit(&random);
        point.u[k] = pl_tune_unit(&def->parameters[k], def->parameters[k].start);
    }
    evaluate(cache, &point);
    for (int next = 1, misses = 0; misses < most_misses && !is_over(cache); ++next) {
        const int before = cache->found->count;
        for (int k = 0; k < parameters; ++k) {
            const bool stays = pl_random_unit(&random) < 0.5 && !def->parameters[k].spends;
            point.u[k] = stays ? pl_tune_unit(&def->parameters[k], def->parameters[k].start)
                               : fmod(shift.u[k] + fmod(next * pow(ratio, -(k + 1)), 1), 1);
        }
        evaluate(cache, &point);
        misses += cache->found->count == before;
    }
}

pl_status pl_search(const pl_search_def *def, pl_search_result *found, pl_error *error)
{
    *found = (pl_search_result){.best = -1};
    found->evaluations = calloc((size_t)def->budget, sizeof *found->evaluations);
    if (found->evaluations == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d points", def->budget);
    }
    pl_evaluation_cache cache = {.def = def, .found = found, .error = error};
    cache.limit = (int)ceil(sweep_part * def->budget);
    sample_space(&cache);
    found->sampled = found->count;
    cache.limit = (int)ceil(model_part * def->budget);
    run_nlopt(&cache);
    found->optimised = found->count - found->sampled;
    cache.limit = def->budget;
    refine_locally(&cache);
    found->refined = found->count - found->sampled - found->optimised;
    return cache.status;
}
