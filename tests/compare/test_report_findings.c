/* Where the report says that other engines err, and why; and how it parts stepping from contact. */
#include "check.h"
#include "report_rows.h"

#include "plumb/scenario.h"
#include "referee/metrics/metrics.h"
#include "results/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A run with a primary error and its value, judged by a bound of 0.01. */
static json_t *add_error(json_t *results, const char *scenario, const char *label,
                         const char *outcome, const char *primary, double error)
{
    json_t *row = add_run(results, scenario, label, outcome);
    json_object_set_new(row, "primary_error", json_string(primary));
    json_object_set_new(row, "profile", json_string(strchr(label, ':') + 1));
    json_object_set_new(row, "engine_version", json_string(label[0] == 'o' ? "0.16.2" : "3.24"));
    set_metric(row, "reference_error",
               json_pack("{s:f, s:s}", "value", error, "unit",
                         strcmp(primary, "rest_position_error") == 0 ? "m" : "1"));
    if (strcmp(outcome, "ok") == 0) {
        set_verdict(row, error > 0.01 ? "inaccurate" : "accurate", "the error is too large");
    } else if (strcmp(outcome, "unsupported") != 0) {
        set_verdict(row, "failed", "the run ended early");
    }
    return row;
}

static void test_inaccurate_run_is_a_finding(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "a", "ode:quick", "ok", "value_error", 0.0101);
    add_error(results, "b", "ode:quick", "ok", "value_error", 0.0099);
    add_error(results, "c", "ode:quick", "ok", "travel_error", 0.5);
    add_error(results, "d", "ode:quick", "ok", "rest_position_error", 0.5);
    made_report made = make_report(results);
    assert_int_equal(made.report.findings.others.runs, 4);
    assert_int_equal(made.report.findings.others.count, 3);
    assert_string_equal(made.report.findings.others.items[0].cell->worst->scenario, "a");
    assert_string_equal(made.report.findings.others.items[1].cell->worst->scenario, "c");
    assert_contains(made.data, "3 of 4 runs of ode:quick that were judged");
    assert_contains(made.data, "inaccurate, 1.01 % (value_error)");
    assert_contains(made.data, "inaccurate, 50 % (travel_error)");
    assert_contains(made.data, "inaccurate, 0.500 m (rest_position_error)");
    free_report(&made);
}

/* They stand with the losses. */
static void test_our_own_runs_are_no_findings(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "a", "plumb:fast", "ok", "value_error", 0.5);
    add_error(results, "b", "plumb:fast", "collapsed", "rest_position_error", 0.5);
    made_report made = make_report(results);
    assert_int_equal(made.report.findings.others.count, 0);
    assert_absent(made.data, "Causes were found by experiment");
    assert_absent(made.markdown, "## Findings");
    assert_int_equal(made.report.findings.home.count, 2);
    const char *losses = strstr(made.data, "Where plumb loses");
    assert_non_null(losses);
    assert_contains(losses, "2 of 2 runs of plumb:fast that were judged are not accurate; of 0 "
                            "the cause is known.");
    assert_contains(losses, "inaccurate, 50 % (value_error)");
    assert_contains(losses, "\"the error is too large\"");
    char *table = printed_table(made.results, false, 120);
    assert_contains(table, "a     plumb:fast  inaccurate, 50 % (value_error)");
    assert_contains(table, "b     plumb:fast  failed: collapsed, 0.500 m (rest_position_error)");
    free(table);
    free_report(&made);
}

static void test_failed_run_is_a_finding(void **state)
{
    (void)state;
    static const char *const failures[] = {"collapsed", "diverged", "nonfinite", "crashed",
                                           "timeout"};
    for (size_t i = 0; i < sizeof failures / sizeof failures[0]; ++i) {
        json_t *results = json_array();
        add_error(results, "a", "ode:quick", failures[i], "rest_position_error", 0.25);
        made_report made = make_report(results);
        assert_int_equal(made.report.findings.others.count, 1);
        assert_contains(made.markdown, failures[i]);
        assert_contains(made.markdown, "0.250 m");
        free_report(&made);
    }
    static const char *const others[] = {"ok", "unsupported"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; ++i) {
        json_t *results = json_array();
        add_error(results, "a", "ode:quick", others[i], "rest_position_error", 0.005);
        made_report made = make_report(results);
        assert_int_equal(made.report.findings.others.count, 0);
        free_report(&made);
    }
    json_t *results = json_array();
    json_t *row = add_run(results, "a", "ode:quick", "collapsed");
    json_object_set_new(row, "primary_error", json_string(""));
    made_report made = make_report(results);
    assert_int_equal(made.report.findings.others.count, 1);
    assert_contains(made.data, "\"failed: collapsed\"");
    free_report(&made);
}

