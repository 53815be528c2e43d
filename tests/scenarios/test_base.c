/* The shared parts of scenarios/base: tables, growable arrays, hashes and order statistics. */
#include "base/array.h"
#include "base/hash.h"
#include "base/statistics.h"
#include "base/table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static void fill(pl_table *table)
{
    pl_table_columns(table, "engine|>error, m");
    pl_table_column(table, PL_LEFT, "to %g", 0.5);
    pl_table_add(table, "ode|é");
    pl_table_number(table, 0.125, 3);
    pl_table_add(table, "<ok>");
    pl_table_add(table, "b,c");
    pl_table_number(table, (double)NAN, 3);
    pl_table_add_markup(table, "<b>no</b>");
    pl_table_style(table, "bad");
    pl_table_add(table, "none");
    pl_table_add_span(table, "not run");
}

static void check_format(pl_table *table, pl_table_format format, const char *expected)
{
    pl_text_buffer out = {0};
    pl_table_write(table, format, &out);
    assert_false(out.failed);
    assert_string_equal(out.data == NULL ? "" : out.data, expected);
    pl_text_free(&out);
}

static void test_table_as_aligned_text(void **state)
{
    (void)state;
    pl_table table = {.indent = 1};
    fill(&table);
    assert_int_equal(pl_table_rows(&table), 3);
    check_format(&table, PL_TABLE_TEXT,
                 " engine  error, m  to 0.5\n ode|é      0.125  <ok>\n"
                 " b,c            -  <b>no</b>\n none    not run\n");
    table.first = 1;
    table.last = 2;
    table.colour = true;
    check_format(&table, PL_TABLE_TEXT,
                 "\033[2m engine  error, m  to 0.5\033[0m\n"
                 " b,c            -  \033[31m<b>no</b>\033[0m\n");
    pl_table_free(&table);
}

static void test_table_as_markdown(void **state)
{
    (void)state;
    pl_table table = {.last = 2};
    fill(&table);
    check_format(&table, PL_TABLE_MARKDOWN,
                 "| engine | error, m | to 0.5 |\n|---|---:|---|\n"
                 "| ode\\|é | 0.125 | &lt;ok&gt; |\n| b,c | - | <b>no</b> |\n");
    pl_table_free(&table);
}

static void test_table_as_csv(void **state)
{
    (void)state;
    pl_table table = {0};
    fill(&table);
    check_format(&table, PL_TABLE_CSV,
                 "engine,\"error, m\",to 0.5\r\node|é,0.125,<ok>\r\n\"b,c\",-,<b>no</b>\r\n"
                 "none,not run,\r\n");
    pl_table_free(&table);
}

static void test_empty_table_is_left_out(void **state)
{
    (void)state;
    pl_table table = {0};
    pl_table_columns(&table, "a|b");
    check_format(&table, PL_TABLE_TEXT, "");
    check_format(&table, PL_TABLE_MARKDOWN, "");
    pl_table_free(&table);
}

static void test_array_grows_and_keeps_items(void **state)
{
    (void)state;
    int *items = NULL, count = 0, capacity = 0;
    for (int i = 0; i < 1000; ++i) {
        assert_int_equal(pl_array_push(&items, &count, &i, sizeof i, NULL), PL_OK);
    }
    assert_int_equal(count, 1000);
    for (int i = 0; i < count; ++i) {
        assert_int_equal(items[i], i);
    }
    free(items);
    items = NULL;
    assert_int_equal(pl_array_reserve(&items, &capacity, 100, sizeof *items, NULL), PL_OK);
    assert_int_equal(capacity, 100);
    assert_int_equal(pl_array_reserve(&items, &capacity, 101, sizeof *items, NULL), PL_OK);
    assert_int_equal(capacity, 200);
    free(items);
}

static void test_hash_is_fnv1a(void **state)
{
    (void)state;
    char text[PL_HASH_TEXT_SIZE];
    assert_string_equal(pl_hash_hex(PL_HASH_START, text), "cbf29ce484222325");
    assert_string_equal(pl_hash_hex(pl_hash_text(PL_HASH_START, "foobar"), text),
                        "85944171f73967e8");
}

static void test_median_and_quantiles(void **state)
{
    (void)state;
    double values[] = {4, 1, 3, 2};
    assert_true(pl_median(values, 4) == 2.5);
    assert_true(values[0] == 1 && values[3] == 4);
    assert_true(pl_quantile(values, 4, 0) == 1 && pl_quantile(values, 4, 1) == 4);
    assert_true(pl_quantile(values, 4, 0.5) == 2.5);
    assert_true(isnan(pl_median(values, 0)) && isnan(pl_quantile(values, 0, 0.5)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table_as_aligned_text),
        cmocka_unit_test(test_table_as_markdown),
        cmocka_unit_test(test_table_as_csv),
        cmocka_unit_test(test_empty_table_is_left_out),
        cmocka_unit_test(test_array_grows_and_keeps_items),
        cmocka_unit_test(test_hash_is_fnv1a),
        cmocka_unit_test(test_median_and_quantiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
