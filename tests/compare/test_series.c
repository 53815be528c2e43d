/* Streaming statistics against the sorted numbers. */
#include "referee/metrics/modules.h"

#include "base/statistics.h"
#include "check.h"

#include <math.h>
#include <stdlib.h>

static void test_percentiles_are_within_the_histograms_resolution(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    check_random random = {UINT64_C(2463534242)};
    double *sorted = malloc(COUNT * sizeof *sorted);
    pl_arena arena = {0};
    pl_series series;
    assert_non_null(sorted);
    pl_series_init(&series, &arena);
    for (int i = 0; i < COUNT; ++i) {
        sorted[i] = pow(10, check_uniform(&random, -20, 12));
        pl_series_add(&series, sorted[i], i + 1);
        pl_series_add(&series, nan(""), i + 1);
    }
    pl_sort_numbers(sorted, COUNT);
    for (int percent = 1; percent <= 100; ++percent) {
        double exact = sorted[COUNT / 100 * percent - 1];
        assert_close(pl_series_percentile(&series, percent / 100.0), exact, 0, 1.0 / 128);
    }
    assert_close(series.max, sorted[COUNT - 1], 0, 0);
    pl_arena_free(&arena);
    free(sorted);
}

static void test_numbers_one_percent_apart_never_share_a_bin(void **state)
{
    (void)state;
    pl_arena arena = {0};
    pl_series series;
    pl_series_init(&series, &arena);
    for (int k = 1; k <= 1000; ++k) {
        pl_series_add(&series, 1e-6 * pow(1.01, k), k);
    }
    for (int k = 1; k <= 1000; ++k) {
        assert_close(pl_series_percentile(&series, k / 1000.0), 1e-6 * pow(1.01, k), 0, 0);
    }
    pl_arena_free(&arena);
}

static void test_percentiles_beyond_the_histograms_range(void **state)
{
    (void)state;
    pl_arena arena = {0};
    pl_series series;
    pl_series_init(&series, &arena);
    assert_close(pl_series_percentile(&series, 0.5), 0, 0, 0);
    for (int i = 1; i <= 98; ++i) {
        pl_series_add(&series, 0, i);
    }
    pl_series_add(&series, 1e200, 99);
    pl_series_add(&series, HUGE_VAL, 100);
    assert_close(pl_series_percentile(&series, 0.98), 0, 0, 0);
    assert_true(pl_series_percentile(&series, 0.99) > 1e199);
    pl_metric infinite = pl_series_metric(&series, 0);
    assert_int_equal(infinite.state, PL_METRIC_FAILED);
    assert_contains(infinite.reason, "step 100");
    pl_arena_free(&arena);
}

static void test_root_mean_square_is_of_all_numbers_reported(void **state)
{
    (void)state;
    pl_arena arena = {0};
    pl_series series;
    pl_series_init(&series, &arena);
    assert_close(pl_series_metric(&series, PL_TRAIT_RMS).value, 0, 0, 0);
    const double numbers[] = {3, 4, 0, nan("")};
    for (int i = 0; i < 4; ++i) {
        pl_series_add(&series, numbers[i], i + 1);
    }
    assert_close(pl_series_metric(&series, PL_TRAIT_RMS).value, sqrt(25.0 / 3), 0, 1e-15);
    pl_arena_free(&arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_percentiles_are_within_the_histograms_resolution),
        cmocka_unit_test(test_numbers_one_percent_apart_never_share_a_bin),
        cmocka_unit_test(test_percentiles_beyond_the_histograms_range),
        cmocka_unit_test(test_root_mean_square_is_of_all_numbers_reported),
    };
    return cmocka_run_group_tests_name("series", tests, NULL, NULL);
}
