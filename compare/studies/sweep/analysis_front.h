/* Fronts of cost and error: what is both cheap and exact. */
#ifndef PLUMB_SWEEP_ANALYSIS_FRONT_H
#define PLUMB_SWEEP_ANALYSIS_FRONT_H

#include "analysis.h"

/* `order` holds the indices of `count` of the samples, and is sorted by cost, then error, then
 * index. The indices of the front are then moved to its beginning, by rising cost and falling
 * error; of equal samples the first is kept. Returns how many. */
int pl_front_find(const pl_sweep_sample *samples, int *order, int count);

/* The cheapest of a front's samples at or below an error; -1: none. */
int pl_front_cheapest(const pl_sweep_sample *front, int count, double error);

/* The most exact of a front's samples that costs no more; -1: none. */
int pl_front_most_exact(const pl_sweep_sample *front, int count, double cost);

/* Between neighbours of a front, straight in the logarithms; NAN outside of the front. */
double pl_front_cost_at_error(const pl_sweep_sample *front, int count, double error);
double pl_front_error_at_cost(const pl_sweep_sample *front, int count, double cost);

/* What a front says at all levels and times; NAN where it says nothing. */
typedef struct pl_front_reading {
    double cost[PL_SWEEP_LEVELS], cost_between[PL_SWEEP_LEVELS];
    double error[PL_SWEEP_TIMES], error_between[PL_SWEEP_TIMES];
} pl_front_reading;

void pl_front_read(const pl_sweep_sample *front, int count, pl_front_reading *reading);

#endif
