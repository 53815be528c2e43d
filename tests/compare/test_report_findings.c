/* Where the report says that other engines err, and why; and how it parts stepping from contact. */
#include "check.h"
#include "report_rows.h"

#include "plumb/scenario.h"
#include "referee/metrics/metrics.h"

#include <stdlib.h>
#include <string.h>

/* A run with a primary error and its value. */
static json_t *add_error(json_t *results, const char *scenario, const char *label,
                         const char *outcome, const char *primary, double error)
{
    json_t *row = add_run(results, scenario, label, outcome);
    json_object_set_new(row, "primary_error", json_string(primary));
    json_object_set_new(row, "profile", json_string(strchr(label, ':') + 1));
    set_metric(row, "reference_error",
               json_pack("{s:f, s:s}", "value", error, "unit",
                         strcmp(primary, "rest_position_error") == 0 ? "m" : "1"));
    return row;
}

static void test_a_relative_error_above_one_percent_is_a_finding(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "a", "ode:quick", "ok", "value_error", 0.0101);
    add_error(results, "b", "ode:quick", "ok", "value_error", 0.0099);
    add_error(results, "c", "ode:quick", "ok", "travel_error", 0.5);
    add_error(results, "d", "ode:quick", "ok", "rest_position_error", 0.5);
    made_report made = make_report(results);
    assert_int_equal(made.findings.runs, 4);
    assert_int_equal(made.findings.count, 2);
    assert_string_equal(made.findings.items[0].block->scenario, "a");
    assert_string_equal(made.findings.items[1].block->scenario, "c");
    assert_contains(made.html.data, "1.01 % (value_error)");
    assert_contains(made.html.data, "50 % (travel_error)");
    free_report(&made);
}

static void test_our_own_runs_are_no_findings(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "a", "plumb:fast", "ok", "value_error", 0.5);
    add_error(results, "b", "plumb:fast", "collapsed", "rest_position_error", 0.5);
    made_report made = make_report(results);
    assert_int_equal(made.findings.count, 0);
    assert_absent(made.html.data, "id=\"findings\"");
    assert_absent(made.markdown.data, "## Findings");
    free_report(&made);
}

static void test_a_failure_is_a_finding_where_there_is_a_reference(void **state)
{
    (void)state;
    static const char *const failures[] = {"collapsed", "diverged", "nonfinite", "crashed",
                                           "timeout"};
    for (size_t i = 0; i < sizeof failures / sizeof failures[0]; i++) {
        json_t *results = json_array();
        add_error(results, "a", "ode:quick", failures[i], "rest_position_error", 0.25);
        made_report made = make_report(results);
        assert_int_equal(made.findings.count, 1);
        assert_contains(made.markdown.data, failures[i]);
        assert_contains(made.markdown.data, "0.250 m");
        free_report(&made);
    }
    static const char *const others[] = {"ok", "unsupported"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        json_t *results = json_array();
        add_error(results, "a", "ode:quick", others[i], "rest_position_error", 0.25);
        made_report made = make_report(results);
        assert_int_equal(made.findings.count, 0);
        free_report(&made);
    }
    json_t *results = json_array();
    json_t *row = add_run(results, "a", "ode:quick", "collapsed");
    json_object_set_new(row, "primary_error", json_string(""));
    made_report made = make_report(results);
    assert_int_equal(made.findings.count, 0);
    free_report(&made);
}

static void test_an_error_without_a_value_is_a_finding(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add_error(results, "a", "ode:quick", "ok", "value_error", 0);
    set_metric(row, "reference_error",
               json_pack("{s:n, s:s}", "value", "reason", "no whole period"));
    made_report made = make_report(results);
    assert_int_equal(made.findings.count, 1);
    assert_contains(made.html.data, "no value (value_error)");
    free_report(&made);
}

static void assert_contains_html(const char *page, const char *text)
{
    pl_text_buffer out = {0};
    pl_text_add_html(&out, text);
    assert_contains(page, out.data);
    pl_text_free(&out);
}

