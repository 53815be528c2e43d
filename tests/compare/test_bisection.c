/* The bisection of a critical value, on predicates whose answer is known. */
#include "check.h"
#include "studies/bisection.h"

#include <math.h>

/* A scene that holds on one side of a value; `always` and `never` hold everywhere or nowhere. */
typedef struct fake {
    double critical;
    bool holds_below, always, never;
} fake;

static bool holds(const fake *f, double value)
{
    return !f->never && (f->always || (value < f->critical) == f->holds_below);
}

static pl_bisection search(const fake *f, double low, double high, bool holds_below,
                           double tolerance)
{
    pl_bisection b = {.low = low, .high = high, .holds_below = holds_below, .tolerance = tolerance};
    const int most = pl_bisection_most_trials(&b);
    while (b.state == PL_BISECTION_SEARCHING) {
        double value = pl_bisection_next(&b);
        assert_true(low <= value && value <= high);
        pl_bisection_take(&b, holds(f, value));
        assert_true(b.trials <= most);
    }
    return b;
}

static void test_bracket_contains_the_value_at_requested_width(void **state)
{
    (void)state;
    for (int i = 0; i < 200; ++i) {
        const bool below = i % 2 == 0;
        const double high = 1 + i, critical = -2 + (high + 2) * fmod(0.5 + 0.381966 * i, 1);
        const double tolerance = pow(10, -(i % 9));
        const fake f = {.critical = critical, .holds_below = below};
        const pl_bisection b = search(&f, -2, high, below, tolerance);
        assert_int_equal(b.state, PL_BISECTION_FOUND);
        assert_true(b.low <= critical && critical <= b.high);
        assert_true(b.high - b.low <= tolerance);
        assert_int_equal(holds(&f, b.low), below);
        assert_int_equal(holds(&f, b.high), !below);
        /* Both ends, and a halving for each power of two. */
        assert_int_equal(b.trials, 2 + (int)fmax(0, ceil(log2((high + 2) / tolerance))));
    }
}

static void test_side_is_learnt_where_it_is_not_known(void **state)
{
    (void)state;
    for (int below = 0; below < 2; ++below) {
        const fake f = {.critical = 0.3, .holds_below = below};
        pl_bisection b = {
            .low = 0, .high = 1, .holds_below = !below, .either_side = true, .tolerance = 1e-3};
        while (b.state == PL_BISECTION_SEARCHING) {
            pl_bisection_take(&b, holds(&f, pl_bisection_next(&b)));
        }
        assert_int_equal(b.state, PL_BISECTION_FOUND);
        assert_int_equal(b.holds_below, below);
        assert_true(b.low <= 0.3 && 0.3 <= b.high);
    }
}

static void test_one_sided_engine_ends_after_both_ends(void **state)
{
    (void)state;
    const fake never = {.never = true}, always = {.always = true};
    const pl_bisection a = search(&never, 0, 1, true, 1e-6);
    const pl_bisection b = search(&always, 0, 1, false, 1e-6);
    assert_int_equal(a.state, PL_BISECTION_NEVER_HOLDS);
    assert_int_equal(b.state, PL_BISECTION_ALWAYS_HOLDS);
    assert_int_equal(a.trials, 2);
    assert_int_equal(b.trials, 2);
}

static void test_holding_at_the_wrong_end_is_reported(void **state)
{
    (void)state;
    const fake f = {.critical = 0.5, .holds_below = false};
    const pl_bisection b = search(&f, 0, 1, true, 1e-6);
    assert_int_equal(b.state, PL_BISECTION_REVERSED);
    assert_int_equal(b.trials, 2);
}

/* A tolerance below the numbers' own spacing ends at neighbours, not never. */
static void test_a_tolerance_too_small_ends_at_neighbouring_numbers(void **state)
{
    (void)state;
    const fake f = {.critical = 1.0 / 3, .holds_below = true};
    const pl_bisection b = search(&f, 0, 1, true, 1e-300);
    assert_int_equal(b.state, PL_BISECTION_FOUND);
    assert_true(nextafter(b.low, 1) == b.high);
    assert_true(b.low <= 1.0 / 3 && 1.0 / 3 <= b.high);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bracket_contains_the_value_at_requested_width),
        cmocka_unit_test(test_side_is_learnt_where_it_is_not_known),
        cmocka_unit_test(test_one_sided_engine_ends_after_both_ends),
        cmocka_unit_test(test_holding_at_the_wrong_end_is_reported),
        cmocka_unit_test(test_a_tolerance_too_small_ends_at_neighbouring_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
