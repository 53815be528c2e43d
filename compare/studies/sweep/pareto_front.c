/* Levels, and Pareto fronts of cost and error. */
#include "analysis.h"

#include "base/heap.h"

#include <math.h>
#include <stdlib.h>

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

/* By cost, then error, then index. */
static int compare(const void *left, const void *right, void *samples)
{
    const int i = *(const int *)left, k = *(const int *)right;
    const pl_sweep_sample *a = (const pl_sweep_sample *)samples + i,
                          *b = (const pl_sweep_sample *)samples + k;
    const int order = (a->cost > b->cost) - (a->cost < b->cost);
    return order != 0 ? order : a->error != b->error ? (a->error > b->error ? 1 : -1) : i - k;
}

int pl_front_find(const pl_sweep_sample *samples, int *order, int count)
{
    int kept = 0;
    if (count > 0) {
        qsort_r(order, (size_t)count, sizeof *order, compare, (void *)samples);
    }
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

/* Reads a front at all levels and times of a sweep. */
static void read_front(const pl_sweep_sample *front, int count, pl_front_reading *reading)
{
    for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
        const int i = pl_front_cheapest(front, count, pl_sweep_levels[k]);
        reading->at[PL_SPEED + k] = i < 0 ? (double)NAN : front[i].cost;
        reading->at[PL_SPEED_BETWEEN + k] =
            pl_front_cost_at_error(front, count, pl_sweep_levels[k]);
    }
    for (int k = 0; k < PL_SWEEP_TIMES; ++k) {
        const int i = pl_front_most_exact(front, count, pl_sweep_times[k]);
        reading->at[PL_EXACTNESS + k] = i < 0 ? (double)NAN : front[i].error;
        reading->at[PL_EXACTNESS_BETWEEN + k] =
            pl_front_error_at_cost(front, count, pl_sweep_times[k]);
    }
}

pl_front_choice pl_front_begin(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene)
{
    const size_t count = (size_t)scene->count;
    return (pl_front_choice){.points = analysis->points + scene->first,
                             .count = scene->count,
                             .samples = pl_heap_new(count, sizeof(pl_sweep_sample)),
                             .order = pl_heap_new(count, sizeof(int)),
                             .front = pl_heap_new(count, sizeof(pl_sweep_sample))};
}

void pl_front_end(pl_front_choice *choice)
{
    free(choice->samples);
    free(choice->order);
    free(choice->front);
}

int pl_front_of(const pl_front_choice *choice, int engine, pl_front_reading *reading)
{
    int count = 0;
    for (int i = 0; i < choice->count; ++i) {
        const pl_sweep_point *point = &choice->points[i];
        if (point->state == PL_SWEEP_OK && pl_sweep_point_is_of(point, engine)) {
            choice->order[count++] = i;
        }
    }
    count = pl_front_find(choice->samples, choice->order, count);
    for (int i = 0; i < count; ++i) {
        choice->front[i] = choice->samples[choice->order[i]];
    }
    read_front(choice->front, count, reading);
    return count;
}
