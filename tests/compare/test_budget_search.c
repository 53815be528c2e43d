/* The search for the least iteration budget, on errors that are made up. */
#include "check.h"
#include "studies/iterations/budget_search.h"

#include <math.h>
#include <string.h>

enum { MOST = 1024 };

/* Engines that are made up: an error by budget, INFINITY where the scene falls. */
typedef double (*error_of)(long budget, const void *user);

typedef struct fake {
    error_of error;
    const void *user;
    long ends_at;      /* from here on a budget ends the search; 0: none does */
    long ends_between; /* a budget below this that is no doubling does */
    bool tried[MOST + 1];
} fake;

static void try_budget(fake *f, pl_budget_search *s)
{
    const long budget = pl_budget_next(s);
    assert_true(budget >= 1 && budget <= MOST);
    assert_false(f->tried[budget]);
    f->tried[budget] = true;
    const double found = f->error(budget, f->user);
    const bool ended = (f->ends_at > 0 && budget >= f->ends_at) ||
                       (budget < f->ends_between && (budget & (budget - 1)) != 0);
    pl_budget_take(s, ended ? (double)NAN : found);
}

static pl_budget_search search_in(fake *f, long least, long most)
{
    pl_budget_search s = pl_budget_begin(least, most, 1e-9);
    int tried = 0;
    memset(f->tried, 0, sizeof f->tried);
    while (s.state == PL_BUDGET_SEARCHING) {
        try_budget(f, &s);
        assert_true(s.trials <= pl_budget_most_trials(least, most));
    }
    for (int i = 0; i <= MOST; ++i) {
        tried += f->tried[i];
    }
    assert_int_equal(s.trials, tried);
    return s;
}

static pl_budget_search search(error_of error, const void *user)
{
    return search_in(&(fake){.error = error, .user = user}, 1, MOST);
}

static bool is_near(double error, double converged)
{
    return error <= 1.1 * converged + 1e-9;
}

/* a + b / n^p */
typedef struct decline {
    double a, b, p;
} decline;

static double declining(long budget, const void *user)
{
    const decline *d = user;
    return d->a + d->b / pow((double)budget, d->p);
}

static void test_falling_errors_give_the_least_sufficient_budget(void **state)
{
    (void)state;
    check_random random = {.state = 7};
    for (int i = 0; i < 300; ++i) {
        decline d;
        d.a = pow(10, check_uniform(&random, -6, 0));
        d.b = pow(10, check_uniform(&random, -3, 3));
        d.p = check_uniform(&random, 0.3, 2.5);
        const pl_budget_search found = search(declining, &d);
        assert_int_equal(found.state, PL_BUDGET_FOUND);
        assert_close(found.converged, declining(found.largest, &d), 0, 0);
        long least = 1;
        while (!is_near(declining(least, &d), found.converged)) {
            ++least;
        }
        assert_int_equal(found.budget, least);
    }
}

/* Every doubling halves the error up to the last budget, which counts as converged. */
static void test_unsettled_error_is_compared_to_the_largest_budget(void **state)
{
    (void)state;
    const pl_budget_search found = search(declining, &(decline){.a = 0, .b = 1, .p = 1});
    assert_int_equal(found.largest, 1024);
    assert_close(found.converged, 1.0 / 1024, 0, 1e-15);
    assert_int_equal(found.budget, 931); /* 1024 / 1.1 = 930.9 */
    assert_int_equal(found.trials, 20);
    assert_int_equal(pl_budget_most_trials(1, 1024), 20);
}

/* Every doubling leaves this part of the error. */
static double shrinking(long budget, const void *user)
{
    return pow(*(const double *)user, log2((double)budget));
}

static void test_doublings_that_change_one_percent_end_it(void **state)
{
    (void)state;
    const double less = 0.991, more = 0.989;
    assert_int_equal(search(shrinking, &less).largest, 4);
    assert_int_equal(search(shrinking, &more).largest, 1024);
}

static double constant(long budget, const void *user)
{
    (void)budget;
    return *(const double *)user;
}

/* Rounding alone: no two budgets have the same error, and all are below the floor. */
static double rounding(long budget, const void *user)
{
    (void)user;
    return 1e-13 * (double)(budget * 7919 % 101);
}

static void test_constant_error_needs_one_iteration_and_three_trials(void **state)
{
    (void)state;
    const double values[] = {0, 1e-12, 0.3, 1e6};
    for (int i = 0; i < 4; ++i) {
        const pl_budget_search found = search(constant, &values[i]);
        assert_int_equal(found.state, PL_BUDGET_FOUND);
        assert_int_equal(found.budget, 1);
        assert_int_equal(found.trials, 3);
    }
    const pl_budget_search found = search(rounding, NULL);
    assert_int_equal(found.budget, 1);
    assert_int_equal(found.trials, 3);
}

/* One small change is no rest: 8 to 16 is flat, and then it falls on. */
static double step_down(long budget, const void *user)
{
    (void)user;
    return budget < 8 ? 10.0 / (double)budget : budget < 32 ? 1 : 0.5;
}

static void test_one_flat_doubling_is_not_converged(void **state)
{
    (void)state;
    const pl_budget_search found = search(step_down, NULL);
    assert_int_equal(found.largest, 128);
    assert_close(found.converged, 0.5, 0, 0);
    assert_int_equal(found.budget, 32);
}

/* 100 / n down to 1, but by luck half of that at 4. */
static double lucky_at_four(long budget, const void *user)
{
    (void)user;
    return budget == 4 ? 0.5 : fmax(1, 100.0 / (double)budget);
}