static void test_an_error_without_a_value_is_a_finding(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add_error(results, "a", "ode:quick", "ok", "value_error", 0);
    set_metric(row, "reference_error",
               json_pack("{s:n, s:s}", "value", "reason", "no whole period"));
    set_verdict(row, NULL, "value_error has no value: no whole period");
    made_report made = make_report(results);
    assert_int_equal(made.report.findings.others.count, 1);
    assert_contains(made.data, "no value (value_error)");
    free_report(&made);
}

static void assert_contains_json(const char *data, const char *text)
{
    pl_text_buffer out = {0};
    pl_text_add_json(&out, text);
    assert_contains(data, out.data);
    pl_text_free(&out);
}

static void test_known_cause_is_shown_with_its_evidence(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "torque-free", "ode:quick", "ok", "value_error", 0.74);
    add_error(results, "arch", "ode:dantzig", "crashed", "rest_position_error", 1);
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 4000);
    for (int i = 0; i < made.report.findings.others.count; ++i) {
        const json_t *cause = made.report.findings.others.items[i].cause;
        assert_non_null(cause);
        assert_contains_json(made.data, pl_json_get_text(cause, "cause"));
        assert_contains_json(made.data, pl_json_get_text(cause, "evidence"));
        assert_contains(table, pl_json_get_text(cause, "cause"));
    }
    assert_contains(made.data, "of 2 the cause is known");
    assert_contains(made.markdown, "gyroscopic");
    free(table);
    free_report(&made);
}

static void test_unknown_cause_is_reported_as_unknown(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "no such scene", "ode:quick", "ok", "value_error", 0.5);
    add_error(results, "overhang", "ode:quick", "collapsed", "rest_position_error", 1);
    made_report made = make_report(results);
    char *table = printed_table(made.results, false, 4000);
    assert_int_equal(made.report.findings.others.count, 2);
    assert_contains(made.data, "of 0 the cause is known");
    assert_contains(made.data, "\"cause not known\"");
    assert_contains(made.markdown, "| cause not known ");
    assert_contains(table, "cause not known");
    free(table);
    free_report(&made);
}

/* ---- Known causes ---- */

typedef struct run {
    const char *engine, *version, *label, *scenario, *outcome;
    const char *param; /* NULL: all at their defaults */
    double value;
} run;

/* The statement about a run; NULL when there is none. */
static const json_t *cause_of(const json_t *causes, run r)
{
    const char *profile = strchr(r.label, ':') + 1;
    json_t *row =
        json_pack("{s:s, s:s, s:s%, s:s, s:s, s:s, s:{}}", "engine", r.engine, "engine_version",
                  r.version, "profile", profile, strcspn(profile, ","), "label", r.label,
                  "scenario", r.scenario, "outcome", r.outcome, "params");
    if (r.param != NULL) {
        json_object_set_new(json_object_get(row, "params"), r.param, json_real(r.value));
    }
    const json_t *cause = pl_known_cause_find(causes, row);
    json_decref(row);
    return cause;
}

typedef struct cause_case {
    run run;
    bool known; /* whether its deviation has a known cause */
} cause_case;

static void check_causes(const cause_case *cases, size_t count)
{
    json_t *causes = pl_known_causes();
    for (size_t i = 0; i < count; ++i) {
        if ((cause_of(causes, cases[i].run) != NULL) != cases[i].known) {
            fail_msg("case %zu: expected %s", i, cases[i].known ? "a cause" : "none");
        }
    }
    json_decref(causes);
}

