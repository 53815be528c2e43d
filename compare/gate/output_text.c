/* For people: the text, GitHub's workflow commands, and its job page. */
#include "output.h"

#include <limits.h>
#include <stdio.h>

enum { PLACE_SIZE = 512, WORDS_SIZE = 1024 };

static void add_plain(pl_text_buffer *out, const char *text, bool is_property)
{
    (void)is_property;
    pl_text_add_plain(out, text, INT_MAX);
}

/* A workflow command ends at a line's end, and its properties at a comma or a colon. */
static void add_escaped(pl_text_buffer *out, const char *text, bool is_property)
{
    for (const char *c = text; *c != '\0'; ++c) {
        unsigned char byte = (unsigned char)*c;
        bool escaped = byte == '%' || byte < 0x20 || byte == 0x7f ||
                       (is_property && (byte == ':' || byte == ','));
        pl_text_format(out, escaped ? "%%%02X" : "%c", byte);
    }
}

/* How a line is written. */
typedef struct line_style {
    const char *failure, *note, *after_place;
    void (*add)(pl_text_buffer *out, const char *text, bool is_property);
} line_style;

/* A line a finding, failures first, and the summary. */
static void write_lines(const pl_gate_report *report, const line_style *style, pl_text_buffer *out)
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
            pl_text_add(out, finding->is_failure ? style->failure : style->note);
            style->add(out, place, true);
            pl_text_format(out, "%s%s: ", style->after_place, finding->metric);
            style->add(out, words, false);
            pl_text_add(out, "\n");
        }
    }
    pl_gate_report_summary(report, words, sizeof words);
    pl_text_format(out, "%s\n", words);
}

void pl_gate_write_text(const pl_gate_report *report, pl_text_buffer *out)
{
    const line_style style = {"FAIL  ", "note  ", ": ", add_plain};
    write_lines(report, &style, out);
}

void pl_gate_write_github(const pl_gate_report *report, pl_text_buffer *out)
{
    const line_style style = {"::error title=", "::notice title=", "::", add_escaped};
    write_lines(report, &style, out);
}

static void add_cell(pl_text_buffer *out, const char *text)
{
    pl_text_add(out, " ");
    pl_text_add_markdown(out, text);
    pl_text_add(out, " |");
}

void pl_gate_write_markdown(const pl_gate_report *report, pl_text_buffer *out)
{
    char text[WORDS_SIZE];
    pl_gate_report_summary(report, text, sizeof text);
    pl_text_add(out, "### plumb ");
    pl_text_add_markdown(out, text);
    pl_text_add(out, "\n");
    if (report->count > 0) {
        pl_text_add(out, "\n| | run | metric | before | after | allowed | |\n"
                         "|---|---|---|---:|---:|---|---|\n");
    }
    for (int failures = 1; failures >= 0; --failures) {
        for (int i = 0; i < report->count; ++i) {
            const pl_gate_finding *finding = &report->items[i];
            if (finding->is_failure != (failures == 1)) {
                continue;
            }
            pl_gate_finding_place(finding, text, sizeof text);
            pl_text_add(out, finding->is_failure ? "| **failed** |" : "| note |");
            add_cell(out, text);
            add_cell(out, finding->metric);
            add_cell(out, finding->before);
            add_cell(out, finding->after);
            add_cell(out, finding->limit);
            add_cell(out, finding->what);
            pl_text_add(out, "\n");
        }
    }
    pl_text_add(out, "\n");
}
