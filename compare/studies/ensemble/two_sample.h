/* How far two samples of one number are apart.
 *
 * Both statistics are read from the pooled sample in ascending order, from the two empirical
 * distributions F and G:
 *   energy distance 2 E|X - Y| - E|X - X'| - E|Y - Y'| over all pairs of values, a value with
 *     itself too (Szekely and Rizzo 2004); in one dimension that is 2 times the integral of
 *     (F - G)^2 (Szekely 2003), so that no pair is ever formed;
 *   Kolmogorov's and Smirnov's max |F - G|.
 * Both are 0 for the same values and never below. */
#ifndef PLUMB_TWO_SAMPLE_H
#define PLUMB_TWO_SAMPLE_H

#include "plumb/base.h"

#include <stdbool.h>

/* Two samples pooled. */
typedef struct pl_pool {
    int count, count_a;
    double *values; /* (count), ascending */
    bool *of_a;     /* (count): which sample each is of */
} pl_pool;

/* Both counts >= 1, all values finite. PL_NO_MEMORY leaves the pool empty; freed by pl_pool_free.
 */
pl_status pl_pool_make(const double *a, int count_a, const double *b, int count_b, pl_pool *pool,
                       pl_error *error);
void pl_pool_free(pl_pool *pool);

/* In the unit of the values. */
double pl_energy_distance(const pl_pool *pool);

/* 0 .. 1 */
double pl_kolmogorov_smirnov(const pl_pool *pool);

#endif
