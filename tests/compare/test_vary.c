/* --vary KEY=VALUES: what is understood, and what is refused in which words. */
#include "check.h"
#include "studies/vary.h"

#include <math.h>
#include <string.h>

static void check_numbers(const char *text, const double *expected, int count)
{
    pl_vary vary;
    pl_error error = {.message = ""};
    if (pl_vary_parse(text, PL_VARY_VALUES, &vary, &error) != PL_OK) {
        fail_msg("%s: %s", text, error.message);
    }
    assert_null(vary.names);
    assert_int_equal(vary.count, count);
    for (int i = 0; i < count; ++i) {
        if (vary.numbers[i] != expected[i]) {
            fail_msg("%s: value %d is %.17g, expected %.17g", text, i, vary.numbers[i],
                     expected[i]);
        }
    }
    pl_vary_free(&vary);
}

#define CHECK_NUMBERS(text, ...)                                                                   \
    check_numbers(text, (const double[]){__VA_ARGS__},                                             \
                  (int)(sizeof(double[]){__VA_ARGS__} / sizeof(double)))

static void test_lists_and_ranges_are_their_numbers(void **state)
{
    (void)state;
    CHECK_NUMBERS("n=3", 3);
    CHECK_NUMBERS("n=3,1,2", 3, 1, 2);
    CHECK_NUMBERS("n=-2,1e-3", -2, 1e-3);
    CHECK_NUMBERS("n=1..5", 1, 2, 3, 4, 5);
    CHECK_NUMBERS("n=-1..1", -1, 0, 1);
    CHECK_NUMBERS("n=0..1:+0.25", 0, 0.25, 0.5, 0.75, 1);
    CHECK_NUMBERS("n=1..256:x2", 1, 2, 4, 8, 16, 32, 64, 128, 256);
    CHECK_NUMBERS("n=1e-8..1e-5:x10", 1e-8, 1e-7, 1e-6, 1e-5);
    CHECK_NUMBERS("n=2..2", 2);
    CHECK_NUMBERS("n=2..2:x7", 2);
    CHECK_NUMBERS("n=1..3,10,20..40:+10", 1, 2, 3, 10, 20, 30, 40);
}

static void test_fractions_are_the_numbers_that_dt_takes(void **state)
{
    (void)state;
    CHECK_NUMBERS("dt=1/60,1/240", 1.0 / 60, 1.0 / 240);
    CHECK_NUMBERS("dt=1/240..1/30:x2", 1.0 / 240, 1.0 / 120, 1.0 / 60, 1.0 / 30);
    CHECK_NUMBERS("dt=0..1:+1/4", 0, 0.25, 0.5, 0.75, 1);
}

static void test_decimal_ranges_have_decimal_values(void **state)
{
    (void)state;
    CHECK_NUMBERS("n=0..0.7:+0.1", 0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7);
    CHECK_NUMBERS("n=0.1..0.8:x2", 0.1, 0.2, 0.4, 0.8);
}

static void test_a_range_ends_where_its_last_step_does(void **state)
{
    (void)state;
    CHECK_NUMBERS("n=1..2.5", 1, 2);
    CHECK_NUMBERS("n=0..1:+0.4", 0, 0.4, 0.8);
    CHECK_NUMBERS("n=1..100:x10", 1, 10, 100);
    CHECK_NUMBERS("n=1..99:x10", 1, 10);
}

static void test_a_value_that_comes_again_is_left_out(void **state)
{
    (void)state;
    CHECK_NUMBERS("n=2,1..3,1,2.0", 2, 1, 3);
}

static void test_long_ranges_are_whole(void **state)
{
    (void)state;
    pl_vary vary;
    assert_int_equal(pl_vary_parse("n=1..100000", PL_VARY_VALUES, &vary, NULL), PL_OK);
    assert_int_equal(vary.count, PL_VARY_MOST_VALUES);
    for (int i = 0; i < vary.count; ++i) {
        assert_true(vary.numbers[i] == i + 1);
    }
    pl_vary_free(&vary);
}

