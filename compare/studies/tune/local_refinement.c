/* Steps from the best point along each parameter, then in seeded directions that shrink where they
 * do not help. */
#include "base/random.h"
#include "evaluation_cache.h"

#include <math.h>

/* Of a parameter: the first and last step, and what a step of a whole parameter is at least. */
static const double first_step = 0.08, last_step = 0.005;

static bool try_one(pl_evaluation_cache *cache, const pl_unit_point *point)
{
    const int best = cache->found->best;
    evaluate(cache, point);
    return cache->found->best != best;
}

/* The point moved along one parameter, by `step` or to the next value that there is. */
static pl_unit_point moved(const pl_evaluation_cache *cache, const pl_unit_point *from,
                           int parameter, double step)
{
    const pl_tune_parameter *a = &cache->def->parameters[parameter];
    const double here = pl_tune_value(a, from->u[parameter]);
    pl_unit_point to = *from;
    to.u[parameter] += step;
    if (a->integer && pl_tune_value(a, to.u[parameter]) == here) {
        to.u[parameter] = pl_tune_unit(a, here + (step < 0 ? -1 : 1));
    }
    return to;
}

/* Goes on in a direction that helped, twice as far each time. */
static bool step_along(pl_evaluation_cache *cache, int parameter, double step)
{
    bool helped = false, helps = true;
    for (double h = step; helps && fabs(h) <= 1 && !is_over(cache); h *= 2) {
        const pl_unit_point from = units_of(cache, &cache->found->evaluations[cache->found->best]);
        const pl_unit_point to = moved(cache, &from, parameter, h);
        helps = try_one(cache, &to);
        helped = helped || helps;
    }
    return helped;
}

/* Once along every parameter. */
static void step_along_all(pl_evaluation_cache *cache, double step)
{
    for (int parameter = 0; parameter < cache->def->parameter_count && !is_over(cache);
         ++parameter) {
        if (!step_along(cache, parameter, -step)) {
            step_along(cache, parameter, step);
        }
    }
}

void refine_locally(pl_evaluation_cache *cache)
{
    const double grow = 1.5, shrink = 0.9, moving_part = 0.75;
    const int most_misses = 1000;
    const int parameters = cache->def->parameter_count;
    pl_random random = {.state = cache->def->seed + 1};
    if (cache->found->best < 0 || parameters == 0) {
        return;
    }
    step_along_all(cache, first_step);
    double radius = first_step;
    for (int misses = 0; misses < most_misses && !is_over(cache);) {
        const pl_unit_point from = units_of(cache, &cache->found->evaluations[cache->found->best]);
        pl_unit_point to = from;
        const int before = cache->found->count;
        /* Whole parameters move by one at least, and must be able to stay. */
        for (int k = 0; k < parameters; ++k) {
            const bool moves = pl_random_unit(&random) < moving_part;
            to = moves ? moved(cache, &to, k, radius * pl_random_normal(&random)) : to;
        }
        const bool helps = try_one(cache, &to);
        const bool is_known = cache->found->count == before;
        radius *= helps || is_known ? grow : shrink;
        radius = fmin(fmax(radius, last_step), 2 * first_step);
        misses += is_known;
    }
}
