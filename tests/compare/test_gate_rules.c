/* Rules and tolerances: what they judge, and what is said of mistakes in them. */
#include "check.h"
#include "gate_trial.h"
#include "report_rows.h"

static void test_rules_judge_what_they_name(void **state)
{
    const workspace *w = *state;
    static const struct {
        const char *rule;
        int failures;
    } rows[] = {{"drift>0.4", 1},
                {"drift>0.6", 0},
                {"drift<=0.5", 1},
                {"drift==0.5", 1},
                {"drift!=0.5", 0},
                {"scene: drift>0.4", 1},
                {"sc*/mine: drift > 0.4", 1},
                {"scene/mine:p: drift>=1/2", 1},
                {"*/mine:*: drift>0.4", 1},
                {"outcome!=ok", 0},
                {"outcome == ok", 1},
                {"verdict!=accurate", 1},
                {"verdict==not judged", 1},
                {"verdict==failed", 0},
                {"drift>+0%", 0},
                {"drift>=-1%", 0},
                /* These rules judge nothing, which is a failure. */
                {"scene/other: drift>1", 1},
                {"tower: drift>1", 1},
                {"lift>1", 1},
                {"time_per_step>+10%", 1},
                {"time_ratio>1", 1}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        trial t = pair("drift", 0.5, 0.5);
        add_rule(&t, rows[i].rule);
        judge(w, &t);
        if (t.verdict.failures != rows[i].failures) {
            fail_msg("%s: %d failures", rows[i].rule, t.verdict.failures);
        }
        end_trial(&t);
    }
    trial t = pair("drift", 0.5, 0.55);
    set_tolerance(&t, "drift=off");
    add_rule(&t, "drift>+5%");
    add_rule(&t, "drift>+15%");
    expect(w, t, 1, 0, "drift", "the rule fails it");
    t = pair("drift", 0.5, 0.55);
    set_tolerance(&t, "drift=1");
    add_rule(&t, "drift>+5%");
    add_rule(&t, "drift>+15%");
    expect(w, t, 1, 0, "drift", "the rule fails it");
}

static void test_run_without_the_value_fails_the_rule(void **state)
{
    const workspace *w = *state;
    json_t *crashed = json_array();
    json_object_set_new(add_run(crashed, "scene", "mine:p", "crashed"), "reason",
                        json_string("SIGSEGV"));
    trial t = begin_trial(json_incref(crashed), crashed);
    add_rule(&t, "drift>0.4");
    expect(w, t, 1, 0, "drift", "crashed: SIGSEGV");
    json_t *lost = json_pack("{s:n, s:s}", "value", "reason", "still moves");
    json_t *results = single("settle_time", lost);
    t = begin_trial(json_incref(results), results);
    add_rule(&t, "settle_time>2");
    expect(w, t, 1, 0, "settle_time", "still moves");
}

static void test_mistakes_in_rules_are_reported_with_column(void **state)
{
    (void)state;
    static const char *const rows[][2] = {
        {"", "column 1: expected a metric, found nothing"},
        {"tower: ", "column 8: expected a metric, found nothing"},
        {"drif>1", "column 1: there is no metric drif; did you mean drift?"},
        {"tower/plumb:accurate: lfit>1", "column 23: there is no metric lfit; did you mean lift?"},
        {"drift", "column 6: expected one of > >= < <= == !=, found nothing"},
        {"drift=1", "column 6: expected one of"},
        {"drift>", "column 7: expected a number, or one with a sign and %, found nothing"},
        {"drift > abc", "column 9: expected a number, or one with a sign and %, found \"abc\""},
        {"drift>1e-3m", "column 7: expected a number"},
        {"drift>nan", "column 7: expected a number"},
        {"drift>++1%", "column 7: expected a number"},
        {"drift>10%", "column 7: expected a sign and % together"},
        {"drift>+10", "column 7: expected a sign and % together"},
        {"drift==+10%", "column 8: expected a number without %"},
        {"time_per_step<+10%", "column 15: expected growth of a time"},
        {"outcome>ok", "column 8: expected == or != before a text"},
        {"outcome!=fine", "column 10: expected ok, collapsed"},
        {"verdict<accurate", "column 8: expected == or != before a text"},
        {"verdict!=ok", "column 10: expected accurate, inaccurate, failed or not judged"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        pl_gate_rule rule;
        pl_error error = {PL_OK, ""};
        assert_int_equal(pl_gate_rule_parse(rows[i][0], &rule, &error), PL_BAD_INPUT);
        assert_contains(error.message, rows[i][1]);
    }
    static const char *const limits[][2] = {{"drift", "expected METRIC=RELATIVE"},
                                            {"drif=1", "did you mean drift?"},
                                            {"drift=x", "expected numbers"},
                                            {"drift=1,", "expected numbers"},
                                            {"drift=-1", "expected numbers"},
                                            {"drift=", "expected numbers"},
                                            {"time_per_step=0.1", "have --time-limit"},
                                            {"instructions_per_step=0.1", "have --time-limit"},
                                            {"verdict=0", "a verdict"},
                                            {"outcome=0", "an outcome has no tolerance"}};
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; ++i) {
        pl_gate_tolerances parsed = pl_gate_tolerances_default();
        pl_error error = {PL_OK, ""};
        assert_int_equal(pl_gate_tolerances_parse(limits[i][0], &parsed, &error), PL_BAD_INPUT);
        assert_contains(error.message, limits[i][1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rules_judge_what_they_name),
        cmocka_unit_test(test_run_without_the_value_fails_the_rule),
        cmocka_unit_test(test_mistakes_in_rules_are_reported_with_column),
    };
    return cmocka_run_group_tests_name("gate rules", tests, setup_workspace, teardown_workspace);
}
