/* When two ensembles count as apart, of samples whose p follows from counting. */
#include "check.h"
#include "studies/ensemble/two_sample.h"
#include "studies/ensemble/verdict.h"

#include <string.h>

enum { MOST = 8 };

/* Two engines on one case of which one observable is known. */
static json_t *judge(const double *a, int count_a, const double *b, int count_b)
{
    double values[2][MOST];
    pl_ensemble_view views[2] = {{.ensemble = {.configuration = 0}},
                                 {.ensemble = {.configuration = 1}}};
    memcpy(values[0], a, (size_t)count_a * sizeof *a);
    memcpy(values[1], b, (size_t)count_b * sizeof *b);
    views[0].observed.samples[0] = (pl_sample){.values = values[0], .count = count_a};
    views[1].observed.samples[0] = (pl_sample){.values = values[1], .count = count_b};
    json_t *verdicts = pl_verdicts_reach(views, 2);
    assert_int_equal(json_array_size(verdicts), 1);
    json_t *found = json_incref(json_array_get(verdicts, 0));
    json_decref(verdicts);
    return found;
}

static double number(const json_t *found, const char *key)
{
    return json_number_value(json_object_get(found, key));
}

/* Of the ways to deal evenly spaced values, two are as far apart as the lowest and the rest: those
 * with the lowest and with the highest in one hand. */
static void test_apart_begins_below_five_percent(void **state)
{
    (void)state;
    const double all[] = {1, 2, 3, 4, 5, 6, 7, 8};
    json_t *even = judge(all, 4, all + 4, 4), *few = judge(all, 3, all + 3, 4);
    assert_close(number(even, "p_corrected"), 2.0 / 70, 1e-15, 0);
    assert_string_equal(json_string_value(json_object_get(even, "verdict")), "told apart");
    assert_close(number(few, "p_corrected"), 2.0 / 35, 1e-15, 0);
    assert_string_equal(json_string_value(json_object_get(few, "verdict")), "not told apart");
    json_decref(even);
    json_decref(few);
}

static void test_noise_is_that_of_the_noisier_ensemble(void **state)
{
    (void)state;
    const double still[] = {0, 0, 0, 0, 0, 0, 0, 1e-3}, wide[] = {0, 9, 2, 7, 1, 8, 3, 5};
    const pl_noise noise = pl_split_half_noise(wide, MOST, MOST, MOST);
    for (int order = 0; order < 2; ++order) {
        json_t *found = judge(order == 0 ? still : wide, MOST, order == 0 ? wide : still, MOST);
        assert_close(number(found, "energy_distance_floor"), noise.energy, 0, 1e-15);
        assert_true(number(found, "ks_floor") >= noise.ks);
        json_decref(found);
    }
}

/* Three engines on two cases, with a second setting and a reference of each. All observables have
 * values on all of them, so that every planned comparison is made. */
static void test_planned_comparisons_are_those_made(void **state)
{
    (void)state;
    enum { COUNT = 18 };
    double values[MOST] = {1, 2, 3, 4, 5, 6, 7, 8};
    pl_ensemble items[COUNT];
    pl_ensemble_view views[COUNT] = {0};
    for (int i = 0; i < COUNT; ++i) {
        const int row = i / 3 % 3;
        items[i] = (pl_ensemble){.test_case = i / 9,
                                 .setting = row == 1 ? 1 : 0,
                                 .configuration = row == 2 ? 3 + i % 3 : i % 3,
                                 .reference = row == 2};
        views[i].ensemble = items[i];
        for (int k = 0; k < PL_METRIC_COUNT; ++k) {
            views[i].observed.samples[k] =
                (pl_sample){.values = values, .count = pl_is_observable(k) ? 4 : 0};
        }
    }
    const pl_ensembles all = {.items = items, .count = COUNT, .members = 8};
    json_t *verdicts = pl_verdicts_reach(views, COUNT);
    int observables = 0;
    for (int k = 0; k < PL_METRIC_COUNT; ++k) {
        observables += pl_is_observable(k);
    }
    assert_int_equal(pl_verdicts_planned(&all), json_array_size(verdicts));
    assert_int_equal(json_array_size(verdicts), 2 * (15 + 3) * observables);
    json_decref(verdicts);
}

static void test_too_few_members_are_refused(void **state)
{
    (void)state;
    pl_ensemble items[2] = {{.configuration = 0}, {.configuration = 1}};
    pl_ensembles all = {.items = items, .count = 2};
    for (all.members = 2; all.members < 10; ++all.members) {
        pl_error error = {.message = ""};
        const pl_status expected = all.members < 6 ? PL_BAD_INPUT : PL_OK;
        assert_int_equal(pl_verdicts_possible(&all, &error), expected);
        if (expected != PL_OK) {
            assert_contains(error.message, "at least 6 are needed for 7 comparisons at 5 %");
        }
    }
    all.members = 2;
    all.count = 1;
    assert_int_equal(pl_verdicts_possible(&all, NULL), PL_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_apart_begins_below_five_percent),
        cmocka_unit_test(test_noise_is_that_of_the_noisier_ensemble),
        cmocka_unit_test(test_planned_comparisons_are_those_made),
        cmocka_unit_test(test_too_few_members_are_refused),
    };
    return cmocka_run_group_tests_name("ensemble verdict", tests, NULL, NULL);
}
