/* Results made by hand, judged by the gate. */
#include "gate_trial.h"

#include "check.h"
#include "gate/gate.h"
#include "report_rows.h"

#include <stdlib.h>
#include <string.h>

trial begin_trial(json_t *old_results, json_t *new_results)
{
    return (trial){.old_results = old_results,
                   .new_results = new_results,
                   .old_table = table_of(old_results),
                   .new_table = table_of(new_results),
                   .tolerances = pl_gate_tolerances_default()};
}

void add_rule(trial *t, const char *text)
{
    pl_error error = {PL_OK, ""};
    if (pl_gate_rule_parse(text, &t->rules[t->rule_count++], &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
}

void set_tolerance(trial *t, const char *text)
{
    assert_int_equal(pl_gate_tolerances_parse(text, &t->tolerances, NULL), PL_OK);
}

void judge(const workspace *w, trial *t)
{
    pl_error error = {PL_OK, ""};
    char *path = path_in(w->directory, "baseline.json");
    pl_gate_gather(t->old_table, &t->tolerances, &t->made);
    pl_gate_ratios_add(&t->made, NULL);
    pl_gate_gather(t->new_table, &t->tolerances, &t->now);
    pl_status status = pl_gate_baseline_write(path, &t->made, &error);
    status = status == PL_OK ? pl_gate_baseline_read(path, &t->before, &error) : status;
    t->verdict = (pl_gate_verdict){.before = &t->before,
                                   .now = &t->now,
                                   .tolerances = &t->tolerances,
                                   .rules = t->rules,
                                   .rule_count = t->rule_count};
    if (status != PL_OK) {
        fail_msg("%s", error.message);
    }
    pl_gate_judge(&t->verdict);
    free(path);
}

void end_trial(trial *t)
{
    free(t->verdict.items);
    pl_gate_rows_free(&t->made);
    pl_gate_rows_free(&t->before);
    pl_gate_rows_free(&t->now);
    free_table(t->old_table);
    free_table(t->new_table);
    json_decref(t->old_results);
    json_decref(t->new_results);
}

void expect(const workspace *w, trial t, int failures, int notices, const char *metric,
            const char *what)
{
    judge(w, &t);
    if (t.verdict.failures != failures || t.verdict.notices != notices) {
        for (int i = 0; i < t.verdict.count; ++i) {
            print_error("%s: %s\n", t.verdict.items[i].metric, t.verdict.items[i].what);
        }
    }
    assert_int_equal(t.verdict.failures, failures);
    assert_int_equal(t.verdict.notices, notices);
    if (failures + notices > 0) {
        assert_string_equal(t.verdict.items[0].metric, metric);
        assert_contains(t.verdict.items[0].what, what);
    }
    end_trial(&t);
}

json_t *single(const char *metric, json_t *value)
{
    json_t *results = json_array();
    set_metric(add_run(results, "scene", "mine:p", "ok"), metric, value);
    return results;
}

trial pair(const char *metric, double before, double now)
{
    return begin_trial(single(metric, metric_value(before)), single(metric, metric_value(now)));
}
