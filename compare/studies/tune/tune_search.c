/* The search in three stages, over a cache of the evaluations. */
#include "tune_search.h"

#include "base/heap.h"
#include "base/random.h"
#include "studies/design.h"

#include <math.h>
#include <nlopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The evaluations so far, each point once, and the budget of the stage. */
typedef struct pl_evaluation_cache {
    const pl_search_def *def;
    pl_search_result *found;
    int limit;        /* the most evaluations at the end of the stage */
    pl_status status; /* of the first call that failed */
    pl_error *error;
} pl_evaluation_cache;

typedef struct pl_unit_point {
    double u[PL_TUNE_MAX_PARAMETERS]; /* 0 .. 1 */
} pl_unit_point;

static double cut(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static double rounded_value(const pl_tune_parameter *parameter, double value)
{
    const double exact_below = 1000;
    char text[32];
    if (parameter->integer && fabs(value) < exact_below) {
        return cut(nearbyint(value), ceil(parameter->low), floor(parameter->high));
    }
    snprintf(text, sizeof text, "%.3g", value);
    return cut(strtod(text, NULL), parameter->integer ? ceil(parameter->low) : parameter->low,
               parameter->integer ? floor(parameter->high) : parameter->high);
}

double pl_tune_value(const pl_tune_parameter *parameter, double unit)
{
    const double u = cut(unit, 0, 1);
    return rounded_value(parameter, parameter->logarithmic
                                        ? parameter->low * pow(parameter->high / parameter->low, u)
                                        : parameter->low + u * (parameter->high - parameter->low));
}

double pl_tune_unit(const pl_tune_parameter *parameter, double value)
{
    const double v = cut(value, parameter->low, parameter->high);
    return parameter->logarithmic ? log(v / parameter->low) / log(parameter->high / parameter->low)
                                  : (v - parameter->low) / (parameter->high - parameter->low);
}

double pl_tune_neighbour(const pl_tune_parameter *parameter, double value, int direction)
{
    const double part = 0.1, least_part = 0.01;
    double step = part * fabs(value);
    if (parameter->integer && step < 1) {
        step = 1;
    } else if (step <= 0) {
        step = least_part * (parameter->high - parameter->low);
    }
    return rounded_value(parameter, direction < 0 ? value - step : value + step);
}

/* Whether no further point may be evaluated: the search is at its limit, stopped or failed. */
static bool is_over(const pl_evaluation_cache *cache)
{
    return cache->status != PL_OK || cache->found->stopped || cache->found->count >= cache->limit;
}

/* The position of an evaluation's values. */
static pl_unit_point units_of(const pl_evaluation_cache *cache, const pl_evaluation *evaluation)
{
    pl_unit_point at = {.u = {0}};
    for (int i = 0; i < cache->def->parameter_count; ++i) {
        at.u[i] = pl_tune_unit(&cache->def->parameters[i], evaluation->values[i]);
    }
    return at;
}

/* The index of the evaluation with these values; -1: there is none. */
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

void pl_search_add(pl_search_result *result, const pl_evaluation *evaluation)
{
    result->evaluations[result->count] = *evaluation;
    if (result->best < 0 ||
        pl_evaluation_is_better(evaluation, &result->evaluations[result->best])) {
        result->best = result->count;
        result->met = evaluation->excess <= 0;
    }
    result->count += 1;
}

/* Evaluates a point that is not in the cache. Returns its index in found->evaluations, or -1 where
 * it could not be evaluated. */
static int evaluate(pl_evaluation_cache *cache, const pl_unit_point *point)
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
    evaluation.trial = found->count;
    cache->status = def->measure(def->user, &evaluation, &found->stopped, cache->error);
    if (cache->status != PL_OK || found->stopped) {
        return -1;
    }
    pl_search_add(found, &evaluation);
    return found->count - 1;
}

/* ---- Second stage: NLopt ---- */

/* NLopt (Johnson, The NLopt nonlinear-optimization package) minimises the logarithm of the cost
 * with a penalty for a missed target. */
enum { MOST_STARTS = 4 };

/* On synthetic engines with and without chaos, 20 seeds each, the simplex method of Nelder and Mead
 * gave points that were 3 to 8 % cheaper on average than those of COBYLA, BOBYQA, Sbplx, DIRECT-L,
 * CRS2 and ISRES. */
static const nlopt_algorithm algorithm = NLOPT_LN_NELDERMEAD;

typedef struct nlopt_run {
    pl_evaluation_cache *cache;
    nlopt_opt optimiser;
    int limit; /* total evaluations at which the next start begins */
} nlopt_run;

/* The penalties for a target missed by a factor of e, as the logarithm of a factor of cost: for the
 * choice of a start, the estimated cost of reaching the target; for the objective: large enough
 * that missing the target never pays. */
static const double start_penalty = 1, miss_penalty = 2;

