/* Trees of JSON are written as jansson writes them, byte for byte. */
#include "base/json_write.h"
#include "base/number.h"
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A whole number from 0 to below `count`. */
static int pick(check_random *random, int count)
{
    return (int)check_uniform(random, 0, count);
}

/* Any finite number: of any bits, of a common size, a short decimal, or next to a power of ten. */
static double random_number(check_random *random)
{
    const double any = check_uniform(random, -1, 1);
    double number;
    switch (pick(random, 5)) {
    case 0:
        do {
            const uint64_t bits = (uint64_t)check_uniform(random, 0, 0x1p32) << 32 |
                                  (uint64_t)check_uniform(random, 0, 0x1p32);
            memcpy(&number, &bits, sizeof number);
        } while (!isfinite(number));
        return number;
    case 1:
        return ldexp(any, pick(random, 80) - 30);
    case 2:
        return round(any * 1000) / 8;
    case 3:
        return round(any * 1e6) / 1e5;
    default:
        return nextafter(pow(10, pick(random, 24) - 6), any > 0 ? 0 : INFINITY);
    }
}

static void test_numbers_have_printf_s_digits(void **state)
{
    (void)state;
    check_random random = {3};
    char text[PL_NUMBER_SIZE], expected[64];
    for (int i = 0; i < 300000; ++i) {
        const double number = random_number(&random);
        snprintf(expected, sizeof expected, "%.17g", number);
        assert_string_equal(pl_number_digits(number, text), expected);
    }
}

static json_t *random_tree(check_random *random, int depth)
{
    static const char *const texts[] = {
        "",   "plain", "a\"b\\c/d", "\b\f\n\r\t\v\x01\x1f", "\x7f tail", "\xc3\xa9\xe2\x82\xac",
        "\n", "z"};
    json_t *made;
    switch (pick(random, depth > 0 ? 9 : 7)) {
    case 0:
        return json_null();
    case 1:
        return json_boolean(pick(random, 2));
    case 2:
        return json_integer((json_int_t)check_uniform(random, -1e15, 1e15));
    case 3:
        return json_string(texts[pick(random, 8)]);
    case 7:
        made = json_object();
        for (int i = pick(random, 5); i > 0; --i) {
            json_object_set_new(made, texts[pick(random, 8)], random_tree(random, depth - 1));
        }
        return made;
    case 8:
        made = json_array();
        for (int i = pick(random, 5); i > 0; --i) {
            json_array_append_new(made, random_tree(random, depth - 1));
        }
        return made;
    default:
        return json_real(random_number(random));
    }
}

static void check_layout(const json_t *tree, pl_json_layout layout, size_t flags)
{
    pl_text_buffer text = {0};
    char *expected = json_dumps(tree, flags | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
    assert_non_null(expected);
    pl_text_add_json_tree(&text, tree, layout);
    assert_false(text.failed);
    assert_string_equal(text.data, expected);
    pl_text_free(&text);
    free(expected);
}

static void test_trees_are_written_as_jansson_does(void **state)
{
    (void)state;
    check_random random = {5};
    for (int i = 0; i < 20000; ++i) {
        json_t *tree = random_tree(&random, 4);
        check_layout(tree, PL_JSON_COMPACT, JSON_COMPACT | JSON_ENCODE_ANY);
        check_layout(tree, PL_JSON_INDENTED, JSON_INDENT(1) | JSON_ENCODE_ANY);
        json_decref(tree);
    }
}

static void test_no_tree_is_a_failure(void **state)
{
    (void)state;
    pl_text_buffer text = {0};
    pl_text_add_json_tree(&text, NULL, PL_JSON_COMPACT);
    assert_true(text.failed);
    pl_text_free(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_have_printf_s_digits),
        cmocka_unit_test(test_trees_are_written_as_jansson_does),
        cmocka_unit_test(test_no_tree_is_a_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
