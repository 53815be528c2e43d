/* Fronts, orders and intervals of numbers made up, whose answers are known by hand. */
#include "check.h"
#include "studies/sweep/analysis.h"

#include <math.h>

enum { MOST = 60 };

static void test_pareto_front_has_only_undominated_points(void **state)
{
    (void)state;
    const pl_sweep_sample samples[] = {{1, 1e-1}, {2, 1e-2},   {3, 1e-2},
                                       {4, 1e-3}, {0.5, 2e-1}, {5, 5e-3}};
    int order[] = {0, 1, 2, 3, 4, 5};
    assert_int_equal(pl_front_find(samples, order, 6), 4);
    const int expected[] = {4, 0, 1, 3};
    assert_memory_equal(order, expected, sizeof expected);
}

static void test_ties_leave_one_of_each(void **state)
{
    (void)state;
    const pl_sweep_sample same[] = {{1, 1e-2}, {1, 1e-2}, {1, 1e-2}};
    int order[] = {2, 1, 0};
    assert_int_equal(pl_front_find(same, order, 3), 1);
    assert_int_equal(order[0], 0);
    const pl_sweep_sample same_cost[] = {{1, 1e-2}, {1, 1e-3}};
    int cost_order[] = {0, 1};
    assert_int_equal(pl_front_find(same_cost, cost_order, 2), 1);
    assert_int_equal(cost_order[0], 1);
    const pl_sweep_sample same_error[] = {{2, 1e-3}, {1, 1e-3}};
    int error_order[] = {0, 1};
    assert_int_equal(pl_front_find(same_error, error_order, 2), 1);
    assert_int_equal(error_order[0], 1);
    assert_int_equal(pl_front_find(same, order, 0), 0);
}

static bool is_behind(const pl_sweep_sample *samples, int count, int i)
{
    for (int k = 0; k < count; ++k) {
        bool as_good = samples[k].cost <= samples[i].cost && samples[k].error <= samples[i].error;
        bool better = samples[k].cost < samples[i].cost || samples[k].error < samples[i].error;
        if (as_good && (better || k < i))
            return true;
    }
    return false;
}

static void test_front_is_that_of_its_definition(void **state)
{
    (void)state;
    check_random random = {11};
    for (int trial = 0; trial < 500; ++trial) {
        pl_sweep_sample samples[MOST];
        int order[MOST], count = 1 + trial % MOST, expected = 0;
        double grid = trial % 2 == 0 ? 0.25 : 1e-6; /* half have many ties */
        for (int i = 0; i < count; ++i) {
            samples[i].cost = grid * (1 + floor(check_uniform(&random, 0, 2) / grid));
            samples[i].error = grid * (1 + floor(check_uniform(&random, 0, 2) / grid));
            order[i] = count - 1 - i;
        }
        int found = pl_front_find(samples, order, count);
        for (int i = 0; i < count; ++i)
            expected += !is_behind(samples, count, i);
        assert_int_equal(found, expected);
        for (int i = 0; i < found; ++i) {
            assert_false(is_behind(samples, count, order[i]));
            assert_true(i == 0 || samples[order[i]].cost > samples[order[i - 1]].cost);
        }
    }
}

static void test_front_is_read_at_and_between_its_points(void **state)
{
    (void)state;
    const pl_sweep_sample front[] = {{1, 1e-1}, {100, 1e-3}, {1000, 1e-6}};
    assert_int_equal(pl_front_cheapest(front, 3, 0.5), 0);
    assert_int_equal(pl_front_cheapest(front, 3, 1e-1), 0);
    assert_int_equal(pl_front_cheapest(front, 3, 1e-2), 1);
    assert_int_equal(pl_front_cheapest(front, 3, 1e-7), -1);
    assert_int_equal(pl_front_most_exact(front, 3, 0.5), -1);
    assert_int_equal(pl_front_most_exact(front, 3, 100), 1);
    assert_int_equal(pl_front_most_exact(front, 3, 5000), 2);
    assert_close(pl_front_cost_at_error(front, 3, 1e-2), 10, 0, 1e-13);
    assert_close(pl_front_error_at_cost(front, 3, 10), 1e-2, 0, 1e-13);
    assert_close(pl_front_error_at_cost(front, 3, 100 * sqrt(10)), pow(10, -4.5), 0, 1e-13);
    assert_close(pl_front_cost_at_error(front, 3, 1e-6), 1000, 0, 0);
    assert_close(pl_front_error_at_cost(front, 3, 1), 1e-1, 0, 0);
}

static void test_nothing_is_extrapolated(void **state)
{
    (void)state;
    const pl_sweep_sample front[] = {{1, 1e-1}, {100, 1e-3}};
    assert_true(isnan(pl_front_cost_at_error(front, 2, 0.2)));
    assert_true(isnan(pl_front_cost_at_error(front, 2, 9e-4)));
    assert_true(isnan(pl_front_error_at_cost(front, 2, 0.9)));
    assert_true(isnan(pl_front_error_at_cost(front, 2, 101)));
    assert_true(isnan(pl_front_cost_at_error(front, 1, 1e-2)));
    assert_close(pl_front_cost_at_error(front, 1, 1e-1), 1, 0, 0);
    assert_true(isnan(pl_front_cost_at_error(front, 0, 1e-1)));
    assert_int_equal(pl_front_cheapest(front, 0, 1), -1);
}

/* --- Order --- */

static pl_sweep_order order_of(const double *error, int count)
{
    double dt[MOST];
    for (int i = 0; i < count; ++i)
        dt[i] = ldexp(1, -6 - i);
    return pl_order_fit(dt, error, count);
}

