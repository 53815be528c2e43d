/* What a difference of two samples means: how often chance alone makes one as large, and how large
 * it is beside what one sample shows against itself. Both draw from a fixed seed, so that the same
 * values give the same answer. */
#ifndef PLUMB_PERMUTATION_H
#define PLUMB_PERMUTATION_H

#include "two_sample.h"

enum {
    PL_PERMUTATION_DRAWS = 99999,
    PL_NOISE_SPLITS = 400,
    PL_NOISE_LEAST = 4 /* values, so that each half has two */
};

/* The share of all ways to deal the pooled values into samples of these sizes whose energy distance
 * is at least that of the pool. All ways are counted where there are at most 100,000; otherwise
 * PL_PERMUTATION_DRAWS random ones, and (1 + hits) / (1 + draws), which is never 0 (Phipson and
 * Smyth 2010). Leaves the pool as it was. */
pl_status pl_permutation_p(const pl_pool *pool, double *p, pl_error *error);

/* A sample's own noise. */
typedef struct pl_noise {
    double energy; /* in the unit of the values */
    double ks;     /* 1 */
} pl_noise;

/* What two samples of the sizes n and m of the same engine would differ by, on the mean, as the
 * halves of this one show: the mean over PL_NOISE_SPLITS random splits in halves of h and h',
 * scaled by (1/n + 1/m) / (1/h + 1/h'), as the energy distance of equal distributions goes, and by
 * the square root of that for Kolmogorov's and Smirnov's. NAN for fewer values than PL_NOISE_LEAST.
 */
pl_status pl_split_half_noise(const double *values, int count, int n, int m, pl_noise *noise,
                              pl_error *error);

#endif
