/* Arithmetic expressions against the C library's functions and written answers; faults and their places. */
#include "base/expression.h"
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool evaluate(const char *text, double *value, pl_diagnostic *diagnostic)
{
    pl_named_number numbers[] = {{.name = "v", .value = 4}, {.name = "mu", .value = 0.5}};
    *diagnostic = (pl_diagnostic){.status = PL_OK};
    return pl_expression_value(text, numbers, 2, value, diagnostic);
}

static double value_of(const char *text)
{
    double value = (double)NAN;
    pl_diagnostic diagnostic;
    if (!evaluate(text, &value, &diagnostic)) {
        fail_msg("%s: %s", text, diagnostic.text);
    }
    return value;
}

static void test_operators_bind_as_in_c(void **state)
{
    (void)state;
    const double v = 4, mu = 0.5;
    assert_close(value_of("v*v/(2*mu*9.81)"), v * v / (2 * mu * 9.81), 0, 0);
    assert_close(value_of("1 - 2 - 3"), -4, 0, 0);
    assert_close(value_of("16/4/2"), 2, 0, 0);
    assert_close(value_of("1+2*3"), 7, 0, 0);
    assert_close(value_of("(1+2)*3"), 9, 0, 0);
    assert_close(value_of("-v*-mu"), 2, 0, 0);
    assert_close(value_of("--v"), 4, 0, 0);
    assert_close(value_of("2--1"), 3, 0, 0);
    assert_close(value_of(" 1.5e-3 "), 1.5e-3, 0, 0);
    assert_close(value_of("0.1"), 0.1, 0, 0);
    assert_close(value_of("sqrt(v)+pi"), 2 + 3.141592653589793, 0, 0);
}

static void test_functions_agree_with_the_c_library(void **state)
{
    (void)state;
    for (int i = -1000; i <= 1000; ++i) {
        char text[64];
        const double angle = 0.0123 * i;
        snprintf(text, sizeof text, "sin(%.17g)", angle);
        assert_close(value_of(text), sin(angle), 1e-15 * (1 + fabs(angle)), 0);
        snprintf(text, sizeof text, "cos(%.17g)", angle);
        assert_close(value_of(text), cos(angle), 1e-15 * (1 + fabs(angle)), 0);
        snprintf(text, sizeof text, "tan(%.17g)", angle);
        assert_close(value_of(text), tan(angle),
                     1e-15 * (1 + fabs(angle)) / (cos(angle) * cos(angle)), 1e-15);
        snprintf(text, sizeof text, "sqrt(%.17g)", fabs(angle));
        assert_close(value_of(text), sqrt(fabs(angle)), 0, 0);
    }
    assert_close(value_of("cos(pi/2)"), 0, 0, 0);
    assert_close(value_of("sin(-pi/2)"), -1, 0, 0);
}

static void test_faults_name_their_place(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } faults[] = {
        {"", "expected a number, a name, '-' or '(', found the end at character 1 of \"\""},
        {"2*", "found the end at character 3"},
        {"2*+3", "found '+' at character 3"},
        {"(1", "expected an operator or ')', found the end at character 3"},
        {"1)", "expected an operator or the end, found ')' at character 2"},
        {"2 mu", "expected an operator or the end, found 'm' at character 3"},
        {"mo+1",
         "expected a number or a parameter, found \"mo\" at character 1 of \"mo+1\"; did you "
         "mean \"mu\"?"},
        {"1/(v-4)", "expected a divisor other than 0, found 0 at character 2"},
        {"1e308*10", "expected a finite result, found none at character 6"},
        {"1e999", "expected a finite number"},
        {"sqrt(-1)", "expected a number of at least 0, found -1 at character 1"},
        {"sin(2e6)", "expected an angle from -1e6 to 1e6 rad"},
        {"tan(pi/2)", "expected a finite result"},
        {"sqrt 4", "expected '(', found '4' at character 6"},
        {"1.2.3", "expected a finite number"},
        {"0x10", "found 'x' at character 2"}};
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; ++i) {
        double value;
        pl_diagnostic diagnostic;
        assert_false(evaluate(faults[i].text, &value, &diagnostic));
        assert_int_equal(diagnostic.status, PL_BAD_INPUT);
        assert_contains(diagnostic.text, faults[i].message);
    }
}

static void test_nesting_is_limited(void **state)
{
    (void)state;
    char text[256];
    double value;
    pl_diagnostic diagnostic;
    snprintf(text, sizeof text, "%.*s1%.*s", 31, "(((((((((((((((((((((((((((((((((((((((((", 31,
             ")))))))))))))))))))))))))))))))))))))))))");
    assert_close(value_of(text), 1, 0, 0);
    memset(text, '-', 100);
    snprintf(text + 100, sizeof text - 100, "1");
    assert_false(evaluate(text, &value, &diagnostic));
    assert_contains(diagnostic.text, "at most 32 nested parts");
}

static void test_used_numbers_are_marked(void **state)
{
    (void)state;
    pl_named_number numbers[] = {{.name = "a", .value = 1}, {.name = "ab", .value = 2}};
    pl_diagnostic diagnostic = {.status = PL_OK};
    double value;
    assert_true(pl_expression_value("ab*ab", numbers, 2, &value, &diagnostic));
    assert_close(value, 4, 0, 0);
    assert_false(numbers[0].used);
    assert_true(numbers[1].used);
}

static void test_names_are_no_words_of_the_grammar(void **state)
{
    (void)state;
    static const char *const wrong[] = {"", "2v", "a-b", "pi", "sqrt", "sin", "cos", "tan", "a b"};
    assert_true(pl_expression_may_name("mu_2"));
    assert_true(pl_expression_may_name("_"));
    assert_true(pl_expression_may_name("pie"));
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        assert_false(pl_expression_may_name(wrong[i]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_operators_bind_as_in_c),
                                       cmocka_unit_test(test_functions_agree_with_the_c_library),
                                       cmocka_unit_test(test_faults_name_their_place),
                                       cmocka_unit_test(test_nesting_is_limited),
                                       cmocka_unit_test(test_used_numbers_are_marked),
                                       cmocka_unit_test(test_names_are_no_words_of_the_grammar)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
