#include "random.h"

uint64_t pl_random_bits(pl_random *random)
{
    random->state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t x = random->state;
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

double pl_random_unit(pl_random *random)
{
    return (double)(pl_random_bits(random) >> 11) * 0x1p-53;
}

double pl_random_normal(pl_random *random)
{
    double sum = -6;
    for (int i = 0; i < 12; ++i) {
        sum += pl_random_unit(random);
    }
    return sum;
}
