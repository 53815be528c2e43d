/* JUnit's XML, as CI servers read it. */
#include "output.h"

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
                         pl_text_buffer *text)
{
    char place[WORDS_SIZE], words[WORDS_SIZE];
    for (int i = 0; i < report->count; ++i) {
        const pl_gate_finding *finding = &report->items[i];
        if (finding->row == row && finding->is_failure == is_failure) {
            pl_gate_finding_place(finding, place, sizeof place);
            pl_gate_finding_words(finding, words, sizeof words);
            pl_text_add_html(text, place);
            pl_text_format(text, ": %s: ", finding->metric);
            pl_text_add_html(text, words);
            pl_text_add(text, "\n");
        }
    }
}

/* `row` is NULL for what is of no single row. */
static void add_case(const pl_gate_report *report, const pl_gate_row *row, pl_text_buffer *text)
{
    int failures = count_of(report, row, true), notices = count_of(report, row, false);
    pl_text_add_element(text, "  <testcase classname=\"plumb.", row == NULL ? "gate" : row->name,
                        "\"");
    pl_text_add_element(text, " name=\"", row == NULL ? "rules and notices" : row->label, "\">");
    if (failures > 0) {
        pl_text_format(text, "\n    <failure message=\"%d failure%s\">", failures,
                       failures == 1 ? "" : "s");
        add_findings(report, row, true, text);
        pl_text_add(text, "</failure>");
    }
    if (notices > 0) {
        pl_text_add(text, "\n    <system-out>");
        add_findings(report, row, false, text);
        pl_text_add(text, "</system-out>");
    }
    pl_text_add(text, "</testcase>\n");
}

static bool is_missing(const pl_gate_report *report, int index)
{
    return pl_gate_rows_find(report->now, report->before->items[index].key) == NULL;
}

void pl_gate_write_junit(const pl_gate_report *report, pl_text_buffer *text)
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
    pl_text_format(text,
                   "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                   "<testsuites>\n<testsuite name=\"plumb gate\" tests=\"%d\" failures=\"%d\" "
                   "errors=\"0\" skipped=\"0\">\n",
                   cases, failed);
    for (int i = 0; i < report->now->count; ++i) {
        add_case(report, &report->now->items[i], text);
    }
    for (int i = 0; report->before != NULL && i < report->before->count; ++i) {
        if (is_missing(report, i)) {
            add_case(report, &report->before->items[i], text);
        }
    }
    if (has_others) {
        add_case(report, NULL, text);
    }
    pl_text_add(text, "</testsuite>\n</testsuites>\n");
}