static double merit(const pl_evaluation *evaluation, double weight)
{
    const double no_cost = 10;
    const double cost = isfinite(evaluation->cost) ? log(evaluation->cost) : no_cost;
    return cost + weight * fmax(evaluation->excess, 0);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the type is NLopt's */
static double objective(unsigned count, const double *x, double *gradient, void *user)
{
    nlopt_run *m = user;
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
                     : merit(&cache->found->evaluations[index], miss_penalty);
}

/* The sampled evaluation of the best merit from which no run has started; -1: there is none. */
static int next_start(const pl_evaluation_cache *cache, const int *begun, int count)
{
    int best = -1;
    for (int i = 0; i < cache->found->sampled; ++i) {
        bool is_new = true;
        for (int k = 0; k < count; ++k) {
            is_new = is_new && begun[k] != i;
        }
        if (is_new && (best < 0 || merit(&cache->found->evaluations[i], start_penalty) <
                                       merit(&cache->found->evaluations[best], start_penalty))) {
            best = i;
        }
    }
    return best;
}

/* Runs NLopt with at most so many new evaluations. False when it could not be created. */
static bool optimise(pl_evaluation_cache *cache, int start, int evaluations)
{
    const int parameters = cache->def->parameter_count, most_asked = 10;
    pl_unit_point at = units_of(cache, &cache->found->evaluations[start]);
    nlopt_run m = {.cache = cache,
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

static void run_nlopt(pl_evaluation_cache *cache)
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

/* ---- Third stage: local refinement ---- */

/* Steps as shares of a parameter's range: the first and the last. */
static const double first_step = 0.08, last_step = 0.005;

static bool improves(pl_evaluation_cache *cache, const pl_unit_point *point)
{
    const int best = cache->found->best;
    evaluate(cache, point);
    return cache->found->best != best;
}

/* The point moved along one parameter, by `step` or at least to the next integer. */
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

/* Continues in a direction that improved the best point, twice as far each time. */
static bool step_along(pl_evaluation_cache *cache, int parameter, double step)
{
    bool helped = false, helps = true;
    for (double h = step; helps && fabs(h) <= 1 && !is_over(cache); h *= 2) {
        const pl_unit_point from = units_of(cache, &cache->found->evaluations[cache->found->best]);
        const pl_unit_point to = moved(cache, &from, parameter, h);
        helps = improves(cache, &to);
        helped = helped || helps;
    }
    return helped;
}

static void step_along_all(pl_evaluation_cache *cache, double step)
{
    for (int parameter = 0; parameter < cache->def->parameter_count && !is_over(cache);
         ++parameter) {
        if (!step_along(cache, parameter, -step)) {
            step_along(cache, parameter, step);
        }
    }
}

static void refine_locally(pl_evaluation_cache *cache)
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
        /* Integers that change do so by at least one. Each parameter may also keep its value. */
        for (int k = 0; k < parameters; ++k) {
            const bool moves = pl_random_unit(&random) < moving_part;
            to = moves ? moved(cache, &to, k, radius * pl_random_normal(&random)) : to;
        }
        const bool helps = improves(cache, &to);
        const bool is_known = cache->found->count == before;
        radius *= helps || is_known ? grow : shrink;
        radius = fmin(fmax(radius, last_step), 2 * first_step);
        misses += is_known;
    }
}

/* ---- First stage: sampling, and the whole search ---- */

/* The shares of the budget at which sampling and then NLopt end. */
static const double sampling_end = 0.4, nlopt_end = 0.75;

/* Evaluates the starts, then points of pl_design_place. A parameter that spends no time stays at its start in half of
 * the points, independently of the others: defaults are often right, and most combinations of several
 * changed options are wrong. */
static void sample_space(pl_evaluation_cache *cache)
{
    const pl_search_def *def = cache->def;
    const int parameters = def->parameter_count, most_misses = 1000;
    pl_random random = {.state = def->seed};
    pl_unit_point start = {.u = {0}};
    uint64_t orders[PL_TUNE_MAX_PARAMETERS];
    for (int k = 0; k < parameters; ++k) {
        orders[k] = pl_random_bits(&random);
        start.u[k] = pl_tune_unit(&def->parameters[k], def->parameters[k].start);
    }
    evaluate(cache, &start);
    for (int next = 0, misses = 0; misses < most_misses && !is_over(cache); ++next) {
        const int before = cache->found->count;
        pl_unit_point point = start;
        for (int k = 0; k < parameters; ++k) {
            const bool stays = pl_random_unit(&random) < 0.5 && !def->parameters[k].spends;
            point.u[k] = stays ? start.u[k] : pl_design_place(orders[k], next);
        }
        evaluate(cache, &point);
        misses += cache->found->count == before;
    }
}

pl_status pl_search(const pl_search_def *def, pl_search_result *result, pl_error *error)
{
    *result = (pl_search_result){.best = -1};
    result->evaluations = pl_heap_new((size_t)def->budget, sizeof *result->evaluations);
    pl_evaluation_cache cache = {.def = def, .found = result, .error = error};
    cache.limit = (int)ceil(sampling_end * def->budget);
    sample_space(&cache);
    result->sampled = result->count;
    cache.limit = (int)ceil(nlopt_end * def->budget);
    run_nlopt(&cache);
    result->optimised = result->count - result->sampled;
    cache.limit = def->budget;
    refine_locally(&cache);
    result->refined = result->count - result->sampled - result->optimised;
    return cache.status;
}