static void test_luck_at_one_budget_does_not_count(void **state)
{
    (void)state;
    const pl_budget_search found = search(lucky_at_four, NULL);
    assert_close(found.converged, 1, 0, 0);
    assert_int_equal(found.budget, 91); /* 100 / 1.1 = 90.9 */
}

/* The noise differs from budget to budget, and one run in eight falls. */
static double noisy(long budget, const void *user)
{
    check_random random = {.state = *(const uint64_t *)user + 2654435761u * (uint64_t)budget};
    for (int i = 0; i < 8; ++i) {
        check_uniform(&random, 0, 1);
    }
    double error = 1 + 3 / (double)budget + check_uniform(&random, 0, 0.4);
    return check_uniform(&random, 0, 1) < 0.125 ? (double)INFINITY : error;
}

static void test_noisy_errors_are_near_at_budget_and_double(void **state)
{
    (void)state;
    int found_count = 0;
    for (uint64_t seed = 1; seed <= 500; ++seed) {
        const pl_budget_search found = search(noisy, &seed);
        if (found.state != PL_BUDGET_FOUND) {
            assert_int_equal(found.state, PL_BUDGET_LARGEST_FAILED);
            assert_true(isinf(noisy(1024, &seed)));
            assert_int_equal(found.budget, 0);
            continue;
        }
        ++found_count;
        long above = 1;
        while (above <= found.budget) {
            above *= 2;
        }
        assert_true(is_near(noisy(found.budget, &seed), found.converged));
        assert_true(above > found.largest || is_near(noisy(above, &seed), found.converged));
        assert_true(found.budget <= found.largest);
        /* Bisection has seen that the one below it is not. */
        const long below = found.budget - 1;
        assert_true(below == 0 || !is_near(noisy(below, &seed), found.converged));
    }
    assert_true(found_count > 400);
}

/* Falls below a budget; above it almost right at once. */
static double stands_from(long budget, const void *user)
{
    return budget < *(const long *)user ? (double)INFINITY : 1 + 1.0 / (double)budget;
}

static void test_budgets_that_fall_are_neither_converged_nor_near(void **state)
{
    (void)state;
    for (long from = 20; from <= MOST; from += 7) {
        const pl_budget_search found = search(stands_from, &from);
        assert_int_equal(found.state, PL_BUDGET_FOUND);
        assert_int_equal(found.budget, from);
        assert_true(found.largest >= from);
    }
}

static void test_what_never_holds_has_no_budget(void **state)
{
    (void)state;
    const long from = MOST + 1;
    const pl_budget_search found = search(stands_from, &from);
    assert_int_equal(found.state, PL_BUDGET_ALL_FAILED);
    assert_int_equal(found.budget, 0);
    assert_int_equal(found.largest, 1024);
    assert_int_equal(found.trials, 11);
    assert_true(isnan(found.converged));
}

static double holds_below_the_end(long budget, const void *user)
{
    (void)user;
    return budget == 1024 ? (double)INFINITY : 1.0 / (double)budget;
}

static void test_a_largest_budget_that_falls_leaves_nothing_converged(void **state)
{
    (void)state;
    const pl_budget_search found = search(holds_below_the_end, NULL);
    assert_int_equal(found.state, PL_BUDGET_LARGEST_FAILED);
    assert_int_equal(found.budget, 0);
    assert_true(isnan(found.converged));
}

static void test_trial_that_ends_the_search_is_last(void **state)
{
    (void)state;
    fake f = {.error = declining, .user = &(decline){.a = 0, .b = 1, .p = 1}, .ends_at = 64};
    const pl_budget_search found = search_in(&f, 1, MOST);
    assert_int_equal(found.state, PL_BUDGET_STOPPED);
    assert_int_equal(found.largest, 64);
    assert_int_equal(found.trials, 7);
    assert_int_equal(found.budget, 0);
    f = (fake){.error = declining, .user = f.user, .ends_between = 950};
    const pl_budget_search between = search_in(&f, 1, MOST);
    assert_int_equal(between.state, PL_BUDGET_STOPPED);
    assert_int_equal(between.trials, 12); /* the first of the bisection, 768 */
    assert_int_equal(between.budget, 0);
}

static void test_other_ranges_are_doubled_from_their_least(void **state)
{
    (void)state;
    fake f = {.error = declining, .user = &(decline){.a = 0, .b = 1, .p = 1}};
    const pl_budget_search found = search_in(&f, 3, 50);
    assert_int_equal(found.largest, 48);
    assert_int_equal(found.budget, 44); /* 48 / 1.1 = 43.6 */
    const pl_budget_search one = search_in(&f, 5, 5);
    assert_int_equal(one.budget, 5);
    assert_int_equal(one.trials, 1);
    assert_int_equal(pl_budget_most_trials(5, 5), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_falling_errors_give_the_least_sufficient_budget),
        cmocka_unit_test(test_unsettled_error_is_compared_to_the_largest_budget),
        cmocka_unit_test(test_doublings_that_change_one_percent_end_it),
        cmocka_unit_test(test_constant_error_needs_one_iteration_and_three_trials),
        cmocka_unit_test(test_one_flat_doubling_is_not_converged),
        cmocka_unit_test(test_luck_at_one_budget_does_not_count),
        cmocka_unit_test(test_noisy_errors_are_near_at_budget_and_double),
        cmocka_unit_test(test_budgets_that_fall_are_neither_converged_nor_near),
        cmocka_unit_test(test_what_never_holds_has_no_budget),
        cmocka_unit_test(test_a_largest_budget_that_falls_leaves_nothing_converged),
        cmocka_unit_test(test_trial_that_ends_the_search_is_last),
        cmocka_unit_test(test_other_ranges_are_doubled_from_their_least),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
