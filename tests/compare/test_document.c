/* One document, written as text, Markdown and CSV. */
#include "base/document.h"
#include "check.h"

#include <stdlib.h>
#include <string.h>

static void make(pl_document *document)
{
    pl_table table = {0};
    pl_table_columns(&table, "engine|settings|>error, m");
    table.keys = 1;
    pl_table_add(&table, "one");
    pl_table_add(&table, "erp=0.2,iterations=50");
    pl_table_number(&table, 0.5, 3);
    pl_table_add(&table, "two");
    pl_table_add(&table, "a \"b\" | c");
    pl_table_number(&table, 0.25, 3);
    pl_document_heading(document, "Tower, %d cubes", 3);
    pl_document_paragraph(document, "Both stand.");
    pl_document_item(document, "first");
    pl_document_item(document, "second");
    pl_document_table(document, "Errors", &table);
    assert_int_equal(table.column_count, 0);
}

static void check(char *text, const char *expected)
{
    assert_string_equal(text, expected);
    free(text);
}

static void test_text_has_aligned_columns(void **state)
{
    (void)state;
    pl_document document = {.title = "Report"};
    make(&document);
    check(pl_document_text(&document, 80),
          "Report\n\nTower, 3 cubes\n\nBoth stand.\n\n- first\n- second\n\n"
          "engine  settings               error, m\n"
          "one     erp=0.2,iterations=50       0.5\n"
          "two     a \"b\" | c                  0.25\n");
    pl_document_free(&document);
}

static void test_folded_table_keeps_keys_and_words(void **state)
{
    (void)state;
    pl_document document = {.title = "Report"};
    make(&document);
    char *text = pl_document_text(&document, 32);
    assert_non_null(strstr(text, "erp=0.2,iterations=50"));
    const char *first = strstr(text, "\none ");
    assert_non_null(first);
    assert_non_null(strstr(first + 1, "\none "));
    free(text);
    pl_document_free(&document);
}

static void test_markdown_escapes_what_would_be_markup(void **state)
{
    (void)state;
    pl_document document = {.title = "Report"};
    make(&document);
    char *text = pl_document_markdown(&document);
    assert_non_null(strstr(text, "# Report\n\n## Tower, 3 cubes\n\nBoth stand."));
    assert_non_null(strstr(text, "a \"b\" \\| c"));
    free(text);
    pl_document_free(&document);
}

static void test_csv_quotes_and_names_its_tables(void **state)
{
    (void)state;
    pl_document document = {.title = "Report"};
    make(&document);
    check(pl_document_csv(&document),
          "\"Tower, 3 cubes\"\r\nErrors\r\nengine,settings,\"error, m\"\r\n"
          "one,\"erp=0.2,iterations=50\",0.5\r\n"
          "two,\"a \"\"b\"\" | c\",0.25\r\n");
    pl_document_free(&document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text_has_aligned_columns),
        cmocka_unit_test(test_folded_table_keeps_keys_and_words),
        cmocka_unit_test(test_markdown_escapes_what_would_be_markup),
        cmocka_unit_test(test_csv_quotes_and_names_its_tables),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
