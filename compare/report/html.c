/* The report as one HTML page: its frame, what it says of all runs together, and the order of its
 * sections. */
#include "report/html.h"

#include "report/html_parts.h"
#include "report/html_problem.h"
#include "report/html_results.h"
#include "report/stepping.h"
#include "report/style.h"
#include "results/result.h"

#include <stdio.h>
#include <string.h>

enum { SHOWN_LOSSES = 20 };

/* --- Head --- */

/* A fact that may differ between rows: each value once, sorted. */
static void add_distinct(const pl_cells *cells, const char *name, const char *object,
                         const char *key, pl_sheet *sheet)
{
    enum { MOST = 16 };
    const char *seen[MOST];
    int count = 0;
    for (size_t i = 0; i < json_array_size(cells->results); i++) {
        const char *text = pl_row_text_in(json_array_get(cells->results, i), object, key);
        int place = 0;
        while (place < count && strcmp(seen[place], text) < 0)
            place++;
        if (text[0] == '\0' || count == MOST || (place < count && strcmp(seen[place], text) == 0))
            continue;
        memmove(&seen[place + 1], &seen[place], (size_t)(count - place) * sizeof seen[0]);
        seen[place] = text;
        count++;
    }
    if (count == 0)
        return;
    pl_sheet_add_element(sheet, "<dt>", name, "</dt><dd>");
    for (int i = 0; i < count; i++)
        pl_sheet_add_element(sheet, i == 0 ? "" : "; ", seen[i], "");
    pl_sheet_add(sheet, count == MOST ? " and perhaps more</dd>\n" : "</dd>\n");
}

static void add_command(const json_t *row, pl_sheet *sheet)
{
    const json_t *command = json_object_get(row, "command");
    if (json_array_size(command) == 0)
        return;
    pl_sheet_add(sheet, "<dt>Command</dt><dd><code>");
    for (size_t i = 0; i < json_array_size(command); i++) {
        const char *word = json_string_value(json_array_get(command, i));
        pl_sheet_add_element(sheet, i == 0 ? "" : " ", word == NULL ? "" : word, "");
    }
    pl_sheet_add(sheet, "</code></dd>\n");
}

static void add_dates(const pl_cells *cells, pl_sheet *sheet)
{
    const char *first = "", *last = "";
    for (size_t i = 0; i < json_array_size(cells->results); i++) {
        const char *started = pl_json_get_text(json_array_get(cells->results, i), "started");
        if (started[0] == '\0')
            continue;
        if (first[0] == '\0' || strcmp(started, first) < 0)
            first = started;
        if (strcmp(started, last) > 0)
            last = started;
    }
    if (first[0] == '\0')
        return;
    pl_sheet_add_element(sheet, "<dt>Started</dt><dd>", first, "");
    if (strcmp(first, last) != 0)
        pl_sheet_add_element(sheet, " to ", last, "");
    pl_sheet_add(sheet, " (UTC)</dd>\n");
}

static void add_head(const pl_cells *cells, pl_sheet *sheet)
{
    pl_sheet_add(sheet, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                        "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
                        "<title>Plumb report</title>\n<style>\n");
    for (int i = 0; pl_style[i] != NULL; i++)
        pl_sheet_format(sheet, "%s\n", pl_style[i]);
    pl_sheet_add(sheet, "</style>\n</head>\n<body>\n<main>\n<h1>Plumb report</h1>\n");
    pl_sheet_format(
        sheet,
        "<p class=\"lead\">How far each rigid-body engine is from the right answer, and at "
        "what cost: %d %s of %d %s on %d %s.</p>\n",
        cells->run_count, cells->run_count == 1 ? "run" : "runs", cells->block_count,
        cells->block_count == 1 ? "problem" : "problems", cells->column_count,
        cells->column_count == 1 ? "engine" : "engines");
    pl_sheet_add(sheet, "<dl class=\"facts\">\n");
    add_distinct(cells, "Processor", "host", "cpu", sheet);
    add_distinct(cells, "System", "host", "os", sheet);
    add_distinct(cells, "Compiler", "host", "compiler", sheet);
    add_distinct(cells, "Flags", "host", "flags", sheet);
    add_distinct(cells, "Plumb", "plumb", "version", sheet);
    add_distinct(cells, "Commit", "plumb", "git", sheet);
    add_dates(cells, sheet);
    if (cells->block_count > 0)
        add_command(cells->blocks[0].row, sheet);
    pl_sheet_add(sheet, "<dt>Engines</dt><dd>");
    for (int i = 0; i < cells->column_count; i++) {
        pl_sheet_add_element(sheet, i == 0 ? "" : ", ", cells->columns[i].label, " ");
        pl_sheet_add_html(sheet, cells->columns[i].version);
    }
    pl_sheet_add(sheet, "</dd>\n</dl>\n");
}

