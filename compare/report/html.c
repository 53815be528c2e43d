/* The report as one HTML page: its frame, what it says of all runs together, and the order of its
 * sections. */
#include "html.h"

#include "html_parts.h"
#include "html_problem.h"
#include "html_results.h"
#include "results/result.h"
#include "style.h"
#include "time_stepping.h"

#include <stdio.h>
#include <string.h>

enum { SHOWN_LOSSES = 20 };

/* --- Head --- */

/* A fact that may differ between rows: each value once, sorted. */
static void add_distinct(const pl_result_matrix *cells, const char *name, const char *object,
                         const char *key, pl_text_buffer *buffer)
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
    pl_text_add_element(buffer, "<dt>", name, "</dt><dd>");
    for (int i = 0; i < count; i++)
        pl_text_add_element(buffer, i == 0 ? "" : "; ", seen[i], "");
    pl_text_add(buffer, count == MOST ? " and perhaps more</dd>\n" : "</dd>\n");
}

static void add_command(const json_t *row, pl_text_buffer *buffer)
{
    const json_t *command = json_object_get(row, "command");
    if (json_array_size(command) == 0)
        return;
    pl_text_add(buffer, "<dt>Command</dt><dd><code>");
    for (size_t i = 0; i < json_array_size(command); i++) {
        const char *word = json_string_value(json_array_get(command, i));
        pl_text_add_element(buffer, i == 0 ? "" : " ", word == NULL ? "" : word, "");
    }
    pl_text_add(buffer, "</code></dd>\n");
}

static void add_dates(const pl_result_matrix *cells, pl_text_buffer *buffer)
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
    pl_text_add_element(buffer, "<dt>Started</dt><dd>", first, "");
    if (strcmp(first, last) != 0)
        pl_text_add_element(buffer, " to ", last, "");
    pl_text_add(buffer, " (UTC)</dd>\n");
}

static void add_head(const pl_result_matrix *cells, pl_text_buffer *buffer)
{
    pl_text_add(buffer, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                        "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
                        "<title>Plumb report</title>\n<style>\n");
    for (int i = 0; pl_style[i] != NULL; i++)
        pl_text_format(buffer, "%s\n", pl_style[i]);
    pl_text_add(buffer, "</style>\n</head>\n<body>\n<main>\n<h1>Plumb report</h1>\n");
    pl_text_format(
        buffer,
        "<p class=\"lead\">How far each rigid-body engine is from the right answer, and at "
        "what cost: %d %s of %d %s on %d %s.</p>\n",
        cells->run_count, cells->run_count == 1 ? "run" : "runs", cells->block_count,
        cells->block_count == 1 ? "problem" : "problems", cells->column_count,
        cells->column_count == 1 ? "engine" : "engines");
    pl_text_add(buffer, "<dl class=\"facts\">\n");
    add_distinct(cells, "Processor", "host", "cpu", buffer);
    add_distinct(cells, "System", "host", "os", buffer);
    add_distinct(cells, "Compiler", "host", "compiler", buffer);
    add_distinct(cells, "Flags", "host", "flags", buffer);
    add_distinct(cells, "Plumb", "plumb", "version", buffer);
    add_distinct(cells, "Commit", "plumb", "git", buffer);
    add_dates(cells, buffer);
    if (cells->block_count > 0)
        add_command(cells->blocks[0].row, buffer);
    pl_text_add(buffer, "<dt>Engines</dt><dd>");
    for (int i = 0; i < cells->column_count; i++) {
        pl_text_add_element(buffer, i == 0 ? "" : ", ", cells->columns[i].label, " ");
        pl_text_add_html(buffer, cells->columns[i].version);
    }
    pl_text_add(buffer, "</dd>\n</dl>\n");
}

/* --- Losses --- */

static void add_loss_table(const pl_losses *losses, int first, int last, pl_text_buffer *buffer)
{
    pl_text_add(buffer,
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
        pl_text_add_element(buffer, "<tr><th>", loss->block->name, "</th>");
        pl_text_add_element(buffer, "<td>", metric, "</td>");
        pl_text_add_element(buffer, "<td>", loss->ours->name, "</td>");
        pl_html_open_cell(buffer, loss->kind == PL_LOSS_OUTCOME ? "n bad" : "n", note);
        pl_text_add_element(buffer, "", ours, "</td>");
        pl_text_add_element(buffer, "<td>", loss->best->name, "</td>");
        pl_text_add_element(buffer, "<td class=\"n\">", best, "</td>");
        pl_text_add_element(buffer, "<td class=\"n\">", ratio, "</td></tr>\n");
    }
    pl_text_add(buffer, "</tbody></table></div>\n");
}

