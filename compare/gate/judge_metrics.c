/* What every run of a deterministic engine repeats: metric by metric, against its limit. */
#include "judge.h"
#include "ratio.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *pl_gate_unit(const char *metric)
{
    int id = pl_metric_by_name(metric);
    bool own = id == PL_METRIC_REFERENCE_ERROR || id == PL_METRIC_RESIDUAL_MAX ||
               id == PL_METRIC_RESIDUAL_RMS;
    return id < 0 || own || strcmp(pl_metric_table[id].unit, "1") == 0 ? ""
                                                                       : pl_metric_table[id].unit;
}

static void tell_value(const json_t *value, char text[96])
{
    if (json_is_string(value)) {
        snprintf(text, 96, "%.90s", json_string_value(value));
    } else if (json_is_number(value)) {
        snprintf(text, 96, "%.6g", json_number_value(value));
    } else {
        snprintf(text, 96, "%s", value == NULL ? "absent" : "no value");
    }
}

/* One of the two is no number. */
static void judge_others(const pl_gate_case *c, const pl_gate_row *row, const char *metric,
                         const json_t *before, const json_t *now, pl_gate_report *report)
{
    int id = pl_metric_by_name(metric);
    report->comparisons++;
    if (now != NULL && json_equal(before, now)) {
        return;
    }
    if (id == PL_METRIC_STATE_HASH && !c->limits->of[id].given) {
        pl_gate_report_count(report, "state_hash", "other bits");
        return;
    }
    bool gained = json_is_null(before) && json_is_number(now);
    pl_gate_finding *finding = pl_gate_report_add(report, !gained, row, metric);
    tell_value(before, finding->before);
    tell_value(now, finding->after);
    snprintf(finding->limit, sizeof finding->limit, gained ? "" : "the same");
    const char *reason = pl_json_get_text(row->reasons, metric);
    snprintf(finding->what, sizeof finding->what, "%.250s",
             gained                                ? "has a value now"
             : now == NULL                         ? "the metric is gone"
             : json_is_null(now) && reason[0] != 0 ? reason
                                                   : "changed");
}

/* Of repeats that differ, the one that is farthest on the wrong side. */
static double worst_of(const pl_gate_row *row, const char *metric, pl_direction direction,
                       double before, double now)
{
    const json_t *range = json_object_get(row->spread, metric);
    if (range == NULL) {
        return now;
    }
    double least = json_number_value(json_array_get(range, 0));
    double largest = json_number_value(json_array_get(range, 1));
    if (direction == PL_NO_DIRECTION) {
        return fabs(least - before) > fabs(largest - before) ? least : largest;
    }
    return direction == PL_LOWER_IS_BETTER ? largest : least;
}

static void tell_change(double before, double now, const char *word, pl_gate_finding *finding)
{
    double part = fabs(now - before) / fabs(before);
    if (!isfinite(part)) {
        snprintf(finding->what, sizeof finding->what, "%s", word);
    } else if (part < 10) {
        snprintf(finding->what, sizeof finding->what, "%s by %.3g %%", word, 100 * part);
    } else {
        snprintf(finding->what, sizeof finding->what, "%s, %.3g times", word, now / before);
    }
}

static void judge_number(const pl_gate_case *c, const pl_gate_row *row, const char *metric,
                         double before, double median, pl_gate_report *report)
{
    static const pl_gate_limit unknown = {.relative = 1e-6, .absolute = 1e-9};
    int id = pl_metric_by_name(metric);
    pl_direction direction = id < 0 ? PL_NO_DIRECTION : pl_metric_table[id].direction;
    double dt = json_number_value(json_object_get(row->json, "dt"));
    double limit = pl_gate_limit_at(id < 0 ? &unknown : &c->limits->of[id], id, before, dt);
    double now = worst_of(row, metric, direction, before, median);
    report->comparisons++;
    if (json_object_get(row->spread, metric) != NULL) {
        pl_gate_report_count(report, metric, "repeats differ, and the worst of them counts");
    }
    if (fabs(now - before) <= limit) {
        return;
    }
    bool grew = now > before;
    bool is_better = direction != PL_NO_DIRECTION && grew == (direction == PL_HIGHER_IS_BETTER);
    pl_gate_finding *finding = pl_gate_report_add(report, !is_better, row, metric);
    const char *unit = pl_gate_unit(metric);
    pl_gate_number_texts(finding, before, now, unit);
    snprintf(finding->limit, sizeof finding->limit, "a difference of %.3g%s%.40s", limit,
             unit[0] == '\0' ? "" : " ", unit);
    tell_change(before, now,
                is_better                      ? "better"
                : direction == PL_NO_DIRECTION ? "changed"
                                               : "worse",
                finding);
    if (is_better) {
        size_t length = strlen(finding->what);
        snprintf(finding->what + length, sizeof finding->what - length,
                 ": --update-baseline tightens the baseline");
    }
}

void pl_gate_judge_metrics(const pl_gate_case *c, const pl_gate_row *before, const pl_gate_row *now,
                           pl_gate_report *report)
{
    const char *metric;
    json_t *value;
    json_object_foreach((json_t *)before->metrics, metric, value)
    {
        int id = pl_metric_by_name(metric);
        const json_t *found = json_object_get(now->metrics, metric);
        if (id >= 0 && c->limits->of[id].off) {
            continue;
        }
        if (found == NULL && json_object_get(now->measured, metric) != NULL) {
            pl_gate_report_count(report, metric, "is compared only with --tolerance");
        } else if (json_is_number(value) && json_is_number(found)) {
            judge_number(c, now, metric, json_number_value(value), json_number_value(found),
                         report);
        } else {
            judge_others(c, now, metric, value, found, report);
        }
    }
    json_object_foreach((json_t *)now->metrics, metric, value)
    {
        int id = pl_metric_by_name(metric);
        bool is_off = id >= 0 && c->limits->of[id].off;
        if (!is_off && json_object_get(before->metrics, metric) == NULL) {
            pl_gate_report_count(report, metric, "the baseline has no such metric");
        }
    }
}
