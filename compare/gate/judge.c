/* Row by row: is it there, did it end well, are its numbers what they were. */
#include "judge.h"

#include <stdio.h>
#include <string.h>

static void judge_missing(const pl_gate_row *before, pl_gate_report *report)
{
    pl_gate_finding *finding = pl_gate_report_add(report, true, before, "outcome");
    snprintf(finding->before, sizeof finding->before, "%.90s", before->outcome);
    snprintf(finding->after, sizeof finding->after, "missing");
    snprintf(finding->limit, sizeof finding->limit, "every run of the baseline");
    snprintf(finding->what, sizeof finding->what, "the results have no such run");
}

/* True when both ended well, so that their numbers can be compared. */
static bool judge_outcome(const pl_gate_row *before, const pl_gate_row *now, pl_gate_report *report)
{
    report->comparisons++;
    if (strcmp(before->outcome, now->outcome) == 0) {
        return pl_gate_row_is_ok(now);
    }
    bool is_better = pl_gate_row_is_ok(now);
    pl_gate_finding *finding = pl_gate_report_add(report, !is_better, now, "outcome");
    snprintf(finding->before, sizeof finding->before, "%.90s", before->outcome);
    snprintf(finding->after, sizeof finding->after, "%.90s", now->outcome);
    snprintf(finding->limit, sizeof finding->limit, "the same outcome");
    snprintf(finding->what, sizeof finding->what, "%.250s",
             is_better             ? "better: --update-baseline tightens the baseline"
             : now->reason[0] != 0 ? now->reason
                                   : "another outcome");
    return false;
}

static pl_status judge_row(const pl_gate_case *c, const pl_gate_row *before, const pl_gate_row *now,
                           pl_gate_report *report, pl_error *error)
{
    const char *hash = json_string_value(json_object_get(before->json, "scene_hash"));
    const char *new_hash = json_string_value(json_object_get(now->json, "scene_hash"));
    if (hash != NULL && new_hash != NULL && strcmp(hash, new_hash) != 0) {
        pl_gate_finding *finding = pl_gate_report_add(report, false, now, "scene_hash");
        snprintf(finding->before, sizeof finding->before, "%.90s", hash);
        snprintf(finding->after, sizeof finding->after, "%.90s", new_hash);
        snprintf(finding->what, sizeof finding->what, "the scene is another one");
    }
    if (!judge_outcome(before, now, report)) {
        return PL_OK;
    }
    pl_gate_judge_metrics(c, before, now, report);
    return pl_gate_judge_costs(c, before, now, report, error);
}

static pl_status judge_baseline(const pl_gate_case *c, pl_gate_report *report, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < c->before->count && status == PL_OK; ++i) {
        const pl_gate_row *before = &c->before->items[i];
        const pl_gate_row *now = pl_gate_rows_find(c->now, before->key);
        if (now == NULL) {
            judge_missing(before, report);
        } else {
            status = judge_row(c, before, now, report, error);
        }
    }
    for (int i = 0; i < c->now->count; ++i) {
        const pl_gate_row *now = &c->now->items[i];
        if (pl_gate_rows_find(c->before, now->key) == NULL) {
            pl_gate_finding *finding = pl_gate_report_add(report, false, now, "outcome");
            snprintf(finding->before, sizeof finding->before, "none");
            snprintf(finding->after, sizeof finding->after, "%.90s", now->outcome);
            snprintf(finding->what, sizeof finding->what,
                     "not in the baseline: --update-baseline takes it in");
        }
    }
    return status;
}

pl_status pl_gate_judge(const pl_gate_case *c, pl_gate_report *report, pl_error *error)
{
    *report = (pl_gate_report){.before = c->before, .now = c->now};
    pl_status status = c->before == NULL ? PL_OK : judge_baseline(c, report, error);
    if (status == PL_OK) {
        status = pl_gate_judge_rules(c, report, error);
    }
    pl_gate_report_order(report);
    return status == PL_OK && report->failed ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                                             : status;
}
