/* The report's tables: the page's data, Markdown and the terminal. */
#include "base/number_format.h"
#include "report/page.h"

#include "check.h"
#include "report_rows.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Tables ---- */

static void test_every_case_and_engine_is_in_every_table(void **state)
{
    (void)state;
    static const char *const scenarios[] = {"alpha", "beta", "gamma"};
    static const char *const labels[] = {"plumb:fast", "ode:quick", "bullet:si"};
    json_t *results = json_array();
    for (int s = 0; s < 3; ++s) {
        for (int l = 0; l < 3; ++l) {
            set_metric(add_run(results, scenarios[s], labels[l], "ok"), "reference_error",
                       metric_value(1.11e-3 * (1 + s * 3 + l)));
        }
    }
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 100);
    const char *texts[] = {made.data, made.markdown, table};
    for (int t = 0; t < 3; ++t) {
        for (int i = 0; i < 3; ++i) {
            assert_contains(texts[t], scenarios[i]);
            assert_contains(texts[t], labels[i]);
        }
        for (int i = 0; i < 9; ++i) {
            char value[PL_QUANTITY_SIZE];
            pl_format_number(1.11e-3 * (1 + i), "", value);
            assert_contains(texts[t], value);
        }
    }
    free(table);
    free_report(&made);
}

static void test_missing_run_is_shown_as_not_run(void **state)
{
    (void)state;
    json_t *results = two_runs("creep", 1, 1);
    add_run(results, "alone", "ode:quick", "ok");
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 100);
    assert_contains(made.data, "\"cells\":[null,{");
    assert_contains(made.markdown, "| not run |");
    assert_contains(table, "not run");
    free(table);
    free_report(&made);
}

static void test_settings_of_every_engine_are_listed(void **state)
{
    (void)state;
    made_report made = make_report(two_runs("creep", 1, 1));
    assert_contains(made.data, "\"not verified: run plumb check-engine ode:p\","
                               "\"iterations = 2000000, erp = 0.2\"");
    assert_contains(made.data, "[\"dt\",\"0.01 s\",");
    assert_contains(made.markdown, "| ode:quick | 1.0 | not verified: run plumb check-engine "
                                   "ode:p | iterations = 2000000, erp = 0.2 |\n");
    free_report(&made);
}

static void test_missing_value_is_a_dash_with_its_reason(void **state)
{
    (void)state;
    made_report made = make_report(runs_of_every_kind());
    assert_contains(made.data, "\"settle_time\":[null,\"–\",\"moves to the end <&>\"]");
    free_report(&made);
}

static void test_failed_run_shows_reason_and_output(void **state)
{
    (void)state;
    made_report made = make_report(runs_of_every_kind());
    static const char *const outcomes[] = {"collapsed", "diverged", "nonfinite",
                                           "crashed",   "timeout",  "unsupported"};
    for (int i = 0; i < 6; ++i) {
        assert_contains(made.data, outcomes[i]);
        assert_contains(strstr(made.markdown, "## Failed runs"), outcomes[i]);
    }
    assert_contains(made.data, "\"output\":\"<script>alert");
    free_report(&made);
}

static void test_terminal_lines_fit_without_control_characters(void **state)
{
    (void)state;
    json_t *results = runs_of_every_kind();
    json_object_set_new(
        json_array_get(results, 1), "reason",
        json_string("\033[2J\007 \302\233 Grüße, Grüße, Grüße, Grüße, Grüße, Grüße"));
    static const int widths[] = {40, 60, 80, 120, 300};
    for (int w = 0; w < 5; ++w) {
        char *table = printed_table(results, false, widths[w]);
        int column = 0;
        for (const char *c = table; *c != '\0'; ++c) {
            unsigned char byte = (unsigned char)*c;
            bool c1 = byte == 0xc2 && (unsigned char)c[1] < 0xa0;
            assert_false((byte < 0x20 && byte != '\n') || byte == 0x7f || c1);
            column = byte == '\n' ? 0 : column + ((byte & 0xc0) != 0x80);
            assert_at_most(column, widths[w]);
        }
        free(table);
    }
    char *coloured = printed_table(results, true, 80);
    assert_contains(coloured, "\033[31m");
    assert_absent(coloured, "\033[2J");
    free(coloured);
    json_decref(results);
}

/* ---- Page and Markdown ---- */