/* A run that was cut off or crashed says nothing of the cause of an error. */
static void test_cause_matches_engine_profile_and_outcome(void **state)
{
    (void)state;
    static const cause_case cases[] = {
        {{"ode", "0.16.2", "ode:quick", "tower", "collapsed", NULL, 0}, true},
        {{"ode", "0.16.2", "ode:quick", "tower", "timeout", NULL, 0}, false},
        {{"ode", "0.16.2", "ode:quick", "tower", "crashed", NULL, 0}, false},
        {{"ode", "0.16.2", "ode:dantzig", "multi-tower", "timeout", NULL, 0}, true},
        {{"bullet", "3.24", "bullet:nncg", "domino-into-pile", "diverged", NULL, 0}, true},
        {{"bullet", "3.24", "bullet:si", "domino-into-pile", "diverged", NULL, 0}, false},
        {{"bullet", "3.24", "bullet:nncg", "domino-into-pile", "collapsed", NULL, 0}, false},
        {{"bullet", "3.24", "bullet:nncg", "domino", "diverged", NULL, 0}, false},
        {{"bullet", "3.24", "bullet:nncg", "", "diverged", NULL, 0}, false},
        {{"plumb", "3.24", "plumb:nncg", "domino-into-pile", "diverged", NULL, 0}, false},
    };
    check_causes(cases, sizeof cases / sizeof cases[0]);
}

static void test_other_versions_parameters_and_options_have_no_cause(void **state)
{
    (void)state;
    static const cause_case cases[] = {
        {{"ode", "0.16.1", "ode:quick", "tower", "collapsed", NULL, 0}, false},
        {{"ode", "0.16.3", "ode:quick", "tower", "collapsed", NULL, 0}, false},
        {{"ode", "0.17", "ode:quick", "tower", "collapsed", NULL, 0}, false},
        {{"ode", "", "ode:quick", "tower", "collapsed", NULL, 0}, false},
        {{"ode", "0.16.2", "ode:quick,iterations=50", "tower", "collapsed", NULL, 0}, false},
        {{"bullet", "3.24", "bullet:si", "bounce", "ok", NULL, 0}, true},
        {{"bullet", "3.24", "bullet:si,erp2=0", "bounce", "ok", NULL, 0}, false},
        {{"ode", "0.16.2", "ode:quick", "tower", "collapsed", "n", 10}, true},
        {{"ode", "0.16.2", "ode:quick", "tower", "collapsed", "n", 100}, true},
        {{"ode", "0.16.2", "ode:quick", "tower", "collapsed", "n", 300}, false},
        {{"ode", "0.16.2", "ode:quick", "tower", "collapsed", "n", 5}, false},
        {{"ode", "0.16.2", "ode:quick", "tower", "collapsed", "friction", 0.4}, false},
        {{"ode", "0.16.2", "ode:quick", "tower", "collapsed", "dt", 1.0 / 60}, true},
        {{"ode", "0.16.2", "ode:quick", "tower", "collapsed", "dt", 1.0 / 120}, false},
        {{"ode", "0.16.2", "ode:quick", "projectile", "ok", "dt", 1.0 / 960}, true},
        {{"ode", "0.16.2", "ode:quick", "projectile", "ok", "dt", 1.0 / 1920}, false},
        {{"ode", "0.16.2", "ode:dantzig", "ladder", "collapsed", "angle", 52.9}, true},
        {{"ode", "0.16.2", "ode:dantzig", "ladder", "collapsed", "angle", 53.2}, false},
    };
    check_causes(cases, sizeof cases / sizeof cases[0]);
}

static void test_pages_show_a_cause_only_where_it_applies(void **state)
{
    (void)state;
    for (int n = 100; n <= 300; n += 200) {
        json_t *results = json_array();
        json_t *row =
            add_error(results, "tower", "ode:quick", "collapsed", "rest_position_error", 1);
        json_object_set_new(row, "params", json_pack("{s:i}", "n", n));
        made_report made = make_report(results);
        assert_int_equal(count_of(made.data, "of 100 cubes 1000 sweeps"), n == 100);
        assert_int_equal(count_of(made.markdown, "of 100 cubes 1000 sweeps"), n == 100);
        assert_int_equal(count_of(made.data, "cause not known"), n == 300);
        free_report(&made);
    }
}