static void add_losses(const pl_losses *losses, pl_text_buffer *buffer)
{
    pl_text_add_element(buffer, "<h2 id=\"losses\">Where plumb loses</h2>\n<p class=\"verdict\">",
                        losses->statement.data, "</p>\n");
    int shown = losses->count < SHOWN_LOSSES ? losses->count : SHOWN_LOSSES;
    if (shown > 0)
        add_loss_table(losses, 0, shown, buffer);
    if (losses->count > shown) {
        pl_text_format(buffer, "<details><summary>%d more, with smaller ratios</summary>\n",
                       losses->count - shown);
        add_loss_table(losses, shown, losses->count, buffer);
        pl_text_add(buffer, "</details>\n");
    }
    pl_text_add_element(buffer, "<p class=\"note\">", losses->rule.data, "</p>\n");
}

/* --- Tail --- */

static void add_failures(const pl_result_matrix *cells, pl_text_buffer *buffer)
{
    int b = 0, i = 0;
    pl_text_add(buffer, "<h2 id=\"failures\">Failed runs</h2>\n");
    if (!pl_result_matrix_next_failure(cells, &b, &i)) {
        pl_text_add(buffer, "<p>No run failed.</p>\n");
        return;
    }
    pl_text_add(buffer, "<div class=\"scroll\"><table>\n<thead><tr><th>Problem</th><th>Engine</th>"
                        "<th>Outcome</th><th>Reason and output</th></tr></thead>\n<tbody>\n");
    for (; pl_result_matrix_next_failure(cells, &b, &i); i++) {
        const pl_cell *cell = &cells->blocks[b].cells[i];
        const char *output = pl_json_get_text(cell->row, "output");
        pl_text_add_element(buffer, "<tr><th>", cells->blocks[b].name, "</th>");
        pl_text_add_element(buffer, "<td>", cells->columns[i].name, "</td><td>");
        pl_html_badge(cell, buffer);
        pl_text_add_element(buffer, "</td><td class=\"why\">",
                            cell->reason[0] != '\0' ? cell->reason : "no reason was recorded", "");
        if (output[0] != '\0')
            pl_text_add_element(buffer, "<pre>", output, "</pre>");
        pl_text_add(buffer, "</td></tr>\n");
    }
    pl_text_add(buffer, "</tbody></table></div>\n");
}

static void add_definitions(pl_text_buffer *buffer)
{
    static const char *const directions[] = {"lower is better", "higher is better", "no direction"};
    pl_text_add(buffer, "<h2 id=\"metrics\">Metrics</h2>\n<dl class=\"metrics\">\n");
    for (int id = 0; id < PL_METRIC_COUNT; id++) {
        const pl_metric_info *info = &pl_metric_table[id];
        pl_text_add_element(buffer, "<dt><code>", info->name, "</code> <span class=\"small\">");
        if (strcmp(info->unit, "1") != 0 && info->unit[0] != '\0')
            pl_text_add_element(buffer, "", info->unit, ", ");
        pl_text_add(buffer, directions[info->direction]);
        pl_text_add(buffer, info->deterministic ? "" : ", measured");
        pl_text_add_element(buffer, "</span></dt><dd>", info->definition, "</dd>\n");
    }
    pl_text_add(buffer, "</dl>\n");
}

static void add_method(pl_text_buffer *buffer)
{
    pl_text_add(
        buffer,
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

void pl_html_write(const pl_result_matrix *cells, const pl_losses *losses,
                   const pl_faults *findings, pl_text_buffer *buffer)
{
    add_head(cells, buffer);
    add_losses(losses, buffer);
    pl_warning warnings[PL_WARNINGS_MOST];
    int warning_count = pl_result_matrix_warnings(cells, warnings);
    for (int i = 0; i < warning_count; i++) {
        pl_text_add_element(buffer, "<p class=\"warn\"><b>", warnings[i].head, "</b> ");
        pl_text_add_element(buffer, "", warnings[i].text, "</p>\n");
    }
    if (cells->block_count == 0) {
        pl_text_add(buffer, "<p>There are no results.</p>\n");
    } else {
        pl_html_results(cells, buffer);
        pl_faults_html(findings, buffer);
        pl_stepping_html(cells, buffer);
        pl_html_settings(cells, buffer);
        pl_text_add(buffer, "<h2 id=\"problems\">Problem by problem</h2>\n");
        for (int b = 0; b < cells->block_count; b++)
            pl_html_problem(cells, b, buffer);
        add_failures(cells, buffer);
    }
    add_definitions(buffer);
    add_method(buffer);
    pl_text_add(buffer, "</main>\n</body>\n</html>\n");
}