/* --- Losses --- */

static void add_loss_table(const pl_losses *losses, int first, int last, pl_sheet *sheet)
{
    pl_sheet_add(sheet,
                 "<div class=\"scroll\"><table>\n<thead><tr><th>Problem</th><th>Metric</th>"
                 "<th>Ours</th><th class=\"n\">value</th><th>Best other</th>"
                 "<th class=\"n\">value</th><th class=\"n\">Ratio</th></tr></thead>\n<tbody>\n");
    for (int i = first; i < last; i++) {
        const pl_loss *loss = &losses->items[i];
        char metric[PL_LOSS_TEXT_SIZE], ours[PL_LOSS_TEXT_SIZE], best[PL_LOSS_TEXT_SIZE];
        char ratio[PL_LOSS_TEXT_SIZE], note[PL_HTML_NOTE_SIZE];
        pl_loss_texts(loss, metric, ours, best, ratio);
        snprintf(note, sizeof note, "%.600s", loss->our_cell->reason);
        if (loss->kind != PL_LOSS_OUTCOME)
            pl_measure_note(&loss->our_cell->measure[loss->metric], note, sizeof note);
        pl_sheet_add_element(sheet, "<tr><th>", loss->block->name, "</th>");
        pl_sheet_add_element(sheet, "<td>", metric, "</td>");
        pl_sheet_add_element(sheet, "<td>", loss->ours->name, "</td>");
        pl_html_open_cell(sheet, loss->kind == PL_LOSS_OUTCOME ? "n bad" : "n", note);
        pl_sheet_add_element(sheet, "", ours, "</td>");
        pl_sheet_add_element(sheet, "<td>", loss->best->name, "</td>");
        pl_sheet_add_element(sheet, "<td class=\"n\">", best, "</td>");
        pl_sheet_add_element(sheet, "<td class=\"n\">", ratio, "</td></tr>\n");
    }
    pl_sheet_add(sheet, "</tbody></table></div>\n");
}

static void add_losses(const pl_losses *losses, pl_sheet *sheet)
{
    pl_sheet_add_element(sheet, "<h2 id=\"losses\">Where plumb loses</h2>\n<p class=\"verdict\">",
                         losses->statement.data, "</p>\n");
    int shown = losses->count < SHOWN_LOSSES ? losses->count : SHOWN_LOSSES;
    if (shown > 0)
        add_loss_table(losses, 0, shown, sheet);
    if (losses->count > shown) {
        pl_sheet_format(sheet, "<details><summary>%d more, with smaller ratios</summary>\n",
                        losses->count - shown);
        add_loss_table(losses, shown, losses->count, sheet);
        pl_sheet_add(sheet, "</details>\n");
    }
    pl_sheet_add_element(sheet, "<p class=\"note\">", losses->rule.data, "</p>\n");
}

/* --- Tail --- */

static void add_failures(const pl_cells *cells, pl_sheet *sheet)
{
    int b = 0, i = 0;
    pl_sheet_add(sheet, "<h2 id=\"failures\">Failed runs</h2>\n");
    if (!pl_cells_next_failure(cells, &b, &i)) {
        pl_sheet_add(sheet, "<p>No run failed.</p>\n");
        return;
    }
    pl_sheet_add(sheet, "<div class=\"scroll\"><table>\n<thead><tr><th>Problem</th><th>Engine</th>"
                        "<th>Outcome</th><th>Reason and output</th></tr></thead>\n<tbody>\n");
    for (; pl_cells_next_failure(cells, &b, &i); i++) {
        const pl_cell *cell = &cells->blocks[b].cells[i];
        const char *output = pl_json_get_text(cell->row, "output");
        pl_sheet_add_element(sheet, "<tr><th>", cells->blocks[b].name, "</th>");
        pl_sheet_add_element(sheet, "<td>", cells->columns[i].name, "</td><td>");
        pl_html_badge(cell, sheet);
        pl_sheet_add_element(sheet, "</td><td class=\"why\">",
                             cell->reason[0] != '\0' ? cell->reason : "no reason was recorded", "");
        if (output[0] != '\0')
            pl_sheet_add_element(sheet, "<pre>", output, "</pre>");
        pl_sheet_add(sheet, "</td></tr>\n");
    }
    pl_sheet_add(sheet, "</tbody></table></div>\n");
}

