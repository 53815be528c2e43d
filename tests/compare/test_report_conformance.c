/* What reports claim of an engine's adapter: what the results say was verified, and no more. No engine
 * without a record is called innocent. */
#include "check.h"
#include "report/sections.h"
#include "report_rows.h"

#include <stdlib.h>
#include <string.h>

/* A run of another engine with an error that is a finding. */
static json_t *add_finding(json_t *results, const char *label)
{
    json_t *row = add_run(results, "a", label, "ok");
    json_object_set_new(row, "primary_error", json_string("value_error"));
    json_object_set_new(row, "verdict", json_string("inaccurate"));
    json_object_set_new(row, "profile",
                        json_stringn(strchr(label, ':') + 1, strcspn(strchr(label, ':') + 1, ",")));
    set_metric(row, "reference_error", json_pack("{s:f, s:s}", "value", 0.5, "unit", "1"));
    return row;
}

static void set_record(json_t *row, int checks, int failed)
{
    json_object_set_new(row, "conformance",
                        json_pack("{s:s, s:i, s:i, s:s}", "outcome",
                                  failed > 0 ? "failed" : "passed", "checks", checks, "failed",
                                  failed, "plumb", "0.9.0"));
}

static void set_read_back(json_t *row, const char *all)
{
    json_object_set_new(row, "read_back", json_loads(all, 0, NULL));
}

static const char everything[] =
    "[\"dt\",\"gravity\",\"mass\",\"inertia\",\"damping\",\"friction\",\"restitution\"]";

static void assert_conformance(const made_report *made, int column, const char *expected)
{
    char *text = pl_conformance_text(made->table, column);
    assert_string_equal(text, expected);
    free(text);
}

/* The text is on the pages, escaped, and on the terminal. */
static void assert_everywhere(const made_report *made, const char *text)
{
    char *table = printed_table(made->results, false, 4000);
    pl_text_buffer quoted = {0}, markdown = {0};
    pl_text_add_json(&quoted, text);
    quoted.data[quoted.length - 1] = '\0'; /* it may be part of a longer text */
    pl_text_add_markdown(&markdown, text);
    assert_contains(made->data, quoted.data + 1);
    assert_contains(made->markdown, markdown.data);
    assert_contains(table, text);
    pl_text_free(&quoted);
    pl_text_free(&markdown);
    free(table);
}

static void assert_nowhere(const made_report *made, const char *text)
{
    char *table = printed_table(made->results, false, 4000);
    assert_absent(made->data, text);
    assert_absent(made->markdown, text);
    assert_absent(table, text);
    free(table);
}

static void test_an_engine_without_a_record_is_not_verified(void **state)
{
    (void)state;
    json_t *results = json_array();
    set_read_back(add_finding(results, "ode:quick"), everything);
    made_report made = make_report(results);
    assert_conformance(&made, 0, "not verified: run plumb check-engine ode:quick");
    assert_everywhere(&made, "not verified: run plumb check-engine ode:quick");
    assert_everywhere(&made, "a deviation may be its adapter's.");
    assert_nowhere(&made, "conformance passed");
    assert_nowhere(&made, "not the adapter");
    free_report(&made);
}

static void test_passed_and_failed_conformance_are_told(void **state)
{
    (void)state;
    json_t *results = json_array();
    set_record(add_finding(results, "bullet:nncg"), 36, 2);
    set_record(add_finding(results, "bullet:si"), 36, 0);
    set_record(add_finding(results, "ode:quick"), 36, 0);
    made_report made = make_report(results);
    assert_conformance(&made, 0, "conformance FAILED: 2 of 36 checks");
    assert_conformance(&made, 1, "conformance passed (36 checks, plumb 0.9.0)");
    assert_everywhere(&made, "conformance passed (36 checks, plumb 0.9.0)");
    assert_everywhere(&made, "conformance FAILED: 2 of 36 checks");
    free_report(&made);
}

