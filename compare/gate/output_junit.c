/* JUnit's XML, as CI servers read it. */
#include "gate/output.h"

#include <stdio.h>

enum { WORDS_SIZE = 1024 };

/* Findings of a case: those of the row, of no single row where `row` is NULL. */
static int count_of(const pl_gate_report *report, const pl_gate_row *row, bool is_failure)
{
    int count = 0;
    for (int i = 0; i < report->count; ++i) {
        count += report->items[i].row == row && report->items[i].is_failure == is_failure;
    }
    return count;
}

static void add_findings(const pl_gate_report *report, const pl_gate_row *row, bool is_failure,
                         pl_sheet *sheet)
{
    char place[WORDS_SIZE], words[WORDS_SIZE];
    for (int i = 0; i < report->count; ++i) {
        const pl_gate_finding *finding = &report->items[i];
        if (finding->row == row && finding->is_failure == is_failure) {
            pl_gate_finding_place(finding, place, sizeof place);
            pl_gate_finding_words(finding, words, sizeof words);
            pl_sheet_add_html(sheet, place);
            pl_sheet_format(sheet, ": %s: ", finding->metric);
            pl_sheet_add_html(sheet, words);
            pl_sheet_add(sheet, "\n");
        }
    }
}

/* `row` is NULL for what is of no single row. */
static void add_case(const pl_gate_report *report, const pl_gate_row *row, pl_sheet *sheet)
{
    int failures = count_of(report, row, true), notices = count_of(report, row, false);
    pl_sheet_add_element(sheet, "  <testcase classname=\"plumb.", row == NULL ? "gate" : row->name,
                         "\"");
    pl_sheet_add_element(sheet, " name=\"", row == NULL ? "rules and notices" : row->label, "\">");
    if (failures > 0) {
        pl_sheet_format(sheet, "\n    <failure message=\"%d failure%s\">", failures,
                        failures == 1 ? "" : "s");
        add_findings(report, row, true, sheet);
        pl_sheet_add(sheet, "</failure>");
    }
    if (notices > 0) {
        pl_sheet_add(sheet, "\n    <system-out>");
        add_findings(report, row, false, sheet);
        pl_sheet_add(sheet, "</system-out>");
    }
    pl_sheet_add(sheet, "</testcase>\n");
}

static bool is_missing(const pl_gate_report *report, int index)
{
    return pl_gate_rows_find(report->now, report->before->items[index].key) == NULL;
}

void pl_gate_write_junit(const pl_gate_report *report, pl_sheet *sheet)
{
    bool has_others = count_of(report, NULL, true) + count_of(report, NULL, false) > 0;
    int cases = report->now->count + has_others;
    int failed = count_of(report, NULL, true) > 0;
    for (int i = 0; i < report->now->count; ++i) {
        failed += count_of(report, &report->now->items[i], true) > 0;
    }
    for (int i = 0; report->before != NULL && i < report->before->count; ++i) {
        cases += is_missing(report, i);
        failed += is_missing(report, i);
    }
    pl_sheet_format(sheet,
                    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                    "<testsuites>\n<testsuite name=\"plumb gate\" tests=\"%d\" failures=\"%d\" "
                    "errors=\"0\" skipped=\"0\">\n",
                    cases, failed);
    for (int i = 0; i < report->now->count; ++i) {
        add_case(report, &report->now->items[i], sheet);
    }
    for (int i = 0; report->before != NULL && i < report->before->count; ++i) {
        if (is_missing(report, i)) {
            add_case(report, &report->before->items[i], sheet);
        }
    }
    if (has_others) {
        add_case(report, NULL, sheet);
    }
    pl_sheet_add(sheet, "</testsuite>\n</testsuites>\n");
}