/* A bound of a range: a number, or a text with one. */
static double bound_of(const json_t *range, size_t index)
{
    const json_t *bound = json_array_get(range, index);
    double value = json_number_value(bound);
    assert_true(json_is_number(bound) || pl_parse_number(json_string_value(bound), &value));
    return value;
}

static const pl_param *find_param(const pl_scenario *scenario, const char *name)
{
    for (int i = 0; i < scenario->param_count; ++i) {
        if (strcmp(scenario->params[i].name, name) == 0) {
            return &scenario->params[i];
        }
    }
    fail_msg("%s has no parameter %s", scenario->name, name);
    return NULL;
}

static void check_ranges(const char *name, json_t *ranges)
{
    const pl_scenario *scenario = pl_scenario_find(name, NULL);
    const char *key;
    json_t *range;
    assert_non_null(scenario);
    assert_true(json_is_object(ranges));
    json_object_foreach(ranges, key, range)
    {
        const pl_param *param = find_param(scenario, key);
        const double least = bound_of(range, 0), largest = bound_of(range, 1);
        assert_int_equal(json_array_size(range), 2);
        assert_true(param->min <= least && least <= largest && largest <= param->max);
    }
}

/* The newest version of a statement's engine. */
static const char *newest_of(const json_t *causes, const json_t *cause)
{
    const json_t *own = json_object_get(cause, "versions");
    const json_t *range = own != NULL ? own
                                      : json_object_get(json_object_get(causes, "versions"),
                                                        pl_json_get_text(cause, "engine"));
    const char *oldest = json_string_value(json_array_get(range, 0));
    const char *newest = json_string_value(json_array_get(range, 1));
    assert_int_equal(json_array_size(range), 2);
    assert_true(oldest != NULL && newest != NULL && strverscmp(oldest, newest) <= 0);
    return newest;
}

static const char *profile_of(const json_t *causes, const json_t *cause)
{
    const char *engine = pl_json_get_text(cause, "engine");
    const json_t *profiles = json_object_get(json_object_get(causes, "profiles"), engine);
    const char *own = json_string_value(json_object_get(cause, "profile"));
    return own != NULL ? own : json_string_value(json_array_get(profiles, 0));
}

static void check_keys(const json_t *object, const char *const *keys, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; ++i) {
        found += json_object_get(object, keys[i]) != NULL;
    }
    assert_int_equal(found, json_object_size(object));
}

/* What the program takes for granted of a file that is built into it. */
static void test_known_causes_are_well_formed_and_reached(void **state)
{
    (void)state;
    static const char *const file_keys[] = {"schema", "found_with", "versions", "profiles",
                                            "causes"};
    static const char *const keys[] = {"id",       "engine",    "profile", "outcome",
                                       "versions", "scenarios", "cause",   "evidence"};
    json_t *causes = pl_known_causes(), *cause, *ranges;
    size_t i;
    assert_string_equal(pl_json_get_text(causes, "schema"), "plumb.known-causes/2");
    assert_true(pl_json_get_text(causes, "found_with")[0] != '\0');
    assert_true(json_array_size(json_object_get(causes, "causes")) >= 45);
    check_keys(causes, file_keys, 5);
    json_array_foreach(json_object_get(causes, "causes"), i, cause)
    {
        const char *name, *outcome = json_string_value(json_object_get(cause, "outcome"));
        bool reached = false;
        char label[64];
        check_keys(cause, keys, 8);
        assert_true(pl_json_get_text(cause, "evidence")[0] != '\0');
        assert_true(json_is_null(json_object_get(cause, "cause")) ||
                    pl_json_get_text(cause, "cause")[0] != '\0');
        snprintf(label, sizeof label, "%s:%s", pl_json_get_text(cause, "engine"),
                 profile_of(causes, cause));
        json_object_foreach(json_object_get(cause, "scenarios"), name, ranges)
        {
            const run r = {pl_json_get_text(cause, "engine"),
                           newest_of(causes, cause),
                           label,
                           name,
                           outcome == NULL ? "ok" : outcome,
                           NULL,
                           0};
            check_ranges(name, ranges);
            reached |= cause_of(causes, r) == cause;
        }
        if (!reached) {
            fail_msg("%s: others come first", pl_json_get_text(cause, "id"));
        }
    }
    json_decref(causes);
}

