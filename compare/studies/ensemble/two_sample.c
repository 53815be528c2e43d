#include "two_sample.h"

#include <math.h>
#include <stdlib.h>

typedef struct tagged {
    double value;
    bool of_a;
} tagged;

static int ascending(const void *a, const void *b)
{
    const tagged *x = a, *y = b;
    return (x->value > y->value) - (x->value < y->value);
}

pl_status pl_pool_make(const double *a, int count_a, const double *b, int count_b, pl_pool *pool,
                       pl_error *error)
{
    size_t count = (size_t)count_a + (size_t)count_b;
    *pool = (pl_pool){.count = count_a + count_b, .count_a = count_a};
    tagged *all = calloc(count + 1, sizeof *all);
    pool->values = calloc(count + 1, sizeof *pool->values);
    pool->of_a = calloc(count + 1, sizeof *pool->of_a);
    if (all == NULL || pool->values == NULL || pool->of_a == NULL) {
        free(all);
        pl_pool_free(pool);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu values", count);
    }
    for (int i = 0; i < pool->count; ++i) {
        all[i] = i < count_a ? (tagged){a[i], true} : (tagged){b[i - count_a], false};
    }
    qsort(all, count, sizeof *all, ascending);
    for (int i = 0; i < pool->count; ++i) {
        pool->values[i] = all[i].value;
        pool->of_a[i] = all[i].of_a;
    }
    free(all);
    return PL_OK;
}

void pl_pool_free(pl_pool *pool)
{
    free(pool->values);
    free(pool->of_a);
    *pool = (pl_pool){.count = 0};
}

double pl_energy_distance(const pl_pool *pool)
{
    const double step_a = 1.0 / pool->count_a, step_b = 1.0 / (pool->count - pool->count_a);
    int seen_a = 0;
    double sum = 0;
    for (int i = 0; i + 1 < pool->count; ++i) {
        seen_a += pool->of_a[i];
        const double apart = seen_a * step_a - (i + 1 - seen_a) * step_b;
        sum += apart * apart * (pool->values[i + 1] - pool->values[i]);
    }
    return 2 * sum;
}

double pl_kolmogorov_smirnov(const pl_pool *pool)
{
    const double step_a = 1.0 / pool->count_a, step_b = 1.0 / (pool->count - pool->count_a);
    int seen_a = 0;
    double largest = 0;
    for (int i = 0; i + 1 < pool->count; ++i) {
        seen_a += pool->of_a[i];
        /* Between equal values the distributions have no step of their own. */
        if (pool->values[i + 1] > pool->values[i]) {
            largest = fmax(largest, fabs(seen_a * step_a - (i + 1 - seen_a) * step_b));
        }
    }
    return largest;
}
