/* For people: the text, GitHub's workflow commands, and its job page. */
#include "gate/output.h"

#include <limits.h>
#include <stdio.h>

enum { PLACE_SIZE = 512, WORDS_SIZE = 1024 };

static void add_plain(pl_sheet *sheet, const char *text, bool is_property)
{
    (void)is_property;
    pl_sheet_add_plain(sheet, text, INT_MAX);
}

/* A workflow command ends at a line's end, and its properties at a comma or a colon. */
static void add_escaped(pl_sheet *sheet, const char *text, bool is_property)
{
    for (const char *c = text; *c != '\0'; ++c) {
        unsigned char byte = (unsigned char)*c;
        bool escaped = byte == '%' || byte < 0x20 || byte == 0x7f ||
                       (is_property && (byte == ':' || byte == ','));
        pl_sheet_format(sheet, escaped ? "%%%02X" : "%c", byte);
    }
}

/* How a line is written. */
typedef struct line_style {
    const char *failure, *note, *after_place;
    void (*add)(pl_sheet *sheet, const char *text, bool is_property);
} line_style;

/* A line a finding, failures first, and the summary. */
static void write_lines(const pl_gate_report *report, const line_style *style, pl_sheet *sheet)
{
    char place[PLACE_SIZE], words[WORDS_SIZE];
    for (int failures = 1; failures >= 0; --failures) {
        for (int i = 0; i < report->count; ++i) {
            const pl_gate_finding *finding = &report->items[i];
            if (finding->is_failure != (failures == 1)) {
                continue;
            }
            pl_gate_finding_place(finding, place, sizeof place);
            pl_gate_finding_words(finding, words, sizeof words);
            pl_sheet_add(sheet, finding->is_failure ? style->failure : style->note);
            style->add(sheet, place, true);
            pl_sheet_format(sheet, "%s%s: ", style->after_place, finding->metric);
            style->add(sheet, words, false);
            pl_sheet_add(sheet, "\n");
        }
    }
    pl_gate_report_summary(report, words, sizeof words);
    pl_sheet_format(sheet, "%s\n", words);
}

void pl_gate_write_text(const pl_gate_report *report, pl_sheet *sheet)
{
    const line_style style = {"FAIL  ", "note  ", ": ", add_plain};
    write_lines(report, &style, sheet);
}

void pl_gate_write_github(const pl_gate_report *report, pl_sheet *sheet)
{
    const line_style style = {"::error title=", "::notice title=", "::", add_escaped};
    write_lines(report, &style, sheet);
}

static void add_cell(pl_sheet *sheet, const char *text)
{
    pl_sheet_add(sheet, " ");
    pl_sheet_add_markdown(sheet, text);
    pl_sheet_add(sheet, " |");
}

void pl_gate_write_markdown(const pl_gate_report *report, pl_sheet *sheet)
{
    char text[WORDS_SIZE];
    pl_gate_report_summary(report, text, sizeof text);
    pl_sheet_add(sheet, "### plumb ");
    pl_sheet_add_markdown(sheet, text);
    pl_sheet_add(sheet, "\n");
    if (report->count > 0) {
        pl_sheet_add(sheet, "\n| | run | metric | before | after | allowed | |\n"
                            "|---|---|---|---:|---:|---|---|\n");
    }
    for (int failures = 1; failures >= 0; --failures) {
        for (int i = 0; i < report->count; ++i) {
            const pl_gate_finding *finding = &report->items[i];
            if (finding->is_failure != (failures == 1)) {
                continue;
            }
            pl_gate_finding_place(finding, text, sizeof text);
            pl_sheet_add(sheet, finding->is_failure ? "| **failed** |" : "| note |");
            add_cell(sheet, text);
            add_cell(sheet, finding->metric);
            add_cell(sheet, finding->before);
            add_cell(sheet, finding->after);
            add_cell(sheet, finding->limit);
            add_cell(sheet, finding->what);
            pl_sheet_add(sheet, "\n");
        }
    }
    pl_sheet_add(sheet, "\n");
}
