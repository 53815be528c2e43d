/* Seeded random numbers that are the same on every machine: SplitMix64 (Steele, Lea and Flood 2014)
 * with the constants of Vigna's reference code. Every seed is as good as any other, including 0. */
#ifndef PLUMB_RANDOM_H
#define PLUMB_RANDOM_H

#include <stdint.h>

/* A generator of random numbers. */
typedef struct pl_random {
    uint64_t state; /* starts as the seed */
} pl_random;

/* The next 64 random bits. */
static inline uint64_t pl_random_bits(pl_random *random)
{
    random->state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t x = random->state;
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

/* Uniform over the multiples of 2^-53 in [0, 1). */
static inline double pl_random_unit(pl_random *random)
{
    return (double)(pl_random_bits(random) >> 11) * 0x1p-53;
}

/* Nearly normal, with mean 0 and variance 1: the sum of twelve uniform numbers, minus 6. Its
 * absolute value is at most 6. */
static inline double pl_random_normal(pl_random *random)
{
    double sum = -6;
    for (int i = 0; i < 12; ++i) {
        sum += pl_random_unit(random);
    }
    return sum;
}

#endif
