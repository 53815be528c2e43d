/* The report's tables: HTML, Markdown and the terminal. */
#include "report/number_format.h"

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
    const char *texts[] = {made.html.data, made.markdown.data, table};
    for (int t = 0; t < 3; ++t) {
        for (int i = 0; i < 3; ++i) {
            assert_contains(texts[t], scenarios[i]);
            assert_contains(texts[t], labels[i]);
        }
        for (int i = 0; i < 9; ++i) {
            char value[PL_NUMBER_SIZE];
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
    assert_contains(made.html.data, ">not run</td>");
    assert_contains(made.markdown.data, "| not run |");
    assert_contains(table, "not run");
    free(table);
    free_report(&made);
}

static void test_settings_of_every_engine_are_listed(void **state)
{
    (void)state;
    made_report made = make_report(two_runs("creep", 1, 1));
    assert_contains(made.html.data, "<th>ode:quick</th><td>1.0</td>"
                                    "<td class=\"why\">not verified: run plumb check-engine "
                                    "ode:p</td>"
                                    "<td class=\"why\">iterations = 2000000, erp = 0.2</td>");
    assert_contains(made.html.data, "dt = 0.01 s · duration = 0.1 s");
    assert_contains(made.markdown.data, "| ode:quick | 1.0 | not verified: run plumb check-engine "
                                        "ode:p | iterations = 2000000, erp = 0.2 |\n");
    free_report(&made);
}

static void test_missing_value_is_a_dash_with_its_reason(void **state)
{
    (void)state;
    made_report made = make_report(runs_of_every_kind());
    assert_contains(made.html.data, "title=\"moves to the end &lt;&amp;&gt;\">–</td>");
    free_report(&made);
}

static void test_failed_run_shows_reason_and_output(void **state)
{
    (void)state;
    made_report made = make_report(runs_of_every_kind());
    static const char *const outcomes[] = {"collapsed", "diverged", "nonfinite",
                                           "crashed",   "timeout",  "unsupported"};
    const char *failures = strstr(made.html.data, "id=\"failures\"");
    assert_non_null(failures);
    for (int i = 0; i < 6; ++i) {
        assert_contains(failures, outcomes[i]);
    }
    assert_contains(failures, "<pre>&lt;script&gt;alert");
    free_report(&made);
}

/* Adds a run of another engine with a creep of 1e-3 and that outcome. */
static made_report report_with_third_run(json_t *results, const char *outcome)
{
    set_metric(add_run(results, "pair", "bullet:si", outcome), "creep", metric_value(1e-3));
    return make_report(results);
}

static void test_best_value_is_bold_among_good_runs_alone(void **state)
{
    (void)state;
    made_report made = report_with_third_run(two_runs("creep", 2e-3, 3e-3), "collapsed");
    assert_int_equal(count_of(made.html.data, "class=\"best\""), 1);
    assert_contains(made.html.data, "<b class=\"best\">0.00200 m/s</b>");
    free_report(&made);
}

static void test_values_equal_to_rounding_are_best_together(void **state)
{
    (void)state;
    made_report made = report_with_third_run(two_runs("creep", 2e-16, 1e-16), "ok");
    assert_int_equal(count_of(made.html.data, "class=\"best\""), 2);
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

/* ---- HTML and Markdown ---- */

/* Checks that every element is closed in order, attributes are quoted, and text has no bare '<' or
 * '&'. */
static void check_balance(const char *html)
{
    static const char *const empty[] = {"meta", "br", "!DOCTYPE", "path", "circle", "use"};
    enum { DEEPEST = 64 };
    char open[DEEPEST][32];
    int depth = 0;
    for (const char *c = html; *c != '\0'; ++c) {
        if (*c == '&' && (c[1] == ' ' || strcspn(c, ";") > 8)) {
            fail_msg("bare & at %.60s", c);
        }
        if (*c != '<') {
            continue;
        }
        bool closing = c[1] == '/';
        const char *name = c + 1 + closing;
        size_t length = strcspn(name, " />\n");
        char tag[32];
        assert_true(length > 0 && length < sizeof tag);
        snprintf(tag, sizeof tag, "%.*s", (int)length, name);
        char quote = '\0';
        for (c = name + length; *c != '\0' && (*c != '>' || quote != '\0'); ++c) {
            if (*c == '"') {
                quote = quote == '\0' ? '"' : '\0';
            }
            assert_true(*c != '<');
        }
        assert_int_equal(*c, '>');
        bool leaf = c[-1] == '/';
        for (size_t i = 0; i < sizeof empty / sizeof empty[0]; ++i) {
            leaf |= strcmp(tag, empty[i]) == 0;
        }
        if (closing) {
            if (depth == 0 || strcmp(open[depth - 1], tag) != 0) {
                fail_msg("</%s> closes <%s>", tag, depth == 0 ? "" : open[depth - 1]);
            }
            --depth;
        } else if (!leaf) {
            assert_true(depth < DEEPEST);
            snprintf(open[depth++], sizeof open[0], "%s", tag);
            if (strcmp(tag, "style") == 0) {
                c = strstr(c, "</style>") - 1;
            }
        }
    }
    assert_int_equal(depth, 0);
}

static void test_html_is_balanced_and_holds_no_script(void **state)
{
    (void)state;
    made_report made = make_report(runs_of_every_kind());
    check_balance(made.html.data);
    assert_absent(made.html.data, "<script");
    assert_absent(made.html.data, "onload=");
    assert_contains(made.html.data, "&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt;");
    assert_contains(made.html.data, "Grüße");
    free_report(&made);
}

static void test_html_makes_no_request(void **state)
{
    (void)state;
    static const char *const requests[] = {"http:", "src=",    "url(",    "@import", "<link",
                                           "<img",  "<iframe", "<object", "<base",   "http-equiv"};
    json_t *results = two_runs("creep", 1, 2);
    int count = 0;
    const pl_scenario *scenario = pl_scenarios(&count)[0];
    assert_true(count > 0);
    add_run(results, scenario->name, "plumb:fast", "ok");
    made_report made = make_report(results);
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; ++i) {
        assert_absent(made.html.data, requests[i]);
    }
    for (const char *at = strstr(made.html.data, "href="); at != NULL;
         at = strstr(at + 1, "href=")) {
        assert_int_equal(at[6], '#');
    }
    free_report(&made);
}

static void test_html_defines_every_metric(void **state)
{
    (void)state;
    made_report made = make_report(json_array());
    check_balance(made.html.data);
    const char *definitions = strstr(made.html.data, "id=\"metrics\"");
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
    for (const char *line = made.markdown.data; *line != '\0';) {
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
    assert_absent(made.markdown.data, "<script");
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
        cmocka_unit_test(test_best_value_is_bold_among_good_runs_alone),
        cmocka_unit_test(test_values_equal_to_rounding_are_best_together),
        cmocka_unit_test(test_terminal_lines_fit_without_control_characters),
        cmocka_unit_test(test_html_is_balanced_and_holds_no_script),
        cmocka_unit_test(test_html_makes_no_request),
        cmocka_unit_test(test_html_defines_every_metric),
        cmocka_unit_test(test_markdown_tables_are_rectangular_with_any_text),
    };
    return cmocka_run_group_tests_name("report_pages", tests, NULL, NULL);
}