static void test_a_known_cause_is_told_with_what_was_varied(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "torque-free", "ode:quick", "ok", "value_error", 0.74);
    add_error(results, "arch", "ode:dantzig", "crashed", "rest_position_error", 1);
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 4000);
    for (int i = 0; i < made.findings.count; i++) {
        const pl_cause *cause = made.findings.items[i].cause;
        assert_non_null(cause);
        assert_contains_html(made.html.data, cause->text);
        assert_contains_html(made.html.data, cause->evidence);
        assert_contains(table, cause->text);
    }
    assert_contains(made.html.data, "of 2 the cause is known");
    assert_contains(made.markdown.data, "gyroscopic");
    free(table);
    free_report(&made);
}

static void test_an_unknown_cause_is_said_to_be_unknown(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "no such scene", "ode:quick", "ok", "value_error", 0.5);
    add_error(results, "overhang", "ode:quick", "collapsed", "rest_position_error", 1);
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 4000);
    assert_int_equal(made.findings.count, 2);
    assert_contains(made.html.data, "of 0 the cause is known");
    assert_contains(made.html.data, "<td class=\"why\">cause not known</td>");
    assert_contains(made.markdown.data, "| cause not known ");
    assert_contains(table, "cause not known");
    free(table);
    free_report(&made);
}

/* A run that was cut off or crashed says nothing of the cause of an error. */
static void test_a_cause_is_that_of_its_profile_and_outcome(void **state)
{
    (void)state;
    assert_non_null(pl_cause_find("ode", "quick", "tower", "collapsed"));
    assert_null(pl_cause_find("ode", "quick", "tower", "timeout"));
    assert_null(pl_cause_find("ode", "quick", "tower", "crashed"));
    assert_non_null(pl_cause_find("ode", "dantzig", "multi-tower", "timeout"));
    assert_non_null(pl_cause_find("bullet", "nncg", "pile", "diverged"));
    assert_null(pl_cause_find("bullet", "si", "pile", "diverged"));
    assert_null(pl_cause_find("bullet", "nncg", "pile", "collapsed"));
    assert_null(pl_cause_find("bullet", "nncg", "pil", "diverged"));
    assert_null(pl_cause_find("bullet", "nncg", "", "diverged"));
}

static void test_every_cause_can_be_reached_and_is_of_a_scenario_that_exists(void **state)
{
    (void)state;
    int count = 0;
    const pl_cause *causes = pl_causes(&count);
    assert_true(count > 0);
    for (int i = 0; i < count; i++) {
        const pl_cause *cause = &causes[i];
        char names[256];
        assert_true(strlen(cause->scenarios) < sizeof names);
        strcpy(names, cause->scenarios);
        assert_true(cause->evidence[0] != '\0');
        bool reached = false;
        for (char *name = strtok(names, " "); name != NULL; name = strtok(NULL, " ")) {
            if (pl_scenario_find(name, NULL) == NULL)
                fail_msg("cause %d: no scenario %s", i, name);
            reached |= pl_cause_find(cause->engine, cause->profile == NULL ? "" : cause->profile,
                                     name, cause->outcome == NULL ? "ok" : cause->outcome) == cause;
        }
        if (!reached)
            fail_msg("cause %d of %s, %s: others come first", i, cause->engine, cause->scenarios);
    }
}

/* Only what is true of the engines that were run. */
static void test_innocence_of_the_adapter_is_told_for_the_engines_there(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "a", "bullet:si", "ok", "value_error", 0.5);
    made_report made = make_report(results);
    static const char *const facts[] = {"masses", "inertias", "gravity", "1e-12", "callbacks"};
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; i++)
        assert_contains(made.findings.innocence.data, facts[i]);
    assert_absent(made.findings.innocence.data, "ODE keeps no friction");
    assert_contains(made.html.data, "It is not the adapter");
    assert_contains(made.markdown.data, "It is not the adapter");
    free_report(&made);
}

static void test_texts_of_results_are_escaped(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, hostile_text, "ode:quick", "ok", "value_error", 0.5);
    made_report made = make_report(results);
    assert_int_equal(made.findings.count, 1);
    assert_absent(made.html.data, "<script>");
    free_report(&made);
}

static void set_text(json_t *row, const char *metric, const char *text)
{
    set_metric(row, metric, json_pack("{s:s, s:s}", "value", text, "unit", "rule"));
}

