/* The list of findings. */
#include "gate_report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

pl_gate_finding *pl_gate_report_add(pl_gate_report *report, bool is_failure, const pl_gate_row *row,
                                    const char *metric)
{
    static _Thread_local pl_gate_finding lost;
    pl_gate_finding *finding = &lost;
    if (report->count == report->capacity) {
        int capacity = 2 * report->capacity + 16;
        pl_gate_finding *grown = realloc(report->items, (size_t)capacity * sizeof *grown);
        report->failed |= grown == NULL;
        report->items = grown == NULL ? report->items : grown;
        report->capacity = grown == NULL ? report->capacity : capacity;
    }
    if (report->count < report->capacity) {
        finding = &report->items[report->count++];
        report->failures += is_failure;
        report->notices += !is_failure;
    }
    *finding = (pl_gate_finding){.is_failure = is_failure, .row = row, .metric = metric};
    return finding;
}

void pl_gate_report_count(pl_gate_report *report, const char *metric, const char *what)
{
    for (int i = 0; i < report->count; ++i) {
        pl_gate_finding *known = &report->items[i];
        if (known->row_count > 0 && strcmp(known->metric, metric) == 0 &&
            strcmp(known->what, what) == 0) {
            known->row_count++;
            return;
        }
    }
    pl_gate_finding *finding = pl_gate_report_add(report, false, NULL, metric);
    snprintf(finding->what, sizeof finding->what, "%s", what);
    finding->row_count = 1;
}

/* Keeps the order of each part. */
void pl_gate_report_order(pl_gate_report *report)
{
    pl_gate_finding *ordered = calloc((size_t)report->count + 1, sizeof *ordered);
    if (ordered == NULL) {
        report->failed = true;
        return;
    }
    int filled = 0;
    for (int several = 0; several < 2; ++several) {
        for (int i = 0; i < report->count; ++i) {
            if ((report->items[i].row_count > 0) == (several == 1)) {
                ordered[filled++] = report->items[i];
            }
        }
    }
    free(report->items);
    report->items = ordered;
    report->capacity = report->count + 1;
}

void pl_gate_number_texts(pl_gate_finding *finding, double before, double after, const char *unit)
{
    bool bare = unit[0] == '\0';
    static const int digits[] = {4, 6, 17};
    for (size_t i = 0; i < sizeof digits / sizeof digits[0]; ++i) {
        snprintf(finding->before, sizeof finding->before, "%.*g%s%.40s", digits[i], before,
                 bare ? "" : " ", bare ? "" : unit);
        snprintf(finding->after, sizeof finding->after, "%.*g%s%.40s", digits[i], after,
                 bare ? "" : " ", bare ? "" : unit);
        if (before == after || strcmp(finding->before, finding->after) != 0) {
            return;
        }
    }
}

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

void pl_gate_report_summary(const pl_gate_report *report, char *text, size_t size)
{
    char result[64];
    if (report->failures > 0) {
        snprintf(result, sizeof result, "failed: %d failure%s in", report->failures,
                 plural(report->failures));
    } else {
        snprintf(result, sizeof result, "passed:");
    }
    if (report->failures == 0 && report->comparisons == 0) {
        snprintf(text, size, "gate: nothing was compared, %d row%s, %d notice%s",
                 report->now->count, plural(report->now->count), report->notices,
                 plural(report->notices));
        return;
    }
    snprintf(text, size, "gate %s %d comparison%s of %d row%s, %d notice%s", result,
             report->comparisons, plural(report->comparisons), report->now->count,
             plural(report->now->count), report->notices, plural(report->notices));
}

void pl_gate_report_free(pl_gate_report *report)
{
    free(report->items);
    *report = (pl_gate_report){0};
}
