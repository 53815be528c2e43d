/* Statistics of two samples of one number: how far they are apart, and how often chance alone gives
 * as large a difference.
 *
 * Both distances are computed from the pooled sample in ascending order, with the two empirical
 * distributions F and G:
 *   energy distance 2 E|X - Y| - E|X - X'| - E|Y - Y'| over all pairs of values, including a value
 *     with itself (Szekely and Rizzo 2004); in one dimension this is 2 times the integral of
 *     (F - G)^2 (Szekely 2003), so that no pair is formed;
 *   Kolmogorov-Smirnov distance max |F - G|.
 * Both are 0 for equal samples and never negative. Random draws use fixed seeds, so that equal
 * values give equal results. */
#ifndef PLUMB_TWO_SAMPLE_H
#define PLUMB_TWO_SAMPLE_H

#include "plumb/base.h"

#include <stdbool.h>

/* Two samples pooled. */
typedef struct pl_pool {
    int count, count_a;
    double *values; /* (count), ascending */
    bool *of_a;     /* (count): whether the value is of the first sample */
} pl_pool;

/* Pools two samples. The caller frees the pool. Both counts >= 1, all values finite. */
pl_pool pl_pool_make(const double *a, int count_a, const double *b, int count_b);

/* Frees the arrays and empties *pool. */
void pl_pool_free(pl_pool *pool);

/* In the unit of the values. */
double pl_energy_distance(const pl_pool *pool);

/* 0 .. 1 */
double pl_kolmogorov_smirnov(const pl_pool *pool);

enum {
    PL_PERMUTATION_DRAWS = 99999,
    PL_NOISE_SPLITS = 400,
    PL_NOISE_LEAST = 4 /* values, so that each half has two */
};

/* The share of all divisions of the pooled values into samples of these sizes whose energy distance
 * is at least that of the pool. Up to 100,000 divisions are all counted; otherwise
 * PL_PERMUTATION_DRAWS random ones are, and the share is (1 + hits) / (1 + draws), which is never 0
 * (Phipson and Smyth 2010). Leaves the pool unchanged. */
double pl_permutation_p(const pl_pool *pool);

/* The smallest p that pl_permutation_p gives for two samples of `count` >= 1 different values each:
 * that of samples of which one lies below the other. No division of the pooled values is farther
 * apart, because |F - G| is then the largest that there is at every value. Up to 9 values it is
 * 2 / C(2 count, count), because samples of equal size may change places; above, it is
 * (1 + hits) / (1 + PL_PERMUTATION_DRAWS), where hits are the draws of that very division. */
double pl_permutation_least_p(int count);

/* The fewest values, `count` or more, in each of two samples with which one of
 * `tests` >= 1 such tests can reach a corrected p below `level` at all: with which tests times the
 * smallest p is below it, because pl_holm multiplies the smallest p by the number of tests. 0: no
 * number is enough. */
int pl_permutation_least_count(int tests, double level, int count);

/* A sample's own noise. */
typedef struct pl_noise {
    double energy; /* in the unit of the values */
    double ks;     /* 1 */
} pl_noise;

/* The mean distance of two samples of sizes n and m of one engine, estimated from the halves of
 * this sample: the mean over PL_NOISE_SPLITS random splits into halves of sizes h and h', scaled by
 * (1/n + 1/m) / (1/h + 1/h') for the energy distance and by the square root of that for the
 * Kolmogorov-Smirnov distance. NAN for fewer values than PL_NOISE_LEAST. */
pl_noise pl_split_half_noise(const double *values, int count, int n, int m);

/* Holm's step-down correction for many tests (1979): where corrected[i] <= a, test i rejects while
 * the chance of any false rejection among all `count` stays at a. With p ascending, the k-th (from
 * 0) is the largest of min(1, (count - j) p_j) over j <= k. */
void pl_holm(const double *p, int count, double *corrected);

#endif
