#include "search_driver.h"

#include "base/random.h"
#include "evaluation_cache.h"

#include <math.h>
#include <stdlib.h>

/* Of the budget: up to where the sweep and then NLopt may go. */
static const double sweep_part = 0.4, model_part = 0.75;

/* The root above 1 of x^(axes + 1) = x + 1, by the fixed point of x = (1 + x)^(1 / (axes + 1)). */
static double golden_ratio(int axes)
{
    double x = 2;
    for (int i = 0; i < 60; ++i) {
        x = pow(1 + x, 1.0 / (axes + 1));
    }
    return x;
}

/* The starts, then the additive recurrence of the generalised golden ratio (Roberts 2018), shifted
 * by the seed. Axes that spend no time stay at their starts in half of the points, each by itself:
 * what is shipped is often right, and of several options at once most combinations are wrong. */
void pl_seek_sweep(pl_ledger *ledger)
{
    const pl_seek_def *def = ledger->def;
    const int axes = def->axis_count, most_misses = 1000;
    const double ratio = golden_ratio(axes);
    pl_random random = {.state = def->seed};
    pl_seek_units point = {.u = {0}}, shift = point;
    for (int k = 0; k < axes; ++k) {
        shift.u[k] = pl_random_unit(&random);
        point.u[k] = pl_tune_unit(&def->axes[k], def->axes[k].start);
    }
    pl_ledger_try(ledger, &point);
    for (int next = 1, misses = 0; misses < most_misses && !pl_ledger_is_over(ledger); ++next) {
        const int before = ledger->found->count;
        for (int k = 0; k < axes; ++k) {
            const bool stays = pl_random_unit(&random) < 0.5 && !def->axes[k].spends;
            point.u[k] = stays ? pl_tune_unit(&def->axes[k], def->axes[k].start)
                               : fmod(shift.u[k] + fmod(next * pow(ratio, -(k + 1)), 1), 1);
        }
        pl_ledger_try(ledger, &point);
        misses += ledger->found->count == before;
    }
}

pl_status pl_seek(const pl_seek_def *def, pl_seek_found *found, pl_error *error)
{
    *found = (pl_seek_found){.best = -1};
    found->trials = calloc((size_t)def->budget, sizeof *found->trials);
    if (found->trials == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d points", def->budget);
    }
    pl_ledger ledger = {.def = def, .found = found, .error = error};
    ledger.limit = (int)ceil(sweep_part * def->budget);
    pl_seek_sweep(&ledger);
    found->swept = found->count;
    ledger.limit = (int)ceil(model_part * def->budget);
    pl_seek_model(&ledger);
    found->modelled = found->count - found->swept;
    ledger.limit = def->budget;
    pl_seek_polish(&ledger);
    found->polished = found->count - found->swept - found->modelled;
    return ledger.status;
}
