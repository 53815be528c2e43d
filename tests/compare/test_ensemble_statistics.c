/* What ensembles are compared by, against closed forms and against sums over all pairs and all
 * arrangements. */
#include "check.h"
#include "studies/ensemble/two_sample.h"

#include <math.h>
#include <stdlib.h>

enum { MOST = 40 };

static double energy_of(const double *a, int count_a, const double *b, int count_b)
{
    pl_pool pool = pl_pool_make(a, count_a, b, count_b);
    double energy = pl_energy_distance(&pool);
    pl_pool_free(&pool);
    return energy;
}

static double ks_of(const double *a, int count_a, const double *b, int count_b)
{
    pl_pool pool = pl_pool_make(a, count_a, b, count_b);
    double ks = pl_kolmogorov_smirnov(&pool);
    pl_pool_free(&pool);
    return ks;
}

static double p_of(const double *a, int count_a, const double *b, int count_b)
{
    pl_pool pool = pl_pool_make(a, count_a, b, count_b);
    const double p = pl_permutation_p(&pool);
    pl_pool_free(&pool);
    return p;
}

static double mean_distance(const double *a, int count_a, const double *b, int count_b)
{
    double sum = 0;
    for (int i = 0; i < count_a; ++i) {
        for (int k = 0; k < count_b; ++k) {
            sum += fabs(a[i] - b[k]);
        }
    }
    return sum / count_a / count_b;
}

/* By its definition, over all pairs. */
static double energy_by_pairs(const double *a, int count_a, const double *b, int count_b)
{
    return 2 * mean_distance(a, count_a, b, count_b) - mean_distance(a, count_a, a, count_a) -
           mean_distance(b, count_b, b, count_b);
}

static double share_up_to(const double *values, int count, double x)
{
    double share = 0;
    for (int i = 0; i < count; ++i) {
        share += values[i] <= x ? 1.0 / count : 0;
    }
    return share;
}

/* By its definition, at every value of either sample. */
static double ks_by_values(const double *a, int count_a, const double *b, int count_b)
{
    double largest = 0;
    for (int i = 0; i < count_a + count_b; ++i) {
        double x = i < count_a ? a[i] : b[i - count_a];
        largest = fmax(largest, fabs(share_up_to(a, count_a, x) - share_up_to(b, count_b, x)));
    }
    return largest;
}

static void draw(check_random *random, double *values, int count, double grid)
{
    for (int i = 0; i < count; ++i) {
        values[i] = check_uniform(random, -3, 5);
        values[i] = grid > 0 ? grid * floor(values[i] / grid) : values[i];
    }
}

static void test_distances_have_their_closed_forms(void **state)
{
    (void)state;
    const double zero[] = {0}, seven[] = {7}, low[] = {0, 1}, high[] = {10, 11, 12};
    assert_close(energy_of(zero, 1, seven, 1), 14, 1e-15, 0);
    assert_close(energy_of(low, 2, low, 2), 0, 0, 0);
    /* 2 x 10.5 - 1/2 - 8/9 */
    assert_close(energy_of(low, 2, high, 3), 2 * 10.5 - 0.5 - 8.0 / 9, 1e-13, 0);
    assert_close(ks_of(low, 2, high, 3), 1, 0, 0);
    assert_close(ks_of(low, 2, low, 2), 0, 0, 0);
    assert_close(ks_of(zero, 1, low, 2), 0.5, 0, 0);
}

static void test_distances_are_those_of_their_definitions(void **state)
{
    (void)state;
    check_random random = {7};
    for (int trial = 0; trial < 300; ++trial) {
        double a[MOST], b[MOST];
        int count_a = 1 + trial % MOST, count_b = 1 + trial / 7 % MOST;
        draw(&random, a, count_a, trial % 3 == 0 ? 0.5 : 0); /* a third has many ties */
        draw(&random, b, count_b, trial % 3 == 0 ? 0.5 : 0);
        double energy = energy_by_pairs(a, count_a, b, count_b);
        assert_close(energy_of(a, count_a, b, count_b), energy, 1e-12, 1e-12);
        assert_close(energy_of(b, count_b, a, count_a), energy, 1e-12, 1e-12);
        assert_close(ks_of(a, count_a, b, count_b), ks_by_values(a, count_a, b, count_b), 1e-14, 0);
    }
}

/* The share of all arrangements whose distance, over all pairs, is at least the actual one. */
static double p_by_arrangements(const double *a, int count_a, const double *b, int count_b)
{
    const int count = count_a + count_b;
    const double actual = energy_by_pairs(a, count_a, b, count_b) - 1e-12;
    long hits = 0, ways = 0;
    for (unsigned chosen = 0; chosen < 1u << count; ++chosen) {
        double x[MOST], y[MOST];
        int in_x = 0, in_y = 0;
        for (int i = 0; i < count; ++i) {
            double value = i < count_a ? a[i] : b[i - count_a];
            if (chosen >> i & 1) {
                x[in_x++] = value;
            } else {
                y[in_y++] = value;
            }
        }
        if (in_x == count_a) {
            ways += 1;
            hits += energy_by_pairs(x, in_x, y, in_y) >= actual;
        }
    }
    return (double)hits / (double)ways;
}

