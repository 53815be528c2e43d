/* The middle stage of a search: NLopt (Johnson, The NLopt nonlinear-optimization package) on the
 * logarithm of the cost, with a penalty for a missed target. */
#include "evaluation_cache.h"

#ifdef PLUMB_HAVE_NLOPT

#include <math.h>
#include <nlopt.h>

enum { MOST_STARTS = 4 };

/* On made-up engines of two kinds, with and without chaos, 20 seeds each, simplices of Nelder and
 * Mead came out 3 to 8 % cheaper on the mean than COBYLA, BOBYQA, Sbplx, DIRECT-L, CRS2 and ISRES.
 */
static const nlopt_algorithm algorithm = NLOPT_LN_NELDERMEAD;

typedef struct model {
    pl_evaluation_cache *cache;
    nlopt_opt optimiser;
    int limit; /* evaluations in all, at which it is another start's turn */
} model;

/* What a target missed by a factor of e costs, as the logarithm of a factor: to reach it, where an
 * error falls as the cost rises; and while seeking, so much that to miss it does not pay. */
static const double to_reach = 1, to_miss = 2;

static double merit(const pl_evaluation *evaluation, double weight)
{
    const double no_cost = 10;
    const double cost = isfinite(evaluation->cost) ? log(evaluation->cost) : no_cost;
    return cost + weight * fmax(evaluation->excess, 0);
}

static double objective(unsigned count, const double *x, double *gradient, void *user)
{
    model *m = user;
    pl_evaluation_cache *cache = m->cache;
    pl_unit_point point = {.u = {0}};
    (void)gradient;
    for (unsigned i = 0; i < count; ++i) {
        point.u[i] = x[i];
    }
    const int index = evaluate(cache, &point);
    if (is_over(cache) || cache->found->count >= m->limit) {
        nlopt_force_stop(m->optimiser);
    }
    return index < 0 ? PL_SEARCH_WORST * PL_SEARCH_WORST
                     : merit(&cache->found->evaluations[index], to_miss);
}

/* The evaluation of the sweep of the best merit that is none of those begun from; -1: there is
 * none. */
static int next_start(const pl_evaluation_cache *cache, const int *begun, int count)
{
    int best = -1;
    for (int i = 0; i < cache->found->sampled; ++i) {
        bool is_new = true;
        for (int k = 0; k < count; ++k) {
            is_new = is_new && begun[k] != i;
        }
        if (is_new && (best < 0 || merit(&cache->found->evaluations[i], to_reach) <
                                       merit(&cache->found->evaluations[best], to_reach))) {
            best = i;
        }
    }
    return best;
}

/* With at most so many new evaluations. False when NLopt could not be had. */
static bool optimise(pl_evaluation_cache *cache, int start, int evaluations)
{
    const int parameters = cache->def->parameter_count, most_asked = 10;
    pl_unit_point at = units_of(cache, &cache->found->evaluations[start]);
    model m = {.cache = cache,
               .optimiser = nlopt_create(algorithm, (unsigned)parameters),
               .limit = cache->found->count + evaluations};
    double value = 0;
    if (m.optimiser == NULL) {
        return false;
    }
    nlopt_set_lower_bounds1(m.optimiser, 0);
    nlopt_set_upper_bounds1(m.optimiser, 1);
    nlopt_set_min_objective(m.optimiser, objective, &m);
    nlopt_set_initial_step1(m.optimiser, 0.12);
    nlopt_set_xtol_abs1(m.optimiser, 0.01);
    nlopt_set_maxeval(m.optimiser, most_asked * evaluations);
    nlopt_optimize(m.optimiser, at.u, &value);
    nlopt_destroy(m.optimiser);
    return true;
}

bool pl_search_has_nlopt(void)
{
    return true;
}

void run_nlopt(pl_evaluation_cache *cache)
{
    int begun[MOST_STARTS];
    if (cache->def->parameter_count == 0) {
        return;
    }
    nlopt_srand((unsigned long)cache->def->seed);
    for (int i = 0; i < MOST_STARTS && !is_over(cache); ++i) {
        const int left = cache->limit - cache->found->count, starts_left = MOST_STARTS - i;
        begun[i] = next_start(cache, begun, i);
        if (begun[i] < 0 || !optimise(cache, begun[i], (left + starts_left - 1) / starts_left)) {
            return;
        }
    }
}

#else

bool pl_search_has_nlopt(void)
{
    return false;
}

void run_nlopt(pl_evaluation_cache *cache)
{
    (void)cache;
}

#endif