static void check_key(const char *text, const char *owner, const char *key)
{
    pl_vary vary;
    assert_int_equal(pl_vary_parse(text, PL_VARY_VALUES, &vary, NULL), PL_OK);
    assert_string_equal(vary.owner, owner);
    assert_string_equal(vary.key, key);
    pl_vary_free(&vary);
}

static void test_key_may_name_one_engine_or_scenario(void **state)
{
    (void)state;
    check_key("iterations=1", "", "iterations");
    check_key("ode.iterations=1", "ode", "iterations");
    check_key("slope-slide.angle=1", "slope-slide", "angle");
    check_key("my.engine.erp=0.5", "my.engine", "erp");
}

static void test_solver_and_profile_take_names(void **state)
{
    (void)state;
    static const char *const texts[] = {"solver=quick,dantzig,quick", "profile=quick,dantzig"};
    for (int i = 0; i < 2; ++i) {
        pl_vary vary;
        assert_int_equal(pl_vary_parse(texts[i], PL_VARY_VALUES, &vary, NULL), PL_OK);
        assert_string_equal(vary.key, "profile");
        assert_null(vary.numbers);
        assert_int_equal(vary.count, 2);
        assert_string_equal(vary.names[0], "quick");
        assert_string_equal(vary.names[1], "dantzig");
        pl_vary_free(&vary);
    }
}

