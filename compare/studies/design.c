#include "design.h"

#include "base/random.h"

#include <math.h>

double pl_design_place(uint64_t seed, int point)
{
    enum { BITS = 31 };
    double place = 0x1p-32;
    for (int bit = BITS - 1; bit >= 0; --bit) {
        /* Whether a digit is flipped depends on those above it, and on how many they are. */
        const uint64_t above = UINT64_C(1) << (BITS - 1 - bit) | (uint64_t)point >> (bit + 1);
        pl_random random = {.state = seed ^ above};
        const int flip = (int)(pl_random_bits(&random) >> 63);
        place += ldexp((point >> bit & 1) ^ flip, -(bit + 1));
    }
    return place;
}