static void test_few_values_have_an_exact_p(void **state)
{
    (void)state;
    const double low[] = {1, 2, 3}, high[] = {4, 5, 6}, same[] = {2, 2, 2};
    assert_close(p_of(low, 3, high, 3), 2.0 / 20, 1e-15, 0);
    assert_close(p_of(low, 3, low, 3), 1, 0, 0);
    assert_close(p_of(same, 3, same, 2), 1, 0, 0);
    check_random random = {11};
    for (int trial = 0; trial < 20; ++trial) {
        double a[MOST], b[MOST];
        int count_a = 2 + trial % 4, count_b = 2 + trial % 5;
        draw(&random, a, count_a, trial % 2 == 0 ? 1 : 0);
        draw(&random, b, count_b, trial % 2 == 0 ? 1 : 0);
        assert_close(p_of(a, count_a, b, count_b), p_by_arrangements(a, count_a, b, count_b), 1e-14,
                     0);
    }
}

static void test_p_value_is_within_its_sampling_error(void **state)
{
    (void)state;
    /* 184,756 arrangements: more than are counted, few enough to count here. */
    check_random random = {13};
    for (int trial = 0; trial < 2; ++trial) {
        double a[MOST], b[MOST];
        draw(&random, a, 10, 0);
        draw(&random, b, 10, 0);
        for (int i = 0; i < 10; ++i) {
            b[i] += trial;
        }
        double exact = p_by_arrangements(a, 10, b, 10);
        double deviation = sqrt(exact * (1 - exact) / PL_PERMUTATION_DRAWS);
        assert_close(p_of(a, 10, b, 10), exact, 5 * deviation + 1.0 / PL_PERMUTATION_DRAWS, 0);
    }
}

/* The actual arrangement is one of those that are at least as far apart: p is never 0. */
static void test_least_p_is_that_of_one_draw(void **state)
{
    (void)state;
    double a[MOST], b[MOST];
    for (int i = 0; i < MOST; ++i) {
        a[i] = i;
        b[i] = 1000 + i;
    }
    assert_close(p_of(a, MOST, b, MOST), 1 / (1.0 + PL_PERMUTATION_DRAWS), 1e-15, 0);
}

static void test_p_of_equal_distributions_is_uniform(void **state)
{
    (void)state;
    enum { TRIALS = 400 };
    check_random random = {17};
    int below_tenth = 0, below_half = 0;
    for (int trial = 0; trial < TRIALS; ++trial) {
        double a[MOST], b[MOST];
        draw(&random, a, 6, 0);
        draw(&random, b, 6, 0);
        double p = p_of(a, 6, b, 6);
        below_tenth += p <= 0.1;
        below_half += p <= 0.5;
    }
    /* Five standard deviations of a binomial: 30 and 50. */
    assert_close(below_tenth, 0.1 * TRIALS, 30, 0);
    assert_close(below_half, 0.5 * TRIALS, 50, 0);
}

/* Over all splits, the pairs within a half of h have 1 - 1/h of the mean distance D of two
 * different values, and those across have D: the mean of the distance is D (1/h + 1/h'). */
static void test_noise_is_the_mean_over_all_splits(void **state)
{
    (void)state;
    check_random random = {19};
    double values[MOST];
    draw(&random, values, MOST, 0);
    double apart = mean_distance(values, MOST, values, MOST) * MOST / (MOST - 1);
    const pl_noise noise = pl_split_half_noise(values, MOST, 25, 100);
    assert_close(noise.energy, apart * (1.0 / 25 + 1.0 / 100), 0, 0.1);
    assert_true(noise.ks > 0 && noise.ks < 1);
    const pl_noise again = pl_split_half_noise(values, MOST, 25, 100);
    const pl_noise quarter = pl_split_half_noise(values, MOST, 100, 400);
    const pl_noise none = pl_split_half_noise(values, 3, 3, 3);
    assert_close(again.energy, noise.energy, 0, 0);
    assert_close(quarter.energy, noise.energy / 4, 0, 1e-12);
    assert_close(quarter.ks, noise.ks / 2, 0, 1e-12);
    assert_true(isnan(none.energy) && isnan(none.ks));
}