static void test_what_is_wrong_is_said(void **state)
{
    (void)state;
    static const char *const wrong[][2] = {
        {"iterations", "takes KEY=VALUES or ENGINE.KEY=VALUES; found \"iterations\""},
        {"=1", "takes KEY=VALUES"},
        {".n=1", "takes KEY=VALUES"},
        {"ode.=1", "takes KEY=VALUES"},
        {"n=", "--vary n: a value is missing"},
        {"n=1,,2", "a value is missing"},
        {"n=1,", "a value is missing"},
        {"profile=", "a value is missing"},
        {"n=a", "\"a\" is no number"},
        {"slver=quick", "\"quick\" is no number"},
        {"slver=quick", "such as 1/60; did you mean solver?"},
        {"n=1/0", "\"1/0\" is no number"},
        {"n=nan", "\"nan\" is no number"},
        {"n=inf..3", "\"inf\" is no number"},
        {"n=1..", "\"\" is no number"},
        {"n=..3", "\"\" is no number"},
        {"n=1..2..3", "\"2..3\" is no number"},
        {"n=1..9:2", "after \":\" expected +STEP or xFACTOR, found \"2\""},
        {"n=1..9:", "after \":\" expected"},
        {"n=1..9:+", "\"\" is no number"},
        {"n=9..1", "9..1 is empty: a range goes up, from 1 to 9"},
        {"n=9..1:x2", "is empty"},
        {"n=1..9:+0", "is endless: the step must be above 0"},
        {"n=1..9:+-1", "is endless"},
        {"n=1..9:x1", "is endless: the factor must be above 1"},
        {"n=1..9:x0.5", "is endless"},
        {"n=0..9:x2", "must begin above 0"},
        {"n=-1..9:x2", "must begin above 0"},
        {"n=0..100000", "more than 100000 values"},
        {"n=0..1:+1e-300", "more than 100000 values"},
        {"n=1..2:x1.000000000000001", "more than 100000 values"},
        {"n=1..60000,100001..160000", "more than 100000 values"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pl_vary vary;
        pl_error error = {.message = ""};
        if (pl_vary_parse(wrong[i][0], PL_VARY_VALUES, &vary, &error) != PL_BAD_INPUT) {
            fail_msg("%s was taken", wrong[i][0]);
        }
        assert_contains(error.message, wrong[i][1]);
        assert_contains(error.message, "--vary");
        assert_null(vary.numbers);
        assert_null(vary.names);
    }
}

static void test_forms_take_a_range_or_one_value(void **state)
{
    (void)state;
    pl_vary vary;
    assert_int_equal(pl_vary_parse("ode.dt=1/240..1/60", PL_VARY_RANGE, &vary, NULL), PL_OK);
    assert_string_equal(vary.owner, "ode");
    assert_true(vary.low == 1.0 / 240 && vary.high == 1.0 / 60 && vary.count == 0);
    assert_true(pl_vary_is_of(&vary, "ode") && !pl_vary_is_of(&vary, "bullet"));
    assert_int_equal(pl_vary_parse("updates=100..2e6", PL_VARY_KNOWN_RANGE, &vary, NULL), PL_OK);
    assert_true(vary.low == 100 && vary.high == 2e6 && pl_vary_is_of(&vary, "ode"));
    assert_int_equal(pl_vary_parse("solver", PL_VARY_KNOWN_RANGE, &vary, NULL), PL_OK);
    assert_string_equal(vary.key, "solver");
    assert_true(isnan(vary.low) && isnan(vary.high));
    assert_int_equal(pl_vary_parse("slop=1/8", PL_VARY_FIX, &vary, NULL), PL_OK);
    assert_true(vary.count == 1 && vary.numbers[0] == 0.125);
    pl_vary_free(&vary);
}

static void test_what_is_not_of_the_form_is_said(void **state)
{
    (void)state;
    static const struct {
        pl_vary_form form;
        const char *text, *part;
    } wrong[] = {
        {PL_VARY_RANGE, "slop", "--vary takes KEY=LOW..HIGH; found \"slop\""},
        {PL_VARY_RANGE, "slop=1,2", "--vary takes KEY=LOW..HIGH"},
        {PL_VARY_RANGE, "=1..2", "--vary takes KEY=LOW..HIGH"},
        {PL_VARY_RANGE, "slop=1..2,5..6", "--vary slop: \"2,5..6\" is no number"},
        {PL_VARY_RANGE, "slop=1..4:x2", "\"4:x2\" is no number"},
        {PL_VARY_RANGE, "slop=3..2", "3..2 is empty: a range goes up, from 2 to 3"},
        {PL_VARY_RANGE, "slop=2..2", "2..2 is empty: its ends are equal"},
        {PL_VARY_KNOWN_RANGE, "mu=1", "--vary takes NAME or NAME=LOW..HIGH; found \"mu=1\""},
        {PL_VARY_KNOWN_RANGE, "mu=2..1", "--vary mu: 2..1 is empty"},
        {PL_VARY_FIX, "slop", "--fix takes KEY=VALUE; found \"slop\""},
        {PL_VARY_FIX, "slop=1..2", "--fix slop: \"1..2\" is no number"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pl_vary vary;
        pl_error error = {.message = ""};
        assert_int_equal(pl_vary_parse(wrong[i].text, wrong[i].form, &vary, &error), PL_BAD_INPUT);
        assert_contains(error.message, wrong[i].part);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lists_and_ranges_are_their_numbers),
        cmocka_unit_test(test_fractions_are_the_numbers_that_dt_takes),
        cmocka_unit_test(test_decimal_ranges_have_decimal_values),
        cmocka_unit_test(test_a_range_ends_where_its_last_step_does),
        cmocka_unit_test(test_a_value_that_comes_again_is_left_out),
        cmocka_unit_test(test_long_ranges_are_whole),
        cmocka_unit_test(test_key_may_name_one_engine_or_scenario),
        cmocka_unit_test(test_solver_and_profile_take_names),
        cmocka_unit_test(test_what_is_wrong_is_said),
        cmocka_unit_test(test_forms_take_a_range_or_one_value),
        cmocka_unit_test(test_what_is_not_of_the_form_is_said),
    };
    return cmocka_run_group_tests_name("vary", tests, NULL, NULL);
}