static void test_stepping_and_contact_are_told_apart_with_the_rule(void **state)
{
    (void)state;
    static const char second[] = "second order, exact for constant force";
    json_t *results = json_array();
    json_t *ours = add_error(results, "a", "plumb:fast", "ok", "value_error", 2e-15);
    json_t *theirs = add_error(results, "a", "ode:quick", "ok", "value_error", 0.0055);
    set_metric(ours, "discrete_error", metric_value(1e-15));
    set_text(ours, "integrator", second);
    set_metric(theirs, "discrete_error", metric_value(3e-14));
    set_text(theirs, "integrator", "semi-implicit Euler");
    json_t *untold = add_error(results, "b", "ode:quick", "ok", "travel_error", 0.002);
    set_metric(untold, "discrete_error", metric_value(0.001));
    add_error(results, "c", "ode:quick", "ok", "value_error", 0.003);
    made_report made = make_report(results);
    assert_contains(made.html.data, "<td>second order, exact for constant force</td>"
                                    "<td class=\"n\">2.00e-15</td><td class=\"n\">1.00e-15</td>");
    assert_contains(made.html.data, "<td>semi-implicit Euler</td>"
                                    "<td class=\"n\">0.00550</td><td class=\"n\">3.00e-14</td>");
    assert_contains(made.html.data, "<td>not told</td>");
    assert_contains(made.markdown.data, "| semi-implicit Euler | 0.00550 | 3.00e-14 |");
    assert_absent(made.html.data, "<tr><th>c</th>");
    free_report(&made);
}

static void test_without_both_errors_there_is_no_such_section(void **state)
{
    (void)state;
    made_report made = make_report(duel("drift", 1e-3, 2e-3));
    assert_absent(made.html.data, "id=\"stepping\"");
    assert_absent(made.markdown.data, "Time stepping");
    free_report(&made);
}

static void test_findings_come_after_losses(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "a", "ode:quick", "ok", "value_error", 0.5);
    made_report made = make_report(results);
    assert_before(made.html.data, "Where plumb loses", "id=\"findings\"");
    assert_before(made.markdown.data, "## Where plumb loses", "## Findings");
    char *table = printed_table(made.results, false, 100);
    assert_before(table, "Where plumb loses", "Findings\n");
    free(table);
    free_report(&made);
}

static void test_table_keeps_to_the_width(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "torque-free", "ode:quick", "ok", "value_error", 0.74);
    made_report made = make_report(results);
    for (int width = 40; width <= 120; width += 20) {
        char *table = printed_table(made.results, false, width);
        for (const char *line = table; *line != '\0';) {
            size_t length = strcspn(line, "\n");
            int points = 0;
            for (size_t i = 0; i < length; i++)
                points += ((unsigned char)line[i] & 0xc0) != 0x80;
            if (points > width)
                fail_msg("%d of %d columns: %.*s", points, width, (int)length, line);
            line += length + (line[length] == '\n');
        }
        free(table);
    }
    free_report(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_relative_error_above_one_percent_is_a_finding),
        cmocka_unit_test(test_our_own_runs_are_no_findings),
        cmocka_unit_test(test_a_failure_is_a_finding_where_there_is_a_reference),
        cmocka_unit_test(test_an_error_without_a_value_is_a_finding),
        cmocka_unit_test(test_a_known_cause_is_told_with_what_was_varied),
        cmocka_unit_test(test_an_unknown_cause_is_said_to_be_unknown),
        cmocka_unit_test(test_a_cause_is_that_of_its_profile_and_outcome),
        cmocka_unit_test(test_every_cause_can_be_reached_and_is_of_a_scenario_that_exists),
        cmocka_unit_test(test_innocence_of_the_adapter_is_told_for_the_engines_there),
        cmocka_unit_test(test_texts_of_results_are_escaped),
        cmocka_unit_test(test_stepping_and_contact_are_told_apart_with_the_rule),
        cmocka_unit_test(test_without_both_errors_there_is_no_such_section),
        cmocka_unit_test(test_findings_come_after_losses),
        cmocka_unit_test(test_table_keeps_to_the_width),
    };
    return cmocka_run_group_tests_name("report_findings", tests, NULL, NULL);
}
