/* The caller's own rules. One that judges nothing fails: a gate that is open by a misspelt name, or
 * because a run is gone, is no gate. */
#include "judge.h"
#include "ratio.h"
#include "results/result.h"

#include <stdio.h>
#include <string.h>

static const json_t *value_in(const pl_gate_row *row, const char *metric)
{
    const json_t *value = json_object_get(row->metrics, metric);
    return value != NULL ? value : json_object_get(row->measured, metric);
}

static pl_gate_finding *add(const pl_gate_rule *rule, const pl_gate_row *row,
                            pl_gate_report *report)
{
    pl_gate_finding *finding = pl_gate_report_add(report, true, row, rule->metric);
    snprintf(finding->limit, sizeof finding->limit, "not %.120s", rule->text);
    snprintf(finding->what, sizeof finding->what, "the rule fails it");
    return finding;
}

static void judge_text(const pl_gate_rule *rule, const pl_gate_row *row, const char *found,
                       pl_gate_report *report)
{
    report->comparisons++;
    if ((strcmp(found, rule->word) == 0) != (rule->op == PL_GATE_EQUAL)) {
        return;
    }
    pl_gate_finding *finding = add(rule, row, report);
    snprintf(finding->after, sizeof finding->after, "%.90s", found);
    if (row->reason[0] != '\0') {
        snprintf(finding->what, sizeof finding->what, "%.250s", row->reason);
    }
}

/* False: the metric does not apply. A run that did not end well has not everything that it would be
 * judged by, and fails. */
static bool judge_no_value(const pl_gate_rule *rule, const pl_gate_row *row, const json_t *value,
                           pl_gate_report *report)
{
    bool is_ok = pl_gate_row_is_ok(row);
    if (value == NULL && is_ok) {
        return false;
    }
    pl_gate_finding *finding = add(rule, row, report);
    const char *reason = pl_json_get_text(row->reasons, rule->metric);
    snprintf(finding->after, sizeof finding->after, "no value");
    snprintf(finding->what, sizeof finding->what, "%.120s%s%.120s", is_ok ? reason : row->outcome,
             row->reason[0] == '\0' ? "" : ": ", row->reason);
    report->comparisons++;
    return true;
}

/* Of repeats that differ, any. */
static void judge_absolute(const pl_gate_rule *rule, const pl_gate_row *row, double now,
                           pl_gate_report *report)
{
    const json_t *range = json_object_get(row->spread, rule->metric);
    bool holds = pl_gate_rule_holds(rule, now);
    for (size_t i = 0; i < json_array_size(range) && !holds; ++i) {
        now = json_number_value(json_array_get(range, i));
        holds = pl_gate_rule_holds(rule, now);
    }
    report->comparisons++;
    if (holds) {
        pl_gate_finding *finding = add(rule, row, report);
        pl_gate_number_texts(finding, now, now, pl_gate_unit(rule->metric));
        finding->before[0] = '\0';
    }
}

/* False: the baseline has no number to hold it against. */
static bool judge_relative(const pl_gate_case *c, const pl_gate_rule *rule, const pl_gate_row *row,
                           double now, pl_gate_report *report)
{
    const pl_gate_row *before = c->before == NULL ? NULL : pl_gate_rows_find(c->before, row->key);
    const json_t *kept = before == NULL ? NULL : json_object_get(before->metrics, rule->metric);
    if (!json_is_number(kept)) {
        return false;
    }
    int id = pl_metric_by_name(rule->metric);
    double least = id < 0 ? 0 : c->limits->of[id].absolute;
    report->comparisons++;
    if (pl_gate_rule_holds_relative(rule, json_number_value(kept), now, least)) {
        pl_gate_finding *finding = add(rule, row, report);
        pl_gate_number_texts(finding, json_number_value(kept), now, pl_gate_unit(rule->metric));
    }
    return true;
}

static bool judge_value(const pl_gate_case *c, const pl_gate_rule *rule, const pl_gate_row *row,
                        pl_gate_report *report)
{
    const json_t *value = value_in(row, rule->metric);
    if (!json_is_number(value)) {
        return judge_no_value(rule, row, value, report);
    }
    if (rule->is_relative) {
        return judge_relative(c, rule, row, json_number_value(value), report);
    }
    judge_absolute(rule, row, json_number_value(value), report);
    return true;
}

/* An absolute rule on a ratio. */
static pl_status judge_ratio(const pl_gate_case *c, const pl_gate_rule *rule,
                             const pl_gate_row *row, bool *judged, pl_gate_report *report,
                             pl_error *error)
{
    const pl_gate_row *reference = pl_gate_reference_of(c->now, row, c->reference);
    pl_gate_ratio ratio = {0};
    if (reference != NULL) {
        const char *metric = pl_gate_costs[pl_gate_cost_of(rule->metric)].metric;
        pl_status status = pl_gate_ratio_measure(row, reference, metric, &ratio, error);
        if (status != PL_OK) {
            return status;
        }
    }
    *judged = ratio.repeats > 0;
    report->comparisons += *judged;
    if (*judged && pl_gate_rule_holds(rule, ratio.value)) {
        pl_gate_finding *finding = add(rule, row, report);
        snprintf(finding->after, sizeof finding->after, "%.4g times %.60s's", ratio.value,
                 reference->label);
    }
    return PL_OK;
}

static pl_status judge_row(const pl_gate_case *c, const pl_gate_rule *rule, const pl_gate_row *row,
                           bool *judged, pl_gate_report *report, pl_error *error)
{
    int cost = pl_gate_cost_of(rule->metric);
    *judged = true;
    if (pl_gate_rule_is_cost(rule)) {
        /* Judged with the costs of the baseline; here it is seen whether there was one. */
        const pl_gate_row *before =
            c->before == NULL ? NULL : pl_gate_rows_find(c->before, row->key);
        *judged =
            before != NULL && json_object_get(before->json, pl_gate_costs[cost].ratio) != NULL;
    } else if (strcmp(rule->metric, "outcome") == 0) {
        judge_text(rule, row, row->outcome, report);
    } else if (cost >= 0 && strcmp(rule->metric, pl_gate_costs[cost].ratio) == 0) {
        return judge_ratio(c, rule, row, judged, report, error);
    } else if (rule->is_text) {
        const json_t *value = value_in(row, rule->metric);
        *judged = json_is_string(value);
        if (*judged) {
            judge_text(rule, row, json_string_value(value), report);
        }
    } else {
        *judged = judge_value(c, rule, row, report);
    }
    return PL_OK;
}

pl_status pl_gate_judge_rules(const pl_gate_case *c, pl_gate_report *report, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < c->rule_count; ++i) {
        const pl_gate_rule *rule = &c->rules[i];
        int selected = 0, judged_rows = 0;
        for (int k = 0; k < c->now->count && status == PL_OK; ++k) {
            bool judged = false;
            if (pl_gate_rule_selects(rule, &c->now->items[k])) {
                ++selected;
                status = judge_row(c, rule, &c->now->items[k], &judged, report, error);
            }
            judged_rows += judged;
        }
        if (status == PL_OK && judged_rows == 0) {
            pl_gate_finding *finding = add(rule, NULL, report);
            snprintf(finding->what, sizeof finding->what, "the rule judges nothing: %s",
                     selected == 0 ? "no row is of that scenario and engine"
                                   : "no row that it is of has the value");
        }
    }
    return status;
}
