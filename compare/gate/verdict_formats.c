/* The formats of failures and notices: text, GitHub's workflow commands and job page, JUnit's XML, and
 * plumb.gate/1. */
#include "gate.h"

#include "base/heap.h"
#include "base/table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLACE_SIZE = 512, WORDS_SIZE = 1024 };

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

void pl_gate_verdict_summary(const pl_gate_verdict *verdict, char *text, size_t size)
{
    char tail[128], result[64] = "passed:";
    snprintf(tail, sizeof tail, "%d row%s, %d notice%s", verdict->now->count,
             plural(verdict->now->count), verdict->notices, plural(verdict->notices));
    if (verdict->failures > 0) {
        snprintf(result, sizeof result, "failed: %d failure%s in", verdict->failures,
                 plural(verdict->failures));
    } else if (verdict->comparisons == 0) {
        snprintf(text, size, "gate: nothing was compared, %s", tail);
        return;
    }
    snprintf(text, size, "gate %s %d comparison%s of %s", result, verdict->comparisons,
             plural(verdict->comparisons), tail);
}

/* ---- Text ---- */

/* "tower n=10 / ode:quick", or how many rows it is of. */
static void place_text(const pl_gate_entry *entry, char text[PLACE_SIZE])
{
    if (entry->row != NULL) {
        snprintf(text, PLACE_SIZE, "%s / %s", entry->row->name, entry->row->label);
    } else if (entry->row_count > 0) {
        snprintf(text, PLACE_SIZE, "%d row%s", entry->row_count, plural(entry->row_count));
    } else {
        snprintf(text, PLACE_SIZE, "no row");
    }
}

/* Everything except the place and the metric: "1.000 m -> 1.010 m, allowed: ... (worse by 1 %)". */
static void words_text(const pl_gate_entry *entry, char text[WORDS_SIZE])
{
    bool has_before = entry->before[0] != '\0', has_after = entry->after[0] != '\0';
    bool has_values = has_before || has_after, has_limit = entry->allowed[0] != '\0';
    bool bare = !has_values && !has_limit;
    snprintf(text, WORDS_SIZE, "%s%s%s%s%s%s%s%s%s", entry->before,
             has_before && has_after ? " -> " : "", entry->after,
             has_values && has_limit ? ", " : "", has_limit ? "allowed: " : "", entry->allowed,
             bare ? "" : " (", entry->what, bare ? "" : ")");
}

