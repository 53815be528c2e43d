/* A wrong number of a conformance check tells the mistake that it comes from. */
#include "check.h"
#include "conformance/probe.h"

#include <math.h>
#include <string.h>

static const char *ratio_of(const double found[3], const double expected[3], char text[100])
{
    pl_describe_ratio(pl_vec_of(found), pl_vec_of(expected), text, 100);
    return text;
}

static void test_a_common_ratio_is_named(void **state)
{
    (void)state;
    static const double expected[3] = {1, -2, 0};
    char text[100];
    assert_contains(ratio_of((double[]){57.29578, -114.59156, 0}, expected, text),
                    "57.296 times what was expected: degrees in place of radians");
    assert_contains(ratio_of((double[]){-1, 2, 0}, expected, text), "-1 times");
    assert_contains(text, "the opposite sign");
    assert_contains(ratio_of((double[]){2, -4, 0}, expected, text), ": double");
    assert_contains(ratio_of((double[]){0.5, -1, 0}, expected, text), ": half");
    assert_contains(ratio_of((double[]){0, 0, 0}, expected, text), "nothing");
}

static void test_no_common_ratio_is_no_text(void **state)
{
    (void)state;
    char text[100];
    assert_string_equal(ratio_of((double[]){2, -2, 0}, (double[]){1, -2, 0}, text), "");
    assert_string_equal(ratio_of((double[]){1, 2, 3}, (double[]){0, 0, 0}, text), "");
    assert_string_equal(ratio_of((double[]){NAN, 2, 3}, (double[]){1, 2, 3}, text), "");
}

static void test_the_first_guess_that_fits_is_the_cause(void **state)
{
    (void)state;
    static const pl_guess guesses[] = {
        {{1, 2, 3}, "first"}, {{0, 0, 0}, "nothing"}, {{1, 2, 3}, "second"}};
    assert_string_equal(pl_guess_cause((pl_vec){1, 2.001, 3}, guesses, 3, "other"), "first");
    assert_string_equal(pl_guess_cause((pl_vec){0, 0, 0}, guesses, 3, "other"), "nothing");
    assert_string_equal(pl_guess_cause((pl_vec){1, 2.1, 3}, guesses, 3, "other"), "other");
    assert_string_equal(pl_guess_cause((pl_vec){NAN, 2, 3}, guesses, 3, "other"), "other");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_common_ratio_is_named),
        cmocka_unit_test(test_no_common_ratio_is_no_text),
        cmocka_unit_test(test_the_first_guess_that_fits_is_the_cause),
    };
    return cmocka_run_group_tests_name("mismatch", tests, NULL, NULL);
}
