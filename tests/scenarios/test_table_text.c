/* Tables that are folded to a width. */
#include "base/table.h"
#include "check.h"

#include <stdlib.h>
#include <string.h>

static char *written(const pl_table *table)
{
    pl_text_buffer out = {0};
    pl_table_write(table, PL_TABLE_TEXT, &out);
    assert_false(out.failed);
    return out.data;
}

static void check_text(const pl_table *table, const char *expected)
{
    char *text = written(table);
    assert_string_equal(text, expected);
    free(text);
}

static void check_width(const char *text, int width)
{
    int used = 0;
    for (; *text != '\0'; text += pl_code_point_length(text)) {
        used = *text == '\n' ? 0 : used + 1;
        assert_at_most(used, width);
    }
}

/* Adds `count` words, each of which stands in no other cell: "r3c2w0µ". */
static void add_words(pl_table *table, int row, int column, int count)
{
    char text[800] = "";
    for (int i = 0; i < count; ++i) {
        char word[64];
        snprintf(word, sizeof word, "%sr%dc%dw%dµ", i == 0 ? "" : " ", row, column, i);
        strcat(text, word);
    }
    pl_table_add(table, text);
}

static void test_every_word_is_there_at_any_width(void **state)
{
    (void)state;
    check_random random = {11};
    for (int trial = 0; trial < 300; ++trial) {
        pl_table table = {.indent = (int)check_uniform(&random, 0, 5),
                          .keys = (int)check_uniform(&random, 0, 3),
                          .line_width = (int)check_uniform(&random, 60, 200)};
        const int columns = (int)check_uniform(&random, 1, 12);
        int words[6][12];
        for (int k = 0; k < columns; ++k) {
            pl_table_column(&table, k % 3 == 1 ? PL_RIGHT : PL_LEFT, "heading of c%d", k);
        }
        for (int i = 0; i < 6 * columns; ++i) {
            const int k = i % columns, most = k % 3 == 1 ? 2 : 20;
            words[i / columns][k] = (int)check_uniform(&random, 0, most);
            add_words(&table, i / columns, k, words[i / columns][k]);
        }
        char *text = written(&table);
        check_width(text, table.line_width);
        for (int i = 0; i < 6 * columns; ++i) {
            for (int w = 0; w < words[i / columns][i % columns]; ++w) {
                char word[64];
                snprintf(word, sizeof word, "r%dc%dw%dµ", i / columns, i % columns, w);
                assert_contains(text, word);
            }
        }
        free(text);
        pl_table_free(&table);
    }
}

static void test_columns_of_any_script_align(void **state)
{
    (void)state;
    pl_table table = {0};
    pl_table_columns(&table, "scene|>error|verdict");
    static const char *const cells[] = {"tower",          "1", "ok",      "方块塔", "0.5", "中",
                                        "e\u0301t\u0301", "2", "a\u0301", "😀",      "12",  "ok"};
    for (size_t i = 0; i < sizeof cells / sizeof cells[0]; ++i) {
        pl_table_add(&table, cells[i]);
    }
    check_text(&table, "scene   error  verdict\n"
                       "tower       1  ok\n"
                       "方块塔    0.5  中\n"
                       "e\u0301t\u0301          2  a\u0301\n"
                       "😀         12  ok\n");
    pl_table_free(&table);
}

static void fill(pl_table *table)
{
    pl_table_columns(table, "engine|>CPU time, s|verdict");
    pl_table_add(table, "plumb");
    pl_table_add(table, "1.25");
    pl_table_add(table, "accurate");
    pl_table_add(table, "ode");
    pl_table_add(table, "12.5");
    pl_table_add(table, "inaccurate: sank by 3 mm in 10 s");
}

static void test_table_that_fits_is_not_folded(void **state)
{
    (void)state;
    pl_table table = {.indent = 2};
    fill(&table);
    char *free_text = written(&table);
    table.line_width = 55;
    check_text(&table, free_text);
    table.line_width = 54;
    char *folded = written(&table);
    assert_string_not_equal(folded, free_text);
    free(free_text);
    free(folded);
    pl_table_free(&table);
}

static void test_headings_and_texts_are_folded_first(void **state)
{
    (void)state;
    pl_table table = {.line_width = 40};
    fill(&table);
    check_text(&table, "engine       CPU  verdict\n"
                       "         time, s\n"
                       "plumb       1.25  accurate\n"
                       "ode         12.5  inaccurate: sank by 3\n"
                       "                  mm in 10 s\n");
    pl_table_free(&table);
}

static void test_columns_in_groups_repeat_their_key(void **state)
{
    (void)state;
    pl_table table = {.line_width = 26};
    fill(&table);
    check_text(&table, "engine  CPU time, s\n"
                       "plumb          1.25\n"
                       "ode            12.5\n"
                       "\n"
                       "engine  verdict\n"
                       "plumb   accurate\n"
                       "ode     inaccurate: sank\n"
                       "        by 3 mm in 10 s\n");
    pl_table_free(&table);
}

static void test_span_takes_the_rest_of_its_line(void **state)
{
    (void)state;
    pl_table table = {.line_width = 26};
    fill(&table);
    pl_table_add(&table, "dart");
    pl_table_add_span(&table, "crashed: segmentation fault");
    char *text = written(&table);
    check_width(text, 26);
    assert_contains(text, "dart    crashed:\n        segmentation fault\n");
    assert_int_equal(count_of(text, "crashed"), 1);
    free(text);
    table.line_width = 0;
    text = written(&table);
    assert_contains(text, "dart    crashed: segmentation fault\n");
    free(text);
    pl_table_free(&table);
}

static void test_colour_ends_with_its_line(void **state)
{
    (void)state;
    pl_table table = {.line_width = 12, .colour = true};
    pl_table_columns(&table, "what");
    pl_table_add(&table, "it sank, and then fell");
    pl_table_style(&table, "bad");
    check_text(&table,
               "\033[2mwhat\033[0m\n\033[31mit sank, and\033[0m\n\033[31mthen fell\033[0m\n");
    pl_table_free(&table);
}

/* Three keys that are too wide leave room for one more column. */
static void test_wide_keys_are_folded(void **state)
{
    (void)state;
    pl_table table = {.line_width = 40, .keys = 3};
    pl_table_columns(&table, "observable|engine A|engine B|distance");
    pl_table_add(&table, "penetration_max");
    pl_table_add(&table, "bullet:sequential");
    pl_table_add(&table, "plumb:accurate");
    pl_table_add(&table, "0.125");
    char *text = written(&table);
    check_width(text, 40);
    assert_contains(text, "0.125");
    assert_int_equal(count_of(text, "distance"), 1);
    free(text);
    pl_table_free(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_columns_of_any_script_align),
        cmocka_unit_test(test_every_word_is_there_at_any_width),
        cmocka_unit_test(test_table_that_fits_is_not_folded),
        cmocka_unit_test(test_headings_and_texts_are_folded_first),
        cmocka_unit_test(test_columns_in_groups_repeat_their_key),
        cmocka_unit_test(test_span_takes_the_rest_of_its_line),
        cmocka_unit_test(test_colour_ends_with_its_line),
        cmocka_unit_test(test_wide_keys_are_folded),
    };
    return cmocka_run_group_tests_name("table text", tests, NULL, NULL);
}
