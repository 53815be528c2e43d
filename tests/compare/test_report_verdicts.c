/* The verdicts in reports: their counts, the order of the engines, their words and their colours. */
#include "base/heap.h"
#include "check.h"
#include "report_rows.h"

#include <stdlib.h>
#include <string.h>

static json_t *add_judged(json_t *results, const char *scenario, const char *label,
                          const char *verdict)
{
    json_t *row = add_run(results, scenario, label, "ok");
    set_metric(row, "reference_error", metric_value(0.6));
    set_verdict(row, verdict, "");
    return row;
}

static void add_three(json_t *results, const char *label, const char *a, const char *b,
                      const char *c)
{
    add_judged(results, "a", label, a);
    add_judged(results, "b", label, b);
    add_judged(results, "c", label, c);
}

static void test_engines_are_ordered_by_accuracy_then_failures(void **state)
{
    (void)state;
    static const char *const expected[] = {"z:all", "w:two",  "y:no-failure",
                                           "x:one", "a:none", "plumb:none"};
    json_t *results = json_array();
    add_three(results, "plumb:none", "failed", "failed", "failed");
    add_three(results, "a:none", "failed", "failed", "failed");
    add_three(results, "x:one", "failed", "accurate", "inaccurate");
    add_three(results, "y:no-failure", "accurate", "inaccurate", "inaccurate");
    add_three(results, "w:two", "accurate", "accurate", "failed");
    add_three(results, "z:all", "accurate", "accurate", "accurate");
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 100);
    for (int i = 0; i < 6; ++i) {
        char *line = pl_heap_format("| %s |%s", expected[i], i < 5 ? " " : "");
        char *next = i < 5 ? pl_heap_format("| %s |", expected[i + 1]) : pl_heap_copy("## Where");
        assert_before(made.markdown, line, next);
        free(line);
        free(next);
    }
    assert_contains(table, "x:one                1           1       1\n");
    assert_contains(made.markdown, "| x:one | 1 | 1 | 1 |\n");
    assert_before(made.markdown, "## Verdicts", "## Where plumb loses");
    free(table);
    free_report(&made);
}

static void test_runs_without_a_verdict_are_counted_apart(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_three(results, "x:p", "accurate", NULL, NULL);
    add_judged(results, "a", "y:p", "accurate");
    json_t *row = add_run(results, "b", "y:p", "unsupported");
    set_verdict(row, NULL, "unsupported");
    json_object_set_new(row, "reason", json_string("it has no hulls"));
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 120);
    assert_contains(
        made.markdown,
        "| engine | accurate | inaccurate | failed | unsupported | not judged | not run "
        "|\n");
    assert_contains(made.markdown, "| x:p | 1 | 0 | 0 | 0 | 2 | 0 |\n");
    assert_contains(made.markdown, "| y:p | 1 | 0 | 0 | 1 | 0 | 1 |\n");
    assert_contains(table, " not judged\n");
    assert_contains(table, " unsupported: it has no hulls\n");
    free(table);
    free_report(&made);
}

/* The outcome alone tells that such a run failed, and nothing tells that it is accurate. */
static void test_results_without_the_keys_are_read(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_run(results, "a", "x:p", "ok");
    json_object_set_new(add_run(results, "b", "x:p", "collapsed"), "reason",
                        json_string("body 3 fell"));
    add_run(results, "c", "x:p", "unsupported");
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 120);
    assert_contains(made.markdown, "| x:p | 0 | 0 | 1 | 1 | 1 |\n");
    assert_contains(table, " failed: collapsed: body 3 fell\n");
    free(table);
    free_report(&made);
}

static void test_repeats_count_once_by_the_worst(void **state)
{
    (void)state;
    static const char *const verdicts[] = {"accurate", "inaccurate", "accurate"};
    json_t *results = json_array();
    for (int i = 0; i < 3; ++i) {
        json_object_set_new(add_judged(results, "a", "x:p", verdicts[i]), "repeat",
                            json_integer(i));
    }
    add_judged(results, "b", "x:p", "failed");
    made_report made = make_report(results);
    assert_contains(made.markdown, "| x:p | 0 | 1 | 1 |\n");
    free_report(&made);
}