/* Each statement has a name of its own, by which the file of experiments has it; that file has no other. */
static void test_experiments_are_those_of_the_causes(void **state)
{
    (void)state;
    json_error_t error;
    json_t *causes = pl_known_causes(), *cause;
    json_t *experiments =
        json_load_file(PLUMB_SOURCE_DIR "/tests/compare/known_causes_experiments.json",
                       JSON_REJECT_DUPLICATES, &error);
    size_t i;
    assert_true(json_is_object(experiments));
    json_array_foreach(json_object_get(causes, "causes"), i, cause)
    {
        const char *id = pl_json_get_text(cause, "id");
        if (json_object_del(experiments, id) != 0) {
            fail_msg("\"%s\" has no experiments, or an earlier cause has that name", id);
        }
    }
    assert_int_equal(json_object_size(experiments), 0);
    json_decref(causes);
    json_decref(experiments);
}

/* ---- Order ---- */

static void set_text(json_t *row, const char *metric, const char *text)
{
    set_metric(row, metric, json_pack("{s:s, s:s}", "value", text, "unit", "rule"));
}

static void test_stepping_and_contact_errors_are_listed_separately(void **state)
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
    assert_contains(made.markdown,
                    "| second order, exact for constant force | 2.00e-15 | 1.00e-15 |");
    assert_contains(made.markdown, "| not detected |");
    assert_contains(made.markdown, "| semi-implicit Euler | 0.00550 | 3.00e-14 |");
    assert_absent(made.markdown, "| c | ode:quick | not detected");
    free_report(&made);
}

static void test_without_both_errors_there_is_no_such_section(void **state)
{
    (void)state;
    made_report made = make_report(two_runs("drift", 1e-3, 2e-3));
    assert_absent(made.data, "\"discrete_error\":[");
    assert_absent(made.markdown, "Time stepping");
    free_report(&made);
}

static void test_findings_come_after_losses(void **state)
{
    (void)state;
    json_t *results = json_array();
    add_error(results, "a", "plumb:fast", "ok", "value_error", 0.5);
    add_error(results, "a", "ode:quick", "ok", "value_error", 0.5);
    made_report made = make_report(results);
    assert_before(made.markdown, "## Where plumb loses", "## Findings");
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
            for (size_t i = 0; i < length; ++i) {
                points += ((unsigned char)line[i] & 0xc0) != 0x80;
            }
            if (points > width) {
                fail_msg("%d of %d columns: %.*s", points, width, (int)length, line);
            }
            line += length + (line[length] == '\n');
        }
        free(table);
    }
    free_report(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_inaccurate_run_is_a_finding),
        cmocka_unit_test(test_our_own_runs_are_no_findings),
        cmocka_unit_test(test_failed_run_is_a_finding),
        cmocka_unit_test(test_an_error_without_a_value_is_a_finding),
        cmocka_unit_test(test_known_cause_is_shown_with_its_evidence),
        cmocka_unit_test(test_unknown_cause_is_reported_as_unknown),
        cmocka_unit_test(test_cause_matches_engine_profile_and_outcome),
        cmocka_unit_test(test_other_versions_parameters_and_options_have_no_cause),
        cmocka_unit_test(test_pages_show_a_cause_only_where_it_applies),
        cmocka_unit_test(test_known_causes_are_well_formed_and_reached),
        cmocka_unit_test(test_experiments_are_those_of_the_causes),
        cmocka_unit_test(test_stepping_and_contact_errors_are_listed_separately),
        cmocka_unit_test(test_without_both_errors_there_is_no_such_section),
        cmocka_unit_test(test_findings_come_after_losses),
        cmocka_unit_test(test_table_keeps_to_the_width),
    };
    return cmocka_run_group_tests_name("report_findings", tests, NULL, NULL);
}
