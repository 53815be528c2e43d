/* Levels, and Pareto fronts of cost and error. */
#include "analysis_parts.h"

#include <math.h>

const double pl_sweep_levels[PL_SWEEP_LEVELS] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
const double pl_sweep_times[PL_SWEEP_TIMES] = {1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4,
                                               1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1,  0.2,  0.5,
                                               1,    2,    5,    10,   20,   50,   100};
/* The one that losses of a report are judged by. */
const double pl_sweep_error_floor = 1e-9;

bool pl_sweep_point_is_of(const pl_sweep_point *point, int engine)
{
    return point->engines[PL_SWEEP_WHOLE] == engine || point->engines[PL_SWEEP_PROFILE] == engine ||
           point->engines[PL_SWEEP_SHIPPED] == engine;
}

int pl_sweep_curve_settings(const pl_sweep_curve *curve)
{
    return curve->ok + curve->failed + curve->unmeasured;
}

bool pl_sweep_curve_was_run(const pl_sweep_curve *curve)
{
    return pl_sweep_curve_settings(curve) > 0;
}

static bool before(const pl_sweep_sample *samples, int a, int b)
{
    if (samples[a].cost != samples[b].cost) {
        return samples[a].cost < samples[b].cost;
    }
    if (samples[a].error != samples[b].error) {
        return samples[a].error < samples[b].error;
    }
    return a < b;
}

/* Shell's sort with Ciura's gaps, 2001: qsort cannot see the samples. */
static void sort(const pl_sweep_sample *samples, int *order, int count)
{
    static const int gaps[] = {4025, 1750, 701, 301, 132, 57, 23, 10, 4, 1};
    for (int g = 0; g < (int)(sizeof gaps / sizeof gaps[0]); ++g) {
        for (int i = gaps[g]; i < count; ++i) {
            int moved = order[i], place = i;
            for (; place >= gaps[g] && before(samples, moved, order[place - gaps[g]]);
                 place -= gaps[g]) {
                order[place] = order[place - gaps[g]];
            }
            order[place] = moved;
        }
    }
}

int pl_front_find(const pl_sweep_sample *samples, int *order, int count)
{
    int kept = 0;
    sort(samples, order, count);
    for (int i = 0; i < count; ++i) {
        int candidate = order[i];
        if (kept == 0 || samples[candidate].error < samples[order[kept - 1]].error) {
            order[i] = order[kept];
            order[kept++] = candidate;
        }
    }
    return kept;
}

int pl_front_cheapest(const pl_sweep_sample *front, int count, double error)
{
    for (int i = 0; i < count; ++i) {
        if (front[i].error <= error) {
            return i;
        }
    }
    return -1;
}

int pl_front_most_exact(const pl_sweep_sample *front, int count, double cost)
{
    int best = -1;
    while (best + 1 < count && front[best + 1].cost <= cost) {
        ++best;
    }
    return best;
}

/* y at x on the straight line through two points, all by their logarithms. */
static double between(double x, double x0, double y0, double x1, double y1)
{
    double share = (log(x) - log(x0)) / (log(x1) - log(x0));
    return exp((1 - share) * log(y0) + share * log(y1));
}

double pl_front_cost_at_error(const pl_sweep_sample *front, int count, double error)
{
    int i = pl_front_cheapest(front, count, error);
    if (i >= 0 && front[i].error == error) {
        return front[i].cost;
    }
    if (i <= 0) {
        return (double)NAN;
    }
    return between(error, front[i - 1].error, front[i - 1].cost, front[i].error, front[i].cost);
}

double pl_front_error_at_cost(const pl_sweep_sample *front, int count, double cost)
{
    int i = pl_front_most_exact(front, count, cost);
    if (i >= 0 && front[i].cost == cost) {
        return front[i].error;
    }
    if (i < 0 || i + 1 == count) {
        return (double)NAN;
    }
    return between(cost, front[i].cost, front[i].error, front[i + 1].cost, front[i + 1].error);
}

void pl_front_read(const pl_sweep_sample *front, int count, pl_front_reading *reading)
{
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        int i = pl_front_cheapest(front, count, pl_sweep_levels[k]);
        reading->cost[k] = i < 0 ? (double)NAN : front[i].cost;
        reading->cost_between[k] = pl_front_cost_at_error(front, count, pl_sweep_levels[k]);
    }
    for (int k = 0; k < PL_SWEEP_TIMES; ++k) {
        int i = pl_front_most_exact(front, count, pl_sweep_times[k]);
        reading->error[k] = i < 0 ? (double)NAN : front[i].error;
        reading->error_between[k] = pl_front_error_at_cost(front, count, pl_sweep_times[k]);
    }
}
