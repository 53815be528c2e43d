/* Times and instructions: as ratios to the reference engine of the same results. */
#include "judge.h"
#include "ratio.h"
#include "results/result.h"

#include <stdio.h>
#include <string.h>

/* The last relative rule on this cost of the row takes the place of the general limit. */
static const pl_gate_rule *rule_of(const pl_gate_case *c, const pl_gate_row *row, int cost)
{
    const pl_gate_rule *found = NULL;
    for (int i = 0; i < c->rule_count; ++i) {
        const pl_gate_rule *rule = &c->rules[i];
        if (pl_gate_rule_is_cost(rule) && pl_gate_cost_of(rule->metric) == cost &&
            pl_gate_rule_selects(rule, row)) {
            found = rule;
        }
    }
    return found;
}

static void tell_trend(const pl_gate_row *row, int cost, const char *reference,
                       const pl_gate_ratio *before, const pl_gate_ratio *now, double limit,
                       pl_gate_report *report)
{
    static const char *const words[] = {[PL_GATE_STEADY] = "",
                                        [PL_GATE_SLOWER] = "costlier",
                                        [PL_GATE_FASTER] = "cheaper",
                                        [PL_GATE_FEW] = "",
                                        [PL_GATE_NOISY] = "inconclusive"};
    const char *metric = pl_gate_costs[cost].metric;
    double growth, noise;
    pl_gate_trend trend = pl_gate_ratio_trend(before, now, limit, &growth, &noise);
    if (trend == PL_GATE_FEW) {
        pl_gate_report_count(report, metric,
                             "inconclusive: noise is told from 5 repeats or more (--repeat 5), "
                             "here and in the baseline");
        return;
    }
    report->comparisons++;
    if (trend == PL_GATE_STEADY) {
        return;
    }
    pl_gate_finding *finding = pl_gate_report_add(report, trend == PL_GATE_SLOWER, row, metric);
    char unit[80];
    snprintf(unit, sizeof unit, "times %.70s's", reference);
    pl_gate_number_texts(finding, before->value, now->value, unit);
    snprintf(finding->limit, sizeof finding->limit, "+%.3g %% and the noise", 100 * limit);
    snprintf(finding->what, sizeof finding->what, "%s: %+.3g %%, noise %.2g %%", words[trend],
             100 * growth, 100 * noise);
}

static pl_status judge_cost(const pl_gate_case *c, const pl_gate_row *before,
                            const pl_gate_row *now, int cost, pl_gate_report *report,
                            pl_error *error)
{
    const char *metric = pl_gate_costs[cost].metric;
    const json_t *kept = json_object_get(before->json, pl_gate_costs[cost].ratio);
    if (kept == NULL) {
        return PL_OK;
    }
    const char *kept_reference = pl_json_get_text(kept, "reference");
    if (c->reference != NULL && strcmp(c->reference, kept_reference) != 0) {
        pl_gate_report_count(report, metric, "not compared: the baseline has another reference");
        return PL_OK;
    }
    const pl_gate_row *reference = pl_gate_reference_of(c->now, now, kept_reference);
    pl_gate_ratio ratio = {0};
    pl_status status =
        reference == NULL ? PL_OK : pl_gate_ratio_measure(now, reference, metric, &ratio, error);
    if (status != PL_OK) {
        return status;
    }
    if (ratio.repeats == 0) {
        pl_gate_report_count(report, metric,
                             "not compared: no run of the reference engine beside it");
        return PL_OK;
    }
    const pl_gate_rule *rule = rule_of(c, now, cost);
    double limit = rule != NULL           ? rule->value
                   : cost == PL_GATE_TIME ? c->limits->time
                                          : c->limits->instructions;
    const pl_gate_ratio kept_ratio = pl_gate_ratio_of_json(kept);
    tell_trend(now, cost, kept_reference, &kept_ratio, &ratio, limit, report);
    return PL_OK;
}

pl_status pl_gate_judge_costs(const pl_gate_case *c, const pl_gate_row *before,
                              const pl_gate_row *now, pl_gate_report *report, pl_error *error)
{
    pl_status status = PL_OK;
    for (int cost = 0; cost < PL_GATE_COST_COUNT && status == PL_OK; ++cost) {
        status = judge_cost(c, before, now, cost, report, error);
    }
    return status;
}
