/* Which time steps an observed order is taken from. */
#include "check.h"
#include "studies/sweep/analysis.h"

#include <math.h>

enum { MOST_STEPS = 8 };

/* The order of errors that fall by these powers of dt from one halving to the next. */
static pl_sweep_order order_of(const double *powers, int count)
{
    double dt[MOST_STEPS] = {1.0 / 60}, error[MOST_STEPS] = {0.5};
    for (int i = 0; i < count; ++i) {
        dt[i + 1] = dt[i] / 2;
        error[i + 1] = error[i] * pow(0.5, powers[i]);
    }
    return pl_order_fit(dt, error, count + 1);
}

static void test_falling_by_a_quarter_power_is_convergence(void **state)
{
    (void)state;
    const double enough[] = {0.26, 0.26, 0.26}, little[] = {0.24, 0.24, 0.24};
    const pl_sweep_order slow = order_of(enough, 3);
    assert_string_equal(slow.finding, "found");
    assert_close(slow.order, 0.26, 1e-12, 0);
    assert_string_equal(order_of(little, 3).finding, "not converging");
}

/* Ends that fall less than half as fast as the median are no part of it. */
static void test_slow_ends_are_left_out(void **state)
{
    (void)state;
    const double last[] = {2, 2, 2, 0.95}, first[] = {0.95, 2, 2, 2}, fast[] = {2, 2, 2, 1.05};
    for (int i = 0; i < 2; ++i) {
        const pl_sweep_order order = order_of(i == 0 ? last : first, 4);
        assert_string_equal(order.finding, "found");
        assert_int_equal(order.used, 4);
        assert_close(order.order, 2, 1e-12, 0);
        assert_close(order.dt_high, 1.0 / (i == 0 ? 60 : 120), 1e-15, 0);
    }
    const pl_sweep_order whole = order_of(fast, 4);
    assert_int_equal(whole.used, 5);
    assert_true(whole.order < 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_falling_by_a_quarter_power_is_convergence),
        cmocka_unit_test(test_slow_ends_are_left_out),
    };
    return cmocka_run_group_tests_name("sweep order", tests, NULL, NULL);
}
