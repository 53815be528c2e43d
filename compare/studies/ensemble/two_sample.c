/* Distances of two samples, permutation tests and Holm's correction. */
#include "two_sample.h"

#include "base/heap.h"
#include "base/random.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct tagged {
    double value;
    bool of_a;
} tagged;

pl_pool pl_pool_make(const double *a, int count_a, const double *b, int count_b)
{
    const size_t count = (size_t)count_a + (size_t)count_b;
    tagged *all = pl_heap_new(count, sizeof *all);
    const pl_pool pool = {.count = count_a + count_b,
                          .count_a = count_a,
                          .values = pl_heap_new(count, sizeof *pool.values),
                          .of_a = pl_heap_new(count, sizeof *pool.of_a)};
    for (int i = 0; i < pool.count; ++i) {
        all[i] = i < count_a ? (tagged){a[i], true} : (tagged){b[i - count_a], false};
    }
    qsort(all, count, sizeof *all, pl_compare_numbers);
    for (int i = 0; i < pool.count; ++i) {
        pool.values[i] = all[i].value;
        pool.of_a[i] = all[i].of_a;
    }
    free(all);
    return pool;
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

static const double most_exact = 100000; /* ways to deal */
static const uint64_t permutation_seed = UINT64_C(20040401), split_seed = UINT64_C(19790601);

static double ways_to_deal(int count, int chosen)
{
    double ways = 1;
    for (int i = 1; i <= chosen && ways < 1e15; ++i) {
        ways = ways * (count - chosen + i) / i;
    }
    return ways;
}

/* The next arrangement of the flags in lexicographic order; false after the last. */
static bool next_arrangement(bool *flags, int count)
{
    int i = count - 2;
    while (i >= 0 && !(!flags[i] && flags[i + 1])) {
        --i;
    }
    if (i < 0) {
        return false;
    }
    flags[i] = true;
    flags[i + 1] = false;
    /* What follows has all its true flags first, and gets them last. */
    for (int low = i + 2, high = count - 1; low < high; ++low, --high) {
        bool flag = flags[low];
        flags[low] = flags[high];
        flags[high] = flag;
    }
    return true;
}

/* Shuffles the pooled values (Fisher and Yates): the first `count_a` of `order` go to the first sample. */
static void deal(pl_random *random, int *order, pl_pool *pool)
{
    memset(pool->of_a, 0, (size_t)pool->count * sizeof *pool->of_a);
    for (int i = 0; i < pool->count_a; ++i) {
        int other = i + (int)(pl_random_unit(random) * (pool->count - i));
        int kept = order[i];
        order[i] = order[other];
        order[other] = kept;
        pool->of_a[order[i]] = true;
    }
}

static long count_all(pl_pool *dealt, double bound, long *ways)
{
    long hits = 0;
    *ways = 0;
    for (int i = 0; i < dealt->count; ++i) {
        dealt->of_a[i] = i >= dealt->count - dealt->count_a;
    }
    do {
        hits += pl_energy_distance(dealt) >= bound;
        *ways += 1;
    } while (next_arrangement(dealt->of_a, dealt->count));
    return hits;
}

static long count_draws(pl_pool *dealt, int *order, double bound)
{
    pl_random random = {.state = permutation_seed};
    long hits = 0;
    for (int draw = 0; draw < PL_PERMUTATION_DRAWS; ++draw) {
        deal(&random, order, dealt);
        hits += pl_energy_distance(dealt) >= bound;
    }
    return hits;
}

static int *ascending_order(int count)
{
    int *order = pl_heap_new((size_t)count, sizeof *order);
    for (int i = 0; i < count; ++i) {
        order[i] = i;
    }
    return order;
}

double pl_permutation_p(const pl_pool *pool)
{
    pl_pool dealt = *pool;
    int *order = ascending_order(pool->count);
    double p = 0;
    dealt.of_a = pl_heap_new((size_t)pool->count, sizeof *dealt.of_a);
    /* Ways that differ only in rounding count as equal. */
    const double bound = pl_energy_distance(pool) * (1 - 1e-12);
    if (ways_to_deal(pool->count, pool->count_a) <= most_exact) {
        long ways = 0;
        long hits = count_all(&dealt, bound, &ways);
        p = (double)hits / (double)ways;
    } else {
        long hits = count_draws(&dealt, order, bound);
        p = (1 + (double)hits) / (1.0 + PL_PERMUTATION_DRAWS);
    }
    free(order);
    free(dealt.of_a);
    return p;
}

double pl_permutation_least_p(int count)
{
    double *values = pl_heap_new(2 * (size_t)count, sizeof *values);
    for (int i = 0; i < 2 * count; ++i) {
        values[i] = i;
    }
    pl_pool pool = pl_pool_make(values, count, values + count, count);
    const double p = pl_permutation_p(&pool);
    pl_pool_free(&pool);
    free(values);
    return p;
}

int pl_permutation_least_count(int tests, double level, int count)
{
    const double least = 1.0 / (1 + PL_PERMUTATION_DRAWS);
    if (!(tests * least < level)) {
        return 0;
    }
    while (!(tests * pl_permutation_least_p(count) < level)) {
        ++count;
    }
    return count;
}

pl_noise pl_split_half_noise(const double *values, int count, int n, int m)
{
    if (count < PL_NOISE_LEAST) {
        return (pl_noise){.energy = NAN, .ks = NAN};
    }
    const int half = count / 2;
    int *order = ascending_order(count);
    pl_pool pool = pl_pool_make(values, half, values + half, count - half);
    pl_random random = {.state = split_seed};
    pl_noise noise = {.energy = 0};
    for (int split = 0; split < PL_NOISE_SPLITS; ++split) {
        deal(&random, order, &pool);
        noise.energy += pl_energy_distance(&pool) / PL_NOISE_SPLITS;
        noise.ks += pl_kolmogorov_smirnov(&pool) / PL_NOISE_SPLITS;
    }
    const double scale = (1.0 / n + 1.0 / m) / (1.0 / half + 1.0 / (count - half));
    noise.energy *= scale;
    noise.ks *= sqrt(scale);
    free(order);
    pl_pool_free(&pool);
    return noise;
}

typedef struct ranked {
    double p;
    int index;
} ranked;

void pl_holm(const double *p, int count, double *corrected)
{
    ranked *order = pl_heap_new((size_t)count, sizeof *order);
    for (int i = 0; i < count; ++i) {
        order[i] = (ranked){p[i], i};
    }
    qsort(order, (size_t)count, sizeof *order, pl_compare_numbers);
    double largest = 0;
    for (int k = 0; k < count; ++k) {
        largest = fmax(largest, fmin(1, (count - k) * order[k].p));
        corrected[order[k].index] = largest;
    }
    free(order);
}