static void test_one_run_without_a_record_is_enough_for_doubt(void **state)
{
    (void)state;
    for (int order = 0; order < 2; ++order) {
        json_t *results = json_array();
        json_t *first = add_finding(results, "ode:quick"),
               *last = add_finding(results, "ode:quick");
        json_object_set_new(last, "scenario", json_string("b"));
        set_record(order == 0 ? first : last, 36, 0);
        made_report made = make_report(results);
        assert_conformance(&made, 0, "not verified: run plumb check-engine ode:quick");
        free_report(&made);
        results = json_array();
        first = add_finding(results, "ode:quick");
        last = add_finding(results, "ode:quick");
        json_object_set_new(last, "scenario", json_string("b"));
        set_record(order == 0 ? first : last, 36, 1);
        set_record(order == 0 ? last : first, 36, 0);
        made = make_report(results);
        assert_conformance(&made, 0, "conformance FAILED: 1 of 36 checks");
        free_report(&made);
    }
}

/* Checks are of a profile with its defaults, which is what other settings and labels name. */
static void test_other_options_name_the_profile_that_passed(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add_finding(results, "ode:quick,erp=0.3");
    set_record(row, 36, 0);
    made_report made = make_report(results);
    assert_conformance(&made, 0, "conformance of ode:quick passed (36 checks, plumb 0.9.0)");
    free_report(&made);
}

static void test_the_spec_is_as_a_shell_takes_it(void **state)
{
    (void)state;
    static const char *const specs[][2] = {{"./mine.so:fast", "./mine.so:fast"},
                                           {"./my engine.so:fast", "'./my engine.so:fast'"},
                                           {"./it's.so:p", "'./it'\\''s.so:p'"}};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; ++i) {
        char expected[128];
        json_t *results = json_array();
        json_t *row = add_finding(results, "mine:fast");
        json_object_set_new(row, "engine_spec", json_string(specs[i][0]));
        made_report made = make_report(results);
        snprintf(expected, sizeof expected, "not verified: run plumb check-engine %s", specs[i][1]);
        assert_conformance(&made, 0, expected);
        free_report(&made);
    }
}

static void test_findings_say_what_was_read_back(void **state)
{
    (void)state;
    json_t *results = json_array();
    set_read_back(add_finding(results, "bullet:si"), everything);
    set_read_back(add_finding(results, "ode:quick"), "[\"dt\", \"gravity\", \"mass\"]");
    set_read_back(add_finding(results, "some:p"), "[]");
    made_report made = make_report(results);
    assert_everywhere(&made, "bullet:si 1.0: dt, gravity, mass, inertia, damping, friction and "
                             "restitution agreed.");
    assert_everywhere(&made, "ode:quick 1.0: dt, gravity and mass agreed; not read back: inertia, "
                             "damping, friction and restitution.");
    assert_everywhere(&made, "some:p 1.0: nothing was read back.");
    free_report(&made);
}

/* Only engines with a finding are spoken of. */
static void test_no_finding_needs_no_statement(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add_finding(results, "ode:quick");
    json_object_set_new(row, "verdict", json_string("accurate"));
    made_report made = make_report(results);
    assert_int_equal(made.report.findings.others.count, 0);
    assert_nowhere(&made, "read back");
    assert_everywhere(&made, "not verified: run plumb check-engine ode:quick");
    free_report(&made);
}

static void test_times_of_create_and_read_are_shown(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add_finding(results, "ode:quick");
    made_report made = make_report(results);
    assert_absent(made.data, "\"time_create\":[");
    free_report(&made);
    results = json_array();
    row = add_finding(results, "ode:quick");
    set_metric(row, "time_create", metric_value(1.5e-3));
    set_metric(row, "wall_time_per_step", metric_value(2.5e-6));
    made = make_report(results);
    assert_contains(made.data, "\"time_create\":[0.0015,\"1.50 ms\"");
    assert_contains(made.data, "\"2.50 µs\"");
    free_report(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_engine_without_a_record_is_not_verified),
        cmocka_unit_test(test_passed_and_failed_conformance_are_told),
        cmocka_unit_test(test_one_run_without_a_record_is_enough_for_doubt),
        cmocka_unit_test(test_other_options_name_the_profile_that_passed),
        cmocka_unit_test(test_the_spec_is_as_a_shell_takes_it),
        cmocka_unit_test(test_findings_say_what_was_read_back),
        cmocka_unit_test(test_no_finding_needs_no_statement),
        cmocka_unit_test(test_times_of_create_and_read_are_shown),
    };
    return cmocka_run_group_tests_name("report_conformance", tests, NULL, NULL);
}
