/* The search for the cheapest point that meets a target, on costs and errors whose optimum is
 * known. */
#include "check.h"
#include "studies/tune/tune_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BUDGET = 200 };

/* A made-up engine: what its points cost, and by what they miss the target. */
typedef struct made_up {
    double (*cost)(const double *values);
    double (*excess)(const double *values);
    double noise; /* part of the cost, at most */
    check_random random;
    int parameter_count;
    int asked, stop_at; /* 0: never */
    double seen[BUDGET][PL_TUNE_MAX_PARAMETERS];
} made_up;

static const pl_tune_parameter parameters[] = {
    {.name = "iterations",
     .low = 1,
     .high = 100,
     .logarithmic = true,
     .integer = true,
     .spends = true,
     .start = 1},
    {.name = "erp", .low = 0, .high = 1, .start = 0},
    {.name = "margin", .low = 0, .high = 1, .start = 0.2},
    {.name = "slop", .low = 0, .high = 1, .start = 0.2},
    {.name = "layer", .low = 0, .high = 1, .start = 0.2},
};

/* Each point once, in range, whole where it should be. */
static void check_point(made_up *m, const double *values)
{
    for (int k = 0; k < m->parameter_count; ++k) {
        assert_true(values[k] >= parameters[k].low && values[k] <= parameters[k].high);
        assert_true(!parameters[k].integer || values[k] == floor(values[k]));
    }
    for (int i = 0; i < m->asked; ++i) {
        assert_true(m->parameter_count == 0 ||
                    memcmp(m->seen[i], values, (size_t)m->parameter_count * sizeof *values) != 0);
    }
    memcpy(m->seen[m->asked], values, sizeof m->seen[0]);
}

static bool measure(void *user, pl_evaluation *evaluation)
{
    made_up *m = user;
    assert_true(m->asked < BUDGET);
    check_point(m, evaluation->values);
    m->asked += 1;
    evaluation->cost =
        m->cost(evaluation->values) * (1 + check_uniform(&m->random, -m->noise, m->noise));
    evaluation->excess = m->excess(evaluation->values);
    return m->asked != m->stop_at;
}

static made_up make(double (*cost)(const double *), double (*excess)(const double *), int count)
{
    return (made_up){
        .cost = cost, .excess = excess, .random = {.state = 7}, .parameter_count = count};
}

static pl_search_result search(made_up *m, int budget, uint64_t seed)
{
    const pl_search_def def = {.parameters = parameters,
                               .parameter_count = m->parameter_count,
                               .budget = budget,
                               .seed = seed,
                               .user = m,
                               .measure = measure};
    pl_search_result found;
    pl_search(&def, &found);
    assert_true(found.count <= budget);
    for (int i = 0; i < found.count; ++i) {
        assert_false(
            pl_evaluation_is_better(&found.evaluations[i], &found.evaluations[found.best]));
    }
    return found;
}

static double valley_cost(const double *v)
{
    return v[0] * (1 + v[1]);
}

/* error 100 / n^2 (1 + 10 (e - 0.3)^2) against a target of 1: infeasible at the start. */
static double valley_excess(const double *v)
{
    return log(100 / (v[0] * v[0]) * (1 + 10 * (v[1] - 0.3) * (v[1] - 0.3)));
}

static double least_cost(void)
{
    double least = (double)INFINITY;
    for (int n = 1; n <= 100; ++n) {
        for (int e = 0; e <= 1000; ++e) {
            const double values[2] = {n, e / 1000.0};
            if (valley_excess(values) <= 0) {
                least = fmin(least, valley_cost(values));
            }
        }
    }
    return least;
}

static void test_search_finds_integer_and_continuous_optimum(void **state)
{
    (void)state;
    const double least = least_cost();
    for (uint64_t seed = 0; seed < 10; ++seed) {
        made_up m = make(valley_cost, valley_excess, 2);
        pl_search_result found = search(&m, BUDGET, seed);
        assert_true(found.evaluations[0].excess > 0);
        assert_true(found.evaluations[0].values[0] == 1 && found.evaluations[0].values[1] == 0);
        assert_true(found.met);
        assert_true(found.evaluations[found.best].excess <= 0);
        assert_at_most(found.evaluations[found.best].cost, 1.03 * least);
        free(found.evaluations);
    }
}

static void test_cost_noise_bounds_the_loss_of_search(void **state)
{
    (void)state;
    const double least = least_cost();
    for (uint64_t seed = 0; seed < 10; ++seed) {
        made_up m = make(valley_cost, valley_excess, 2);
        m.noise = 0.1;
        pl_search_result found = search(&m, BUDGET, seed);
        assert_true(found.met);
        assert_at_most(valley_cost(found.evaluations[found.best].values), 1.1 / 0.9 * 1.03 * least);
        free(found.evaluations);
    }
}

/* The promise of tuning is 1.3 times the least cost. The target is met with 40 iterations where the
 * other options have their defaults, and by a factor of 20 more for each tenth that one is off. */