/* Adds a page of the report to `page`. */
static void make_page(const made_report *made, pl_text_buffer *page)
{
    json_t *data = json_loads(made->data, 0, NULL);
    pl_page_open(page);
    pl_page_add(page, "data", data);
    pl_page_close(page);
    assert_false(page->failed);
    json_decref(data);
}

static void test_no_text_ends_the_data_element(void **state)
{
    (void)state;
    made_report made = make_report(runs_of_every_kind());
    pl_text_buffer page = {0}, empty = {0};
    make_page(&made, &page);
    pl_page_open(&empty);
    pl_page_close(&empty);
    assert_int_equal(count_of(page.data, "</script"), count_of(empty.data, "</script") + 1);
    assert_int_equal(count_of(page.data, "<script"), count_of(empty.data, "<script") + 1);
    assert_contains(page.data, "\\u003cscript>alert(\\\"x\\\")\\u003c/script>");
    assert_contains(page.data, "Grüße");
    pl_text_free(&page);
    pl_text_free(&empty);
    free_report(&made);
}

static void test_data_in_the_page_reads_back(void **state)
{
    (void)state;
    static const char open[] = "<script type=\"application/json\" id=\"data\">";
    made_report made = make_report(runs_of_every_kind());
    pl_text_buffer page = {0};
    make_page(&made, &page);
    const char *begin = strstr(page.data, open);
    assert_non_null(begin);
    begin += strlen(open);
    const size_t length = (size_t)(strstr(begin, "</script>") - begin);
    json_t *found = json_loadb(begin, length, 0, NULL), *expected = json_loads(made.data, 0, NULL);
    assert_non_null(found);
    assert_true(json_equal(found, expected));
    json_decref(found);
    json_decref(expected);
    pl_text_free(&page);
    free_report(&made);
}

static void test_page_forbids_all_requests_and_other_scripts(void **state)
{
    (void)state;
    pl_text_buffer page = {0};
    pl_page_open(&page);
    pl_page_close(&page);
    assert_contains(page.data, "default-src 'none'; script-src 'sha256-");
    assert_absent(page.data, "<link");
    assert_absent(page.data, "<iframe");
    assert_absent(page.data, " onload=");
    pl_text_free(&page);
}

static void test_page_data_defines_every_metric(void **state)
{
    (void)state;
    made_report made = make_report(json_array());
    const char *definitions = strstr(made.data, "\"metrics\":[");
    assert_non_null(definitions);
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        assert_contains(definitions, pl_metric_table[i].name);
    }
    free_report(&made);
}

/* Cells of a table line: unescaped '|' less one. */
static int markdown_cells(const char *line, size_t length)
{
    int bars = 0;
    for (size_t i = 0; i < length; ++i) {
        if (line[i] == '\\') {
            ++i;
        } else {
            bars += line[i] == '|';
        }
    }
    return bars - 1;
}

static void test_markdown_tables_are_rectangular_with_any_text(void **state)
{
    (void)state;
    made_report made = make_report(runs_of_every_kind());
    int columns = -1, tables = 0;
    for (const char *line = made.markdown; *line != '\0';) {
        size_t length = strcspn(line, "\n");
        assert_null(memchr(line, '\r', length));
        if (line[0] == '|') {
            int cells = markdown_cells(line, length);
            tables += columns < 0;
            if (columns >= 0) {
                assert_int_equal(cells, columns);
            }
            columns = cells;
        } else {
            columns = -1;
        }
        line += length + (line[length] == '\n');
    }
    assert_int_equal(tables, 6);
    assert_absent(made.markdown, "<script");
    free_report(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_case_and_engine_is_in_every_table),
        cmocka_unit_test(test_missing_run_is_shown_as_not_run),
        cmocka_unit_test(test_settings_of_every_engine_are_listed),
        cmocka_unit_test(test_missing_value_is_a_dash_with_its_reason),
        cmocka_unit_test(test_failed_run_shows_reason_and_output),
        cmocka_unit_test(test_terminal_lines_fit_without_control_characters),
        cmocka_unit_test(test_no_text_ends_the_data_element),
        cmocka_unit_test(test_data_in_the_page_reads_back),
        cmocka_unit_test(test_page_forbids_all_requests_and_other_scripts),
        cmocka_unit_test(test_page_data_defines_every_metric),
        cmocka_unit_test(test_markdown_tables_are_rectangular_with_any_text),
    };
    return cmocka_run_group_tests_name("report_pages", tests, NULL, NULL);
}