static void add_definitions(pl_sheet *sheet)
{
    static const char *const directions[] = {"lower is better", "higher is better", "no direction"};
    pl_sheet_add(sheet, "<h2 id=\"metrics\">Metrics</h2>\n<dl class=\"metrics\">\n");
    for (int id = 0; id < PL_METRIC_COUNT; id++) {
        const pl_metric_info *info = &pl_metric_table[id];
        pl_sheet_add_element(sheet, "<dt><code>", info->name, "</code> <span class=\"small\">");
        if (strcmp(info->unit, "1") != 0 && info->unit[0] != '\0')
            pl_sheet_add_element(sheet, "", info->unit, ", ");
        pl_sheet_add(sheet, directions[info->direction]);
        pl_sheet_add(sheet, info->deterministic ? "" : ", measured");
        pl_sheet_add_element(sheet, "</span></dt><dd>", info->definition, "</dd>\n");
    }
    pl_sheet_add(sheet, "</dl>\n");
}

static void add_method(pl_sheet *sheet)
{
    pl_sheet_add(
        sheet,
        "<h2 id=\"method\">How it was measured</h2>\n"
        "<p>Every run is a process of its own, with a limit of time and of memory. An engine that "
        "aborts, "
        "hangs or returns what is not a number is a row like any other, and what it printed is "
        "kept.</p>\n"
        "<p>No engine measures itself: positions, penetration and energy are worked out by the "
        "same code "
        "for all, from poses and velocities. Iterations, residual and contacts are what an engine "
        "reports "
        "of itself; they mean different things to different engines, and no best is marked among "
        "them.</p>\n"
        "<p>Time is the process's CPU time of the engine's step call alone. Over repeats, times "
        "and memory "
        "are medians (the tooltip has the range and the median absolute deviation, MAD); "
        "everything else "
        "must be the same in every repeat, and is marked “not deterministic” where it is not. "
        "Best values, in bold, are taken over runs that are ok; "
        "values that differ by less than noise (the rule below the losses) are best together.</p>\n"
        "<p>In the pictures a dashed outline is where a body belongs, a dotted one where it "
        "started, and a "
        "body drawn in red has fallen. All engines of a problem are drawn in the same view and "
        "scale. "
        "“–” means that there is no number; its tooltip says why.</p>\n");
}

void pl_html_write(const pl_cells *cells, const pl_losses *losses, const pl_faults *findings,
                   pl_sheet *sheet)
{
    add_head(cells, sheet);
    add_losses(losses, sheet);
    pl_warning warnings[PL_WARNINGS_MOST];
    int warning_count = pl_cells_warnings(cells, warnings);
    for (int i = 0; i < warning_count; i++) {
        pl_sheet_add_element(sheet, "<p class=\"warn\"><b>", warnings[i].head, "</b> ");
        pl_sheet_add_element(sheet, "", warnings[i].text, "</p>\n");
    }
    if (cells->block_count == 0) {
        pl_sheet_add(sheet, "<p>There are no results.</p>\n");
    } else {
        pl_html_results(cells, sheet);
        pl_faults_html(findings, sheet);
        pl_stepping_html(cells, sheet);
        pl_html_settings(cells, sheet);
        pl_sheet_add(sheet, "<h2 id=\"problems\">Problem by problem</h2>\n");
        for (int b = 0; b < cells->block_count; b++)
            pl_html_problem(cells, b, sheet);
        add_failures(cells, sheet);
    }
    add_definitions(sheet);
    add_method(sheet);
    pl_sheet_add(sheet, "</main>\n</body>\n</html>\n");
}