static void add_plain(pl_text_buffer *out, const char *text, bool is_property)
{
    (void)is_property;
    pl_text_add_plain(out, text, strlen(text));
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

static const line_style text_style = {"FAIL  ", "note  ", ": ", add_plain};
static const line_style github_style = {"::error title=", "::notice title=", "::", add_escaped};

/* Writes a line for each entry, and the summary. */
static void write_lines(const pl_gate_verdict *verdict, const line_style *style,
                        pl_text_buffer *out)
{
    char place[PLACE_SIZE], words[WORDS_SIZE];
    for (int i = 0; i < verdict->count; ++i) {
        const pl_gate_entry *entry = &verdict->items[i];
        place_text(entry, place);
        words_text(entry, words);
        pl_text_add(out, entry->is_failure ? style->failure : style->note);
        style->add(out, place, true);
        pl_text_format(out, "%s%s: ", style->after_place, entry->metric);
        style->add(out, words, false);
        pl_text_add(out, "\n");
    }
    pl_gate_verdict_summary(verdict, words, sizeof words);
    pl_text_format(out, "%s\n", words);
}

void pl_gate_write_markdown(const pl_gate_verdict *verdict, pl_text_buffer *out)
{
    char summary[WORDS_SIZE], place[PLACE_SIZE];
    pl_gate_verdict_summary(verdict, summary, sizeof summary);
    pl_text_add(out, "### plumb ");
    pl_text_add_markdown(out, summary);
    pl_text_add(out, "\n");
    pl_table table = {0};
    pl_table_columns(&table, "|run|metric|>before|>after|allowed|");
    for (int i = 0; i < verdict->count; ++i) {
        const pl_gate_entry *entry = &verdict->items[i];
        const char *const cells[] = {place,        entry->metric,  entry->before,
                                     entry->after, entry->allowed, entry->what};
        place_text(entry, place);
        pl_table_add_markup(&table, entry->is_failure ? "**failed**" : "note");
        for (size_t k = 0; k < sizeof cells / sizeof cells[0]; ++k) {
            pl_table_add(&table, cells[k]);
        }
    }
    pl_text_add(out, verdict->count > 0 ? "\n" : "");
    pl_table_write(&table, PL_TABLE_MARKDOWN, out);
    pl_text_add(out, "\n");
    pl_table_free(&table);
}

/* ---- JUnit ---- */

/* The test cases, and how many there are. */
typedef struct junit {
    const pl_gate_verdict *verdict;
    pl_text_buffer cases;
    int count, failed;
} junit;

/* Adds the failures of a row, or its notices; where `row` is NULL, those of no single row. Returns their number. */
static int add_entries(const pl_gate_verdict *verdict, const pl_gate_row *row, bool is_failure,
                       pl_text_buffer *text)
{
    char place[PLACE_SIZE], words[WORDS_SIZE];
    int count = 0;
    for (int i = 0; i < verdict->count; ++i) {
        const pl_gate_entry *entry = &verdict->items[i];
        if (entry->row == row && entry->is_failure == is_failure) {
            place_text(entry, place);
            words_text(entry, words);
            pl_text_add_html(text, place);
            pl_text_format(text, ": %s: ", entry->metric);
            pl_text_add_html(text, words);
            pl_text_add(text, "\n");
            ++count;
        }
    }
    return count;
}

/* Adds the test case of a row; where `row` is NULL, that of the entries of no single row, if there are any. */
static void add_case(junit *j, const pl_gate_row *row)
{
    pl_text_buffer failures = {0}, notices = {0};
    const int failure_count = add_entries(j->verdict, row, true, &failures);
    const int notice_count = add_entries(j->verdict, row, false, &notices);
    if (row != NULL || failure_count + notice_count > 0) {
        pl_text_add_element(&j->cases, "  <testcase classname=\"plumb.",
                            row == NULL ? "gate" : row->name, "\"");
        pl_text_add_element(&j->cases, " name=\"", row == NULL ? "rules and notices" : row->label,
                            "\">");
        if (failure_count > 0) {
            pl_text_format(&j->cases, "\n    <failure message=\"%d failure%s\">%s</failure>",
                           failure_count, plural(failure_count), failures.data);
        }
        if (notice_count > 0) {
            pl_text_format(&j->cases, "\n    <system-out>%s</system-out>", notices.data);
        }
        pl_text_add(&j->cases, "</testcase>\n");
        ++j->count;
        j->failed += failure_count > 0;
    }
    pl_text_free(&failures);
    pl_text_free(&notices);
}

static void write_junit(const pl_gate_verdict *verdict, pl_text_buffer *text)
{
    junit j = {.verdict = verdict};
    for (int i = 0; i < verdict->now->count; ++i) {
        add_case(&j, &verdict->now->items[i]);
    }
    for (int i = 0; verdict->before != NULL && i < verdict->before->count; ++i) {
        if (pl_gate_rows_find(verdict->now, verdict->before->items[i].key) == NULL) {
            add_case(&j, &verdict->before->items[i]);
        }
    }
    add_case(&j, NULL);
    pl_text_format(text,
                   "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                   "<testsuites>\n<testsuite name=\"plumb gate\" tests=\"%d\" failures=\"%d\" "
                   "errors=\"0\" skipped=\"0\">\n%s</testsuite>\n</testsuites>\n",
                   j.count, j.failed, j.cases.data == NULL ? "" : j.cases.data);
    pl_text_free(&j.cases);
}

/* ---- JSON ---- */

static json_t *text_or_null(const char *text)
{
    return text[0] == '\0' ? json_null() : pl_json_text(text);
}

static json_t *entry_json(const pl_gate_entry *entry)
{
    json_t *json =
        json_pack("{s:s, s:o, s:o, s:o, s:o}", "metric", entry->metric, "before",
                  text_or_null(entry->before), "after", text_or_null(entry->after), "allowed",
                  text_or_null(entry->allowed), "what", text_or_null(entry->what));
    static const char *const keys[] = {"scenario", "params", "engine", "dt",
                                       "duration", "seed",   "member"};
    if (entry->row == NULL) {
        json_object_set_new(json, "rows", json_integer(entry->row_count));
    }
    for (size_t i = 0; entry->row != NULL && i < sizeof keys / sizeof keys[0]; ++i) {
        json_object_set(json, keys[i], json_object_get(entry->row->json, keys[i]));
    }
    return json;
}

static json_t *entries_json(const pl_gate_verdict *verdict, bool is_failure)
{
    json_t *array = json_array();
    for (int i = 0; i < verdict->count; ++i) {
        if (verdict->items[i].is_failure == is_failure) {
            json_array_append_new(array, entry_json(&verdict->items[i]));
        }
    }
    return array;
}

static void write_json(const pl_gate_verdict *verdict, pl_text_buffer *buffer)
{
    const char *word = verdict->failures > 0       ? "failed"
                       : verdict->comparisons == 0 ? "nothing compared"
                                                   : "passed";
    json_t *json =
        json_pack("{s:s, s:s, s:i, s:i, s:o, s:o}", "schema", "plumb.gate/1", "verdict", word,
                  "rows", verdict->now->count, "comparisons", verdict->comparisons, "failures",
                  entries_json(verdict, true), "notices", entries_json(verdict, false));
    char *text = pl_heap_json(json, JSON_INDENT(1));
    pl_text_format(buffer, "%s\n", text);
    free(text);
    json_decref(json);
}

void pl_gate_write(pl_gate_format format, const pl_gate_verdict *verdict, pl_text_buffer *out)
{
    switch (format) {
    case PL_GATE_JUNIT:
        write_junit(verdict, out);
        break;
    case PL_GATE_GITHUB:
        write_lines(verdict, &github_style, out);
        break;
    case PL_GATE_JSON:
        write_json(verdict, out);
        break;
    default:
        write_lines(verdict, &text_style, out);
    }
}
