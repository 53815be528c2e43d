#include "html_results.h"

#include "html_parts.h"
#include "quantity.h"

#include <math.h>
#include <stdio.h>

static void add_main_cell(const pl_cell *cell, double fastest, pl_text_buffer *out)
{
    char text[PL_HTML_TEXT_SIZE], note[PL_HTML_NOTE_SIZE];
    if (cell->row == NULL) {
        pl_text_add(out, "<td class=\"n none\">not run</td>");
        return;
    }
    const pl_measure *error = &cell->measure[PL_METRIC_REFERENCE_ERROR];
    const pl_measure *time = &cell->measure[PL_METRIC_TIME_PER_STEP];
    pl_measure_note(error, note, sizeof note);
    if (!cell->ok && cell->reason[0] != '\0')
        snprintf(note, sizeof note, "%.600s", cell->reason);
    pl_html_open_cell(out, pl_html_class(cell), note);
    if (!cell->ok) {
        pl_html_badge(cell, out);
        pl_text_add(out, "<br>");
    }
    pl_measure_text(error, text, sizeof text);
    if (cell->ok || error->state == PL_METRIC_VALUE)
        pl_text_add_html(out, text);
    if (pl_cell_disagrees(cell))
        pl_text_add(out, "<br><span class=\"badge bad\">not deterministic</span>");
    pl_measure_text(time, text, sizeof text);
    pl_text_add_element(out, "<span class=\"time\">",
                        cell->ok || time->state == PL_METRIC_VALUE ? text : "", "");
    if (cell->ok && time->state == PL_METRIC_VALUE && fastest > 0 && isfinite(fastest)) {
        pl_quantity_ratio(time->value / fastest, text);
        pl_text_format(out, " · %s", text);
    }
    pl_text_add(out, "</span></td>");
}

static void add_answer(const pl_block *block, pl_text_buffer *out)
{
    if (block->catalogue != NULL) {
        pl_text_add_element(out, "<td class=\"answer\">", block->catalogue->reference, "");
        pl_text_add_element(out, "<br><span class=\"small\">Source: ", block->catalogue->source,
                            "</span></td>");
        return;
    }
    pl_text_add(out, block->primary_error[0] != '\0'
                         ? "<td class=\"answer\">As the scene file expects.</td>"
                         : "<td class=\"answer\">None: the scene has no reference.</td>");
}

void pl_html_results(const pl_result_matrix *cells, pl_text_buffer *out)
{
    pl_text_add(
        out,
        "<h2 id=\"results\">Results</h2>\n<p>In each cell the problem's primary error and, below "
        "it, the time of a step, with how many times that of the fastest run that is ok. Lower "
        "is better for both; a number without a unit is relative to what it should be. Green is a "
        "run that is ok, red one that failed, grey one that the engine does not support.</p>\n"
        "<p>Times are CPU time of the engine's step call alone, and machines are noisy: take "
        "differences of less than 10 % for none, and repeat runs (<code>--repeat</code>) before "
        "you trust larger ones.</p>\n<div class=\"scroll\"><table>\n"
        "<thead><tr><th>Problem</th>");
    for (int i = 0; i < cells->column_count; i++)
        pl_text_add_element(out, "<th class=\"n\">", cells->columns[i].name, "</th>");
    pl_text_add(out, "<th>The right answer</th></tr></thead>\n<tbody>\n");
    for (int b = 0; b < cells->block_count; b++) {
        const pl_block *block = &cells->blocks[b];
        double fastest = pl_block_least(block, cells->column_count, PL_METRIC_TIME_PER_STEP);
        pl_text_format(out, "<tr><th><a href=\"#problem-%d\">", b);
        pl_text_add_html(out, block->name);
        pl_text_add_element(out, "</a><br><span class=\"small\">",
                            block->primary_error[0] != '\0' ? block->primary_error : "no reference",
                            "</span></th>");
        for (int i = 0; i < cells->column_count; i++)
            add_main_cell(&block->cells[i], fastest, out);
        add_answer(block, out);
        pl_text_add(out, "</tr>\n");
    }
    pl_text_add(out, "</tbody></table></div>\n");
}

void pl_html_settings(const pl_result_matrix *cells, pl_text_buffer *out)
{
    pl_text_add(
        out, "<h2 id=\"settings\">Engine settings</h2>\n<p>As recorded with the first run of each "
             "engine. A label names the profile and, after it, every option that was set off "
             "that profile's default; time step and duration are the problem's.</p>\n"
             "<div class=\"scroll\"><table>\n<thead><tr><th>Engine</th><th>Version</th>"
             "<th>Settings</th></tr></thead>\n<tbody>\n");
    for (int i = 0; i < cells->column_count; i++) {
        pl_text_buffer settings = {0};
        pl_result_matrix_settings(cells, i, &settings);
        out->failed |= settings.failed;
        pl_text_add_element(out, "<tr><th>", cells->columns[i].name, "</th>");
        pl_text_add_element(out, "<td>", cells->columns[i].version, "</td>");
        pl_text_add_element(out, "<td class=\"why\">", settings.data == NULL ? "" : settings.data,
                            "</td></tr>\n");
        pl_text_free(&settings);
    }
    pl_text_add(out, "</tbody></table></div>\n");
}