static void test_equal_distributions_differ_by_the_noise_only(void **state)
{
    (void)state;
    enum { TRIALS = 200, EACH = 16 };
    check_random random = {23};
    double energy = 0, ks = 0, energy_noise = 0, ks_noise = 0;
    for (int trial = 0; trial < TRIALS; ++trial) {
        double a[EACH], b[EACH];
        draw(&random, a, EACH, 0);
        draw(&random, b, EACH, 0);
        const pl_noise noise = pl_split_half_noise(a, EACH, EACH, EACH);
        energy += energy_of(a, EACH, b, EACH) / TRIALS;
        ks += ks_of(a, EACH, b, EACH) / TRIALS;
        energy_noise += noise.energy / TRIALS;
        ks_noise += noise.ks / TRIALS;
    }
    assert_close(energy / energy_noise, 1, 0.2, 0);
    assert_close(ks / ks_noise, 1, 0.1, 0);
}

/* The smallest p of all divisions of evenly spaced values into two equal samples. */
static double least_p_by_force(int count)
{
    double values[MOST], least = 1;
    for (unsigned chosen = 0; chosen < 1U << (2 * count); ++chosen) {
        int in_a = 0, in_b = 0;
        for (int i = 0; i < 2 * count; ++i) {
            if ((chosen >> i & 1U) != 0 && in_a < count) {
                values[in_a++] = i;
            } else if ((chosen >> i & 1U) == 0 && in_b < count) {
                values[count + in_b++] = i;
            }
        }
        if (in_a + in_b == 2 * count) {
            least = fmin(least, p_of(values, count, values + count, count));
        }
    }
    return least;
}

static void test_least_p_is_that_of_all_divisions(void **state)
{
    (void)state;
    double ways = 1; /* C(2 count, count) */
    for (int count = 1; count <= 9; ++count) {
        ways *= 2.0 * (2 * count - 1) / count;
        assert_close(pl_permutation_least_p(count), 2 / ways, 1e-15, 0);
        if (count <= 5) {
            assert_close(pl_permutation_least_p(count), least_p_by_force(count), 1e-15, 0);
        }
    }
    for (int count = 10; count <= 14; ++count) {
        const double draws = pl_permutation_least_p(count) * (1 + PL_PERMUTATION_DRAWS);
        assert_close(draws, nearbyint(draws), 1e-9, 0);
        assert_true(draws >= 1 - 1e-9 && draws < 8);
    }
}

/* The smallest of `tests` corrected p, of which the smallest is that of samples apart. */
static double least_corrected(int tests, double least)
{
    static double p[6000], corrected[6000];
    for (int i = 0; i < tests; ++i) {
        p[i] = i == 0 ? least : 1;
    }
    pl_holm(p, tests, corrected);
    return corrected[0];
}

static void test_least_count_is_the_first_that_suffices(void **state)
{
    (void)state;
    static const double levels[] = {0.05, 0.01};
    double least[15] = {0};
    for (int count = 1; count < 15; ++count) {
        least[count] = pl_permutation_least_p(count);
    }
    for (int tests = 1; tests < 6000; tests = tests * 4 / 3 + 1) {
        for (int l = 0; l < 2; ++l) {
            int first = 0;
            for (int count = 14; count >= 1; --count) {
                first = least_corrected(tests, least[count]) < levels[l] ? count : first;
            }
            assert_int_equal(pl_permutation_least_count(tests, levels[l], 1), first);
        }
    }
    assert_int_equal(pl_permutation_least_count(1, 0.05, 1), 4);
    assert_int_equal(pl_permutation_least_count(7, 0.05, 1), 6);
    assert_int_equal(pl_permutation_least_count(5000, 0.05, 1), 0);
}

static void test_holm_steps_down(void **state)
{
    (void)state;
    const double p[] = {0.01, 0.04, 0.03, 0.005}, expected[] = {0.03, 0.06, 0.06, 0.02};
    double corrected[4];
    pl_holm(p, 4, corrected);
    for (int i = 0; i < 4; ++i) {
        assert_close(corrected[i], expected[i], 1e-15, 0);
    }
    const double large[] = {0.9, 0.6};
    pl_holm(large, 2, corrected);
    assert_close(corrected[0], 1, 0, 0);
    assert_close(corrected[1], 1, 0, 0);
    pl_holm(p, 1, corrected);
    assert_close(corrected[0], 0.01, 0, 0);
    pl_holm(p, 0, corrected);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_distances_have_their_closed_forms),
        cmocka_unit_test(test_distances_are_those_of_their_definitions),
        cmocka_unit_test(test_few_values_have_an_exact_p),
        cmocka_unit_test(test_p_value_is_within_its_sampling_error),
        cmocka_unit_test(test_least_p_is_that_of_one_draw),
        cmocka_unit_test(test_p_of_equal_distributions_is_uniform),
        cmocka_unit_test(test_noise_is_the_mean_over_all_splits),
        cmocka_unit_test(test_equal_distributions_differ_by_the_noise_only),
        cmocka_unit_test(test_least_p_is_that_of_all_divisions),
        cmocka_unit_test(test_least_count_is_the_first_that_suffices),
        cmocka_unit_test(test_holm_steps_down),
    };
    return cmocka_run_group_tests_name("ensemble statistics", tests, NULL, NULL);
}