static void test_colours_follow_the_verdict(void **state)
{
    (void)state;
    static const struct {
        const char *verdict, *cell, *escape;
    } rows[] = {{"accurate", "\"style\":\"ok\"", "\033[32maccurate"},
                {"inaccurate", "\"style\":\"poor\"", "\033[33minaccurate"},
                {"failed", "\"style\":\"bad\"", "\033[31mfailed"}};
    for (int i = 0; i < 3; ++i) {
        json_t *results = json_array();
        add_judged(results, "a", "x:p", rows[i].verdict);
        made_report made = make_report(results);
        char *table = printed_table(made.results, true, 100);
        for (int k = 0; k < 3; ++k) {
            assert_int_equal(count_of(made.data, rows[k].cell) > 0, i == k);
            assert_int_equal(count_of(table, rows[k].escape) > 0, i == k);
        }
        free(table);
        free_report(&made);
    }
}

static void test_reason_of_the_verdict_is_shown(void **state)
{
    (void)state;
    json_t *results = json_array();
    set_verdict(add_judged(results, "a", "x:p", "inaccurate"), "inaccurate",
                "stands, but leans: drift is 0.6 m");
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 100);
    assert_contains(table, " inaccurate: stands, but leans: drift is 0.6 m\n");
    assert_contains(made.data, "\"why\":\"stands, but leans: drift is 0.6 m\"");
    free(table);
    free_report(&made);
}

static void test_bound_stands_next_to_the_primary_error(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add_judged(results, "a", "x:p", "inaccurate");
    json_object_set_new(row, "acceptance", json_real(0.05));
    add_judged(results, "b", "x:p", NULL);
    made_report made = make_report(results);
    assert_contains(made.data, "\"primary_error\":\"drift\"");
    assert_contains(made.data, "\"bound_text\":\"0.05 m\",\"bound\":0.05");
    assert_contains(made.markdown, "| a (drift, at most 0.05 m) |");
    assert_contains(made.markdown, "| b (drift) |");
    char *table = printed_table(made.results, false, 100);
    assert_contains(table, "a; error = drift, accurate up to 0.05 m\n");
    assert_contains(table, "b; error = drift\n");
    free(table);
    free_report(&made);
}

/* Of a single case the table has everything; in a narrow line the columns are in two groups. */
static void test_terminal_counts_several_cases_at_any_width(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_judged(results, "a", "x:p", "accurate");
    char *table = printed_table(results, false, 100);
    assert_absent(table, "Verdicts\n");
    free(table);
    add_judged(results, "b", "x:p", "failed");
    table = printed_table(results, false, 40);
    assert_contains(table, "Verdicts\n");
    assert_contains(table, "x:p            1           0       1\n");
    free(table);
    add_judged(results, "c", "x:p", NULL);
    table = printed_table(results, false, 40);
    assert_contains(
        table,
        "  engine  accurate  inaccurate  failed\n  x:p            1           0       1\n\n");
    assert_contains(table, "  engine  not judged\n  x:p              1\n");
    free(table);
    json_decref(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_engines_are_ordered_by_accuracy_then_failures),
        cmocka_unit_test(test_runs_without_a_verdict_are_counted_apart),
        cmocka_unit_test(test_results_without_the_keys_are_read),
        cmocka_unit_test(test_repeats_count_once_by_the_worst),
        cmocka_unit_test(test_colours_follow_the_verdict),
        cmocka_unit_test(test_reason_of_the_verdict_is_shown),
        cmocka_unit_test(test_bound_stands_next_to_the_primary_error),
        cmocka_unit_test(test_terminal_counts_several_cases_at_any_width),
    };
    return cmocka_run_group_tests_name("report_verdicts", tests, NULL, NULL);
}