static void test_order_of_a_power_is_its_exponent(void **state)
{
    (void)state;
    static const double exponents[] = {0.5, 1, 2, 4};
    for (int k = 0; k < 4; ++k) {
        double error[5];
        for (int i = 0; i < 5; ++i)
            error[i] = 1e4 * pow(ldexp(1, -6 - i), exponents[k]);
        pl_sweep_order order = order_of(error, 5);
        assert_string_equal(order.finding, "found");
        assert_close(order.order, exponents[k], 1e-12, 0);
        assert_close(order.deviation, 0, 1e-12, 0);
        assert_int_equal(order.total, 5);
        assert_int_equal(order.used, 5);
        assert_close(order.dt_high, ldexp(1, -6), 0, 0);
    }
}

static void test_order_omits_points_that_do_not_converge(void **state)
{
    (void)state;
    const double plateau[] = {0.64, 0.16, 0.04, 0.01, 0.0099, 0.0098};
    pl_sweep_order order = order_of(plateau, 6);
    assert_string_equal(order.finding, "found");
    assert_close(order.order, 2, 1e-12, 0);
    assert_int_equal(order.used, 4);
    assert_close(order.dt_low, ldexp(1, -9), 0, 0);
    const double slow_end[] = {0.64, 0.16, 0.04, 0.01, 0.007}; /* slopes 2, 2, 2, 0.51 */
    assert_close(order_of(slow_end, 5).order, 2, 1e-12, 0);
    const double slow_start[] = {0.9, 0.64, 0.16, 0.04, 0.01};
    assert_close(order_of(slow_start, 5).order, 2, 1e-12, 0);
    const double floor[] = {4e-8, 1e-8, 2.5e-9, 1e-9, 1e-9};
    order = order_of(floor, 5);
    assert_close(order.order, 2, 1e-12, 0);
    assert_int_equal(order.used, 3);
    const double twice[] = {0.8, 0.4, 0.2, 0.4, 0.1, 0.025}; /* of equal parts the finer */
    assert_close(order_of(twice, 6).order, 2, 1e-12, 0);
    const double gap[] = {0.8, (double)NAN, 0.4, 0.2, 0.1};
    order = order_of(gap, 5);
    assert_close(order.order, 1, 1e-12, 0);
    assert_int_equal(order.used, 3);
    assert_int_equal(order.total, 5);
}

static void test_order_is_a_least_squares_slope(void **state)
{
    (void)state;
    /* Slopes 1 and 3 between three steps: 2 by least squares, off by 1/6, 1/3, 1/6 log10(4). */
    const double error[] = {1.6, 0.8, 0.1};
    pl_sweep_order order = order_of(error, 3);
    assert_close(order.order, 2, 1e-12, 0);
    assert_close(order.deviation, log10(2) * sqrt(2) / 3, 1e-12, 0);
}

/* Slower than the fourth root of dt, an error does not converge. */
static void test_slow_errors_do_not_converge(void **state)
{
    (void)state;
    for (int slow = 0; slow < 2; ++slow) {
        double error[5];
        for (int i = 0; i < 5; ++i) {
            error[i] = pow(ldexp(1, -i), slow ? 0.24 : 0.26);
        }
        const pl_sweep_order order = order_of(error, 5);
        assert_string_equal(order.finding, slow ? "not converging" : "found");
    }
}

static void test_missing_order_has_a_reason(void **state)
{
    (void)state;
    const double two[] = {0.4, 0.1}, exact[] = {1e-9, 1e-9, 1e-9}, rising[] = {0.1, 0.2, 0.3, 0.4};
    const double one_left[] = {0.1, (double)NAN, (double)NAN};
    const double two_above[] = {1e-3, 1e-6, 1e-9, 1e-9};
    const double none[] = {(double)NAN, (double)NAN, (double)NAN};
    assert_string_equal(order_of(two, 2).finding, "too few time steps");
    assert_string_equal(order_of(one_left, 3).finding, "too few time steps");
    assert_string_equal(order_of(two_above, 4).finding, "too few time steps");
    assert_string_equal(order_of(none, 3).finding, "too few time steps");
    assert_string_equal(order_of(exact, 3).finding, "exact");
    assert_string_equal(order_of(rising, 4).finding, "not converging");
    assert_true(isnan(order_of(rising, 4).order));
}

/* --- Interval --- */

static void test_interval_holds_the_middle(void **state)
{
    (void)state;
    double values[1000], low = 0, high = 0;
    for (int i = 0; i < 1000; ++i)
        values[i] = (i * 37) % 1000;
    pl_bootstrap_interval(values, 1000, &low, &high);
    assert_close(low, 25, 0, 0);
    assert_close(high, 974, 0, 0);
    for (int i = 0; i < 1000; ++i)
        values[i] = i < 40 ? (double)NAN : 7;
    pl_bootstrap_interval(values, 1000, &low, &high);
    assert_close(low, 7, 0, 0);
    assert_close(high, 7, 0, 0);
    for (int i = 0; i < 1000; ++i)
        values[i] = i < 60 ? (double)NAN : 7;
    pl_bootstrap_interval(values, 1000, &low, &high);
    assert_true(isnan(low));
    assert_true(isnan(high));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pareto_front_has_only_undominated_points),
        cmocka_unit_test(test_ties_leave_one_of_each),
        cmocka_unit_test(test_front_is_that_of_its_definition),
        cmocka_unit_test(test_front_is_read_at_and_between_its_points),
        cmocka_unit_test(test_nothing_is_extrapolated),
        cmocka_unit_test(test_order_of_a_power_is_its_exponent),
        cmocka_unit_test(test_order_omits_points_that_do_not_converge),
        cmocka_unit_test(test_order_is_a_least_squares_slope),
        cmocka_unit_test(test_slow_errors_do_not_converge),
        cmocka_unit_test(test_missing_order_has_a_reason),
        cmocka_unit_test(test_interval_holds_the_middle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
