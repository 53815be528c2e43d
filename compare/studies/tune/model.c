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
    pl_ledger *ledger;
    nlopt_opt optimiser;
    int limit; /* trials in all, at which it is another start's turn */
} model;

/* What a target missed by a factor of e costs, as the logarithm of a factor: to reach it, where an
 * error falls as the cost rises; and while seeking, so much that to miss it does not pay. */
static const double to_reach = 1, to_miss = 2;

static double merit(const pl_seek_trial *trial, double weight)
{
    const double no_cost = 10;
    const double cost = isfinite(trial->cost) ? log(trial->cost) : no_cost;
    return cost + weight * fmax(trial->excess, 0);
}

static double objective(unsigned count, const double *x, double *gradient, void *user)
{
    model *m = user;
    pl_ledger *ledger = m->ledger;
    pl_seek_units point = {.u = {0}};
    (void)gradient;
    for (unsigned i = 0; i < count; ++i) {
        point.u[i] = x[i];
    }
    const int index = pl_ledger_try(ledger, &point);
    if (pl_ledger_is_over(ledger) || ledger->found->count >= m->limit) {
        nlopt_force_stop(m->optimiser);
    }
    return index < 0 ? PL_SEEK_WORST * PL_SEEK_WORST
                     : merit(&ledger->found->trials[index], to_miss);
}

/* The trial of the sweep of the best merit that is none of those begun from; -1: there is none. */
static int next_start(const pl_ledger *ledger, const int *begun, int count)
{
    int best = -1;
    for (int i = 0; i < ledger->found->swept; ++i) {
        bool is_new = true;
        for (int k = 0; k < count; ++k) {
            is_new = is_new && begun[k] != i;
        }
        if (is_new && (best < 0 || merit(&ledger->found->trials[i], to_reach) <
                                       merit(&ledger->found->trials[best], to_reach))) {
            best = i;
        }
    }
    return best;
}

/* With at most so many new trials. False when NLopt could not be had. */
static bool optimise(pl_ledger *ledger, int start, int trials)
{
    const int axes = ledger->def->axis_count, most_asked = 10;
    pl_seek_units at = pl_ledger_units(ledger, &ledger->found->trials[start]);
    model m = {.ledger = ledger,
               .optimiser = nlopt_create(algorithm, (unsigned)axes),
               .limit = ledger->found->count + trials};
    double value = 0;
    if (m.optimiser == NULL) {
        return false;
    }
    nlopt_set_lower_bounds1(m.optimiser, 0);
    nlopt_set_upper_bounds1(m.optimiser, 1);
    nlopt_set_min_objective(m.optimiser, objective, &m);
    nlopt_set_initial_step1(m.optimiser, 0.12);
    nlopt_set_xtol_abs1(m.optimiser, 0.01);
    nlopt_set_maxeval(m.optimiser, most_asked * trials);
    nlopt_optimize(m.optimiser, at.u, &value);
    nlopt_destroy(m.optimiser);
    return true;
}

bool pl_seek_has_nlopt(void)
{
    return true;
}

void pl_seek_model(pl_ledger *ledger)
{
    int begun[MOST_STARTS];
    if (ledger->def->axis_count == 0) {
        return;
    }
    nlopt_srand((unsigned long)ledger->def->seed);
    for (int i = 0; i < MOST_STARTS && !pl_ledger_is_over(ledger); ++i) {
        const int left = ledger->limit - ledger->found->count, starts_left = MOST_STARTS - i;
        begun[i] = next_start(ledger, begun, i);
        if (begun[i] < 0 || !optimise(ledger, begun[i], (left + starts_left - 1) / starts_left)) {
            return;
        }
    }
}

#else

bool pl_seek_has_nlopt(void)
{
    return false;
}

void pl_seek_model(pl_ledger *ledger)
{
    (void)ledger;
}

#endif
