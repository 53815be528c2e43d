/* The search in two stages, over a cache of the evaluations. */
#include "tune_search.h"

#include "base/heap.h"
#include "base/random.h"
#include "studies/tunable.h"

#include <math.h>
#include <nlopt.h>
#include <stdio.h>
#include <stdlib.h>

/* The evaluations so far, each point once, and the budget of the stage. */
typedef struct pl_evaluation_cache {
    const pl_search_def *def;
    pl_search_result *found;
    int limit; /* the most evaluations at the end of the stage */
} pl_evaluation_cache;

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

/* Whether no further point may be evaluated: the search is at its limit, or stopped. */
static bool is_over(const pl_evaluation_cache *cache)
{
    return cache->found->stopped || cache->found->count >= cache->limit;
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

/* Evaluates a point, 0 .. 1 along each parameter, that is not in the cache. Returns its index in found->evaluations, or
 * -1 where it could not be evaluated. */
static int evaluate(pl_evaluation_cache *cache, const double *point)
{
    const pl_search_def *def = cache->def;
    pl_search_result *found = cache->found;
    pl_evaluation evaluation = {.cost = (double)INFINITY, .excess = PL_SEARCH_WORST};
    for (int k = 0; k < def->parameter_count; ++k) {
        evaluation.values[k] = pl_tune_value(&def->parameters[k], point[k]);
    }
    const int place = place_of(found, &evaluation, def->parameter_count);
    if (place >= 0 || is_over(cache)) {
        return place;
    }
    evaluation.trial = found->count;
    found->stopped = !def->measure(def->user, &evaluation);
    if (found->stopped) {
        return -1;
    }
    pl_search_add(found, &evaluation);
    return found->count - 1;
}

/* ---- First stage: samples ---- */

/* Evaluates the starts, then points of pl_design_place. A parameter that spends no time stays at its start in half of
 * the points, independently of the others: defaults are often right, and most combinations of several
 * changed options are wrong. */
static void sample_space(pl_evaluation_cache *cache)
{
    const pl_search_def *def = cache->def;
    const int parameters = def->parameter_count, most_misses = 1000;
    pl_random random = {.state = def->seed};
    double start[PL_TUNE_MAX_PARAMETERS];
    uint64_t orders[PL_TUNE_MAX_PARAMETERS];
    for (int k = 0; k < parameters; ++k) {
        orders[k] = pl_random_bits(&random);
        start[k] = pl_tune_unit(&def->parameters[k], def->parameters[k].start);
    }
    evaluate(cache, start);
    for (int next = 0, misses = 0; misses < most_misses && !is_over(cache); ++next) {
        const int before = cache->found->count;
        double point[PL_TUNE_MAX_PARAMETERS];
        for (int k = 0; k < parameters; ++k) {
            const bool stays = pl_random_unit(&random) < 0.5 && !def->parameters[k].spends;
            point[k] = stays ? start[k] : pl_design_place(orders[k], next);
        }
        evaluate(cache, point);
        misses += cache->found->count == before;
    }
}

/* ---- Second stage: NLopt (Johnson, The NLopt nonlinear-optimization package) ---- */

/* On synthetic engines with and without noise, 100 seeds each, Subplex (Rowan 1990) gave cheaper points on average than
 * the simplex method of Nelder and Mead, and met targets that this method missed. */
static const nlopt_algorithm algorithm = NLOPT_LN_SBPLX;

/* A run of NLopt takes at most this part of the evaluations that the samples leave: 1 / RUNS. */
enum { RUNS = 4 };

typedef struct nlopt_run {
    pl_evaluation_cache *cache;
    nlopt_opt optimiser;
    int limit; /* total evaluations at which the next run begins */
    double penalty;
} nlopt_run;

/* The penalties for a target missed by a factor of e, as the logarithm of a factor of cost: for the
 * choice of a start, the estimated cost of reaching the target; for the objective: large enough
 * that missing the target never pays, and that the excess counts most while no point meets it. */
static const double start_penalty = 1, miss_penalty = 2, unmet_penalty = 8;

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
    (void)gradient;
    (void)count;
    const int index = evaluate(cache, x);
    if (is_over(cache) || cache->found->count >= m->limit) {
        nlopt_force_stop(m->optimiser);
    }
    return index < 0 ? PL_SEARCH_WORST * PL_SEARCH_WORST
                     : merit(&cache->found->evaluations[index], m->penalty);
}

/* The evaluation of the best merit at which no run has begun; -1: there is none. */
static int next_start(const pl_search_result *found, const bool *begun)
{
    int best = -1;
    for (int i = 0; i < found->count; ++i) {
        if (!begun[i] && (best < 0 || merit(&found->evaluations[i], start_penalty) <
                                          merit(&found->evaluations[best], start_penalty))) {
            best = i;
        }
    }
    return best;
}

/* Runs NLopt with at most `evaluations` new evaluations. */
static void optimise(pl_evaluation_cache *cache, int start, int evaluations)
{
    const int parameters = cache->def->parameter_count, most_asked = 10;
    nlopt_run m = {.cache = cache,
                   .optimiser = nlopt_create(algorithm, (unsigned)parameters),
                   .limit = cache->found->count + evaluations,
                   .penalty = cache->found->met ? miss_penalty : unmet_penalty};
    double at[PL_TUNE_MAX_PARAMETERS], value = 0;
    if (m.optimiser == NULL) {
        pl_out_of_memory();
    }
    for (int i = 0; i < parameters; ++i) {
        at[i] =
            pl_tune_unit(&cache->def->parameters[i], cache->found->evaluations[start].values[i]);
    }
    nlopt_set_lower_bounds1(m.optimiser, 0);
    nlopt_set_upper_bounds1(m.optimiser, 1);
    nlopt_set_min_objective(m.optimiser, objective, &m);
    nlopt_set_initial_step1(m.optimiser, 0.12);
    nlopt_set_xtol_abs1(m.optimiser, 0.01);
    nlopt_set_maxeval(m.optimiser, most_asked * evaluations);
    nlopt_optimize(m.optimiser, at, &value);
    nlopt_destroy(m.optimiser);
}

static void run_nlopt(pl_evaluation_cache *cache)
{
    const int most = (cache->limit - cache->found->count + RUNS - 1) / RUNS;
    bool *begun = pl_heap_new((size_t)cache->limit, sizeof *begun);
    int start = 0;
    nlopt_srand((unsigned long)cache->def->seed);
    while (!is_over(cache) && start >= 0) {
        start = next_start(cache->found, begun);
        if (start >= 0) {
            begun[start] = true;
            optimise(cache, start, most);
        }
    }
    free(begun);
}

void pl_search(const pl_search_def *def, pl_search_result *result)
{
    const double sampling_end = 0.4; /* of the budget */
    *result = (pl_search_result){.best = -1};
    result->evaluations = pl_heap_new((size_t)def->budget, sizeof *result->evaluations);
    pl_evaluation_cache cache = {.def = def, .found = result};
    cache.limit = (int)ceil(sampling_end * def->budget);
    sample_space(&cache);
    cache.limit = def->budget;
    if (def->parameter_count > 0) {
        run_nlopt(&cache);
    }
}
