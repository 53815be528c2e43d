/* Pages as Markdown and as text. */
#include "base/text_page.h"
#include "check.h"

static void fill(pl_text_page *page)
{
    pl_table table = {0}, empty = {0};
    pl_text_page_heading(page, 2, "Rows of %d", 2);
    pl_text_page_paragraph(page, "Words that are one after the other, %s.", "and so on and on");
    pl_text_page_item(page, "first");
    pl_text_page_item(page, "second, which is longer than the window of forty columns");
    pl_table_columns(&empty, "nothing");
    pl_text_page_table(page, &empty);
    pl_table_columns(&table, "engine|>time, s");
    pl_table_add(&table, "a|b");
    pl_table_number(&table, 0.25, 3);
    pl_text_page_table(page, &table);
}

static void check_page(int width, const char *expected)
{
    pl_text_buffer out = {0};
    pl_text_page page = {.out = &out, .width = width};
    fill(&page);
    assert_false(out.failed);
    assert_string_equal(out.data, expected);
    pl_text_free(&out);
}

static void test_text_is_folded_and_has_no_markup(void **state)
{
    (void)state;
    check_page(40, "Rows of 2\n\n"
                   "Words that are one after the other, and\nso on and on.\n\n"
                   "- first\n- second, which is longer than the\n  window of forty columns\n\n"
                   "engine  time, s\na|b        0.25\n");
}

static void test_markdown_has_headings_lists_and_tables(void **state)
{
    (void)state;
    check_page(0, "## Rows of 2\n\n"
                  "Words that are one after the other, and so on and on.\n\n"
                  "- first\n- second, which is longer than the window of forty columns\n\n"
                  "| engine | time, s |\n|--------|--------:|\n| a\\|b   |    0.25 |\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text_is_folded_and_has_no_markup),
        cmocka_unit_test(test_markdown_has_headings_lists_and_tables),
    };
    return cmocka_run_group_tests_name("text page", tests, NULL, NULL);
}