static double default_excess(const double *v)
{
    double off = v[1];
    for (int k = 2; k < 5; ++k) {
        off += fabs(v[k] - parameters[k].start);
    }
    return log(40 / v[0]) + 10 * log(20) * off;
}

static double iterations_cost(const double *v)
{
    return v[0];
}

static void test_default_values_that_are_right_are_kept(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 10; ++seed) {
        made_up m = make(iterations_cost, default_excess, 5);
        pl_search_result found = search(&m, BUDGET, seed);
        assert_true(found.met);
        assert_at_most(found.evaluations[found.best].cost, 1.3 * 40);
        free(found.evaluations);
    }
}

static double bowl_excess(const double *v)
{
    return 1 + pow(log(v[0] / 20), 2) + pow(v[1] - 0.7, 2);
}

static void test_unmet_target_reports_the_nearest_point(void **state)
{
    (void)state;
    made_up m = make(valley_cost, bowl_excess, 2);
    pl_search_result found = search(&m, BUDGET, 3);
    assert_false(found.met);
    assert_int_equal(found.count, BUDGET);
    assert_at_most(found.evaluations[found.best].excess, 1.01);
    free(found.evaluations);
}

static double flat(const double *v)
{
    (void)v;
    return 1;
}

static double none(const double *v)
{
    (void)v;
    return (double)INFINITY;
}

static double met(const double *v)
{
    (void)v;
    return -1;
}

static double worst(const double *v)
{
    (void)v;
    return PL_SEARCH_WORST;
}

static void test_plateaus_and_failed_points_end_the_search(void **state)
{
    (void)state;
    double (*const costs[])(const double *) = {flat, none, flat};
    double (*const excesses[])(const double *) = {met, worst, worst};
    for (int i = 0; i < 3; ++i) {
        made_up m = make(costs[i], excesses[i], 2);
        pl_search_result found = search(&m, 50, 1);
        assert_int_equal(found.met, excesses[i] == met);
        assert_true(found.best >= 0);
        free(found.evaluations);
    }
}

static void test_small_parameter_space_is_searched_completely(void **state)
{
    (void)state;
    made_up m = make(flat, met, 1); /* 100 whole numbers */
    pl_search_result found = search(&m, BUDGET, 1);
    assert_true(found.count > 50 && found.count <= 100);
    free(found.evaluations);
    made_up point = make(flat, met, 0);
    found = search(&point, BUDGET, 1);
    assert_int_equal(found.count, 1);
    assert_true(found.met);
    free(found.evaluations);
}

static void test_equal_seeds_give_equal_points(void **state)
{
    (void)state;
    pl_search_result found[3];
    for (int i = 0; i < 3; ++i) {
        made_up m = make(valley_cost, valley_excess, 2);
        found[i] = search(&m, BUDGET, i < 2 ? 5 : 6);
    }
    assert_int_equal(found[0].count, found[1].count);
    const size_t size = (size_t)found[0].count * sizeof *found[0].evaluations;
    assert_memory_equal(found[0].evaluations, found[1].evaluations, size);
    assert_memory_not_equal(found[0].evaluations, found[2].evaluations, size);
    for (int i = 0; i < 3; ++i) {
        free(found[i].evaluations);
    }
}

static void test_the_budget_is_kept_however_small(void **state)
{
    (void)state;
    for (int budget = 1; budget <= 12; ++budget) {
        made_up m = make(valley_cost, valley_excess, 2);
        pl_search_result found = search(&m, budget, 1);
        assert_int_equal(found.count, budget);
        assert_int_equal(m.asked, budget);
        free(found.evaluations);
    }
}

/* In every stage. */
static void test_stop_keeps_the_points_before_it(void **state)
{
    (void)state;
    for (int at = 1; at <= BUDGET; at += 13) {
        made_up m = make(valley_cost, valley_excess, 2);
        pl_search_def def = {.parameters = parameters,
                             .parameter_count = 2,
                             .budget = BUDGET,
                             .seed = 1,
                             .user = &m,
                             .measure = measure};
        pl_search_result found;
        m.stop_at = at;
        pl_search(&def, &found);
        assert_true(found.stopped && found.count == at - 1 && m.asked == at);
        free(found.evaluations);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_search_finds_integer_and_continuous_optimum),
        cmocka_unit_test(test_cost_noise_bounds_the_loss_of_search),
        cmocka_unit_test(test_default_values_that_are_right_are_kept),
        cmocka_unit_test(test_unmet_target_reports_the_nearest_point),
        cmocka_unit_test(test_plateaus_and_failed_points_end_the_search),
        cmocka_unit_test(test_small_parameter_space_is_searched_completely),
        cmocka_unit_test(test_equal_seeds_give_equal_points),
        cmocka_unit_test(test_the_budget_is_kept_however_small),
        cmocka_unit_test(test_stop_keeps_the_points_before_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
