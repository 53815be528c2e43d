/* The error that halvings of the step leave, and from when on a body differs, on paths that are
 * written by hand. */
#include "check.h"
#include "studies/reference/reference_verdict.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 61 };

/* Paths of one body along x. */
static pl_body_paths make_paths(double (*x)(double t, double k), double k)
{
    pl_body_paths paths = {.bodies = 1, .samples = SAMPLES, .completed = true};
    paths.moved = calloc(3 * SAMPLES, sizeof *paths.moved);
    for (long i = 0; i < SAMPLES; ++i) {
        paths.moved[3 * i] = x((double)i / 60, k);
    }
    return paths;
}

/* The estimate at a sample after `count` steps, of which the last is number count - 1. */
static double estimate_at(double (*x)(double t, double k), int count, long sample)
{
    pl_body_paths levels[8];
    double error[SAMPLES];
    for (int k = 0; k < count; ++k) {
        levels[k] = make_paths(x, k);
    }
    pl_halving_error(levels, count, 1.0 / 60, error);
    for (int k = 0; k < count; ++k) {
        pl_body_paths_free(&levels[k]);
    }
    return error[sample];
}

static double first_order(double t, double k)
{
    (void)t;
    return 1 + 0.1 * exp2(-k);
}

static double second_order(double t, double k)
{
    (void)t;
    return 1 - 0.1 * exp2(-2 * k);
}

static void test_estimate_is_exact_for_orders_1_and_2(void **state)
{
    (void)state;
    assert_close(estimate_at(first_order, 4, 30), 0.1 / 8, 0, 1e-9);
    assert_close(estimate_at(second_order, 4, 30), 0.1 / 64, 0, 1e-9);
}

/* The third step happens to give what the second gave. */
static double lucky(double t, double k)
{
    (void)t;
    return k == 0 ? 0.1 : 0;
}

static void test_lucky_halving_claims_no_accuracy(void **state)
{
    (void)state;
    assert_close(estimate_at(lucky, 3, 30), 0.1 / 4 / 3, 0, 1e-12);
}

static double crossing(double t, double k)
{
    return exp2(-k) * (t - 0.5);
}

static void test_crossing_paths_keep_an_error(void **state)
{
    (void)state;
    /* At the crossing all steps agree; in the window about it they are up to 0.1 s / 8 apart. */
    assert_close(estimate_at(crossing, 4, 30), pl_halving_window / 8, 0, 1e-9);
}

static double erratic(double t, double k)
{
    (void)t;
    return k == 1 || k == 2 ? 1 : 0;
}

static void test_erratic_halvings_leave_all_their_change(void **state)
{
    (void)state;
    assert_true(estimate_at(erratic, 4, 30) > 1);
}

/* ---- From when on a body differs ---- */

static double still(double t, double k)
{
    (void)t;
    (void)k;
    return 0;
}

/* Away by k between 0.2 and 0.4 s, and from 0.7 s on. */
static double leaves_twice(double t, double k)
{
    return (t > 0.199 && t < 0.4) || t > 0.699 ? k : 0;
}

static double comes_back(double t, double k)
{
    return t > 0.199 && t < 0.9 ? k : 0;
}

/* The verdict on a body with a bound of 0.01 m, of which the reference knows the place to `error`,
 * until the sample `horizon`. */
static pl_body_verdict judge(double (*x)(double t, double k), double away, double error,
                             long horizon)
{
    double bound = 0.01, errors[SAMPLES];
    pl_body_paths paths = make_paths(x, away);
    pl_reference reference = {.bodies = 1,
                              .samples = SAMPLES,
                              .interval = 1.0 / 60,
                              .bounds = &bound,
                              .horizon = &horizon,
                              .allowance = errors};
    for (int i = 0; i < SAMPLES; ++i) {
        errors[i] = error;
    }
    reference.engines[0].count = 1;
    reference.engines[0].levels[0] = make_paths(still, 0);
    const pl_body_verdict verdict = pl_body_judge(&reference, &paths, 0);
    pl_body_paths_free(&reference.engines[0].levels[0]);
    pl_body_paths_free(&paths);
    return verdict;
}

static void test_body_differs_from_where_it_stays_away(void **state)
{
    (void)state;
    const pl_body_verdict verdict = judge(leaves_twice, 0.02, 1e-6, SAMPLES);
    assert_close(verdict.differs_from, 0.7, 1e-12, 0);
    assert_close(verdict.final, 0.02, 1e-15, 0);
    assert_close(verdict.until, 1, 1e-12, 0);
}

static void test_body_that_comes_back_agrees(void **state)
{
    (void)state;
    const pl_body_verdict verdict = judge(comes_back, 0.02, 1e-6, SAMPLES);
    assert_true(isnan(verdict.differs_from));
    assert_close(verdict.largest, 0.02, 1e-15, 0);
}

static void test_distance_within_bound_or_error_agrees(void **state)
{
    (void)state;
    assert_true(isnan(judge(leaves_twice, 0.0099, 1e-6, SAMPLES).differs_from));
    assert_true(isnan(judge(leaves_twice, 0.0299, 0.01, SAMPLES).differs_from));
    assert_true(judge(leaves_twice, 0.0301, 0.01, SAMPLES).differs_from > 0.69);
}

static void test_nothing_is_judged_after_the_horizon(void **state)
{
    (void)state;
    const pl_body_verdict verdict = judge(leaves_twice, 1, 1e-6, 40);
    assert_true(isnan(verdict.differs_from));
    assert_close(verdict.until, 39.0 / 60, 1e-12, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_estimate_is_exact_for_orders_1_and_2),
        cmocka_unit_test(test_lucky_halving_claims_no_accuracy),
        cmocka_unit_test(test_crossing_paths_keep_an_error),
        cmocka_unit_test(test_erratic_halvings_leave_all_their_change),
        cmocka_unit_test(test_body_differs_from_where_it_stays_away),
        cmocka_unit_test(test_body_that_comes_back_agrees),
        cmocka_unit_test(test_distance_within_bound_or_error_agrees),
        cmocka_unit_test(test_nothing_is_judged_after_the_horizon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
