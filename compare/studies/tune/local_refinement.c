/* Steps from the best point along each axis, then in seeded directions that shrink where they do
 * not help. */
#include "base/random.h"
#include "evaluation_cache.h"

#include <math.h>

/* Of an axis: the first and last step, and what a step of a whole axis is at least. */
static const double first_step = 0.08, last_step = 0.005;

static bool try_one(pl_ledger *ledger, const pl_seek_units *point)
{
    const int best = ledger->found->best;
    pl_ledger_try(ledger, point);
    return ledger->found->best != best;
}

/* The point moved along one axis, by `step` or to the next value that there is. */
static pl_seek_units moved(const pl_ledger *ledger, const pl_seek_units *from, int axis,
                           double step)
{
    const pl_tune_axis *a = &ledger->def->axes[axis];
    const double here = pl_tune_value(a, from->u[axis]);
    pl_seek_units to = *from;
    to.u[axis] += step;
    if (a->integer && pl_tune_value(a, to.u[axis]) == here) {
        to.u[axis] = pl_tune_unit(a, here + (step < 0 ? -1 : 1));
    }
    return to;
}

/* Goes on in a direction that helped, twice as far each time. */
static bool step_along(pl_ledger *ledger, int axis, double step)
{
    bool helped = false, helps = true;
    for (double h = step; helps && fabs(h) <= 1 && !pl_ledger_is_over(ledger); h *= 2) {
        const pl_seek_units from =
            pl_ledger_units(ledger, &ledger->found->trials[ledger->found->best]);
        const pl_seek_units to = moved(ledger, &from, axis, h);
        helps = try_one(ledger, &to);
        helped = helped || helps;
    }
    return helped;
}

/* Once along every axis. */
static void step_along_all(pl_ledger *ledger, double step)
{
    for (int axis = 0; axis < ledger->def->axis_count && !pl_ledger_is_over(ledger); ++axis) {
        if (!step_along(ledger, axis, -step)) {
            step_along(ledger, axis, step);
        }
    }
}

void pl_seek_polish(pl_ledger *ledger)
{
    const double grow = 1.5, shrink = 0.9, moving_part = 0.75;
    const int most_misses = 1000;
    const int axes = ledger->def->axis_count;
    pl_random random = {.state = ledger->def->seed + 1};
    if (ledger->found->best < 0 || axes == 0) {
        return;
    }
    step_along_all(ledger, first_step);
    double radius = first_step;
    for (int misses = 0; misses < most_misses && !pl_ledger_is_over(ledger);) {
        const pl_seek_units from =
            pl_ledger_units(ledger, &ledger->found->trials[ledger->found->best]);
        pl_seek_units to = from;
        const int before = ledger->found->count;
        /* Whole axes move by one at least, and must be able to stay. */
        for (int k = 0; k < axes; ++k) {
            const bool moves = pl_random_unit(&random) < moving_part;
            to = moves ? moved(ledger, &to, k, radius * pl_random_normal(&random)) : to;
        }
        const bool helps = try_one(ledger, &to);
        const bool is_known = ledger->found->count == before;
        radius *= helps || is_known ? grow : shrink;
        radius = fmin(fmax(radius, last_step), 2 * first_step);
        misses += is_known;
    }
}
