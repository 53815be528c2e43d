/* Seeded numbers for scenarios: the same on every machine. SplitMix64: Steele, Lea and Flood 2014,
 * with the constants of Vigna's reference code. Every seed is as good as any other, 0 too. */
#ifndef PLUMB_RANDOM_H
#define PLUMB_RANDOM_H

#include <stdint.h>

typedef struct pl_random {
    uint64_t state; /* begins as the seed */
} pl_random;

uint64_t pl_random_bits(pl_random *random);

/* Uniform over the multiples of 2^-53 in [0, 1). */
double pl_random_unit(pl_random *random);

/* About normal, of mean 0 and variance 1: twelve uniform numbers less 6. */
#define PL_RANDOM_MOST_NORMAL 6.0
double pl_random_normal(pl_random *random);

#endif
