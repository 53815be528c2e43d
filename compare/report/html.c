/* The report as one HTML page. Every text that comes from results or the catalogue goes through
 * pl_sheet_add_html. */
#include "report/html.h"

#include "report/picture.h"
#include "report/quantity.h"
#include "report/stepping.h"
#include "report/style.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHOWN_LOSSES = 20, NOTE_SIZE = 640, TEXT_SIZE = 160 };

static void add_element(pl_sheet *sheet, const char *open, const char *text, const char *close)
{
    pl_sheet_add(sheet, open);
    pl_sheet_add_html(sheet, text);
    pl_sheet_add(sheet, close);
}

/* A numeric cell's opening tag, with a tooltip where there is something to say. */
static void open_cell(pl_sheet *sheet, const char *classes, const char *note)
{
    pl_sheet_format(sheet, "<td class=\"%s\"", classes);
    if (note[0] != '\0')
        add_element(sheet, " title=\"", note, "\"");
    pl_sheet_add(sheet, ">");
}

/* An outcome's colour: good, bad, or neither where the engine never claimed it could. */
static const char *numeric_class(const pl_cell *cell)
{
    if (cell->ok)
        return "n ok";
    return strcmp(cell->outcome, "unsupported") == 0 ? "n none" : "n bad";
}

static void add_badge(const pl_cell *cell, pl_sheet *sheet)
{
    pl_sheet_format(sheet, "<span class=\"badge %s\">", numeric_class(cell) + strlen("n "));
    pl_sheet_add_html(sheet, cell->outcome);
    if (cell->outcomes_differ)
        pl_sheet_format(sheet, " in %d of %d", cell->repeats - cell->ok_repeats, cell->repeats);
    pl_sheet_add(sheet, "</span>");
}

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
    add_element(sheet, "<dt>", name, "</dt><dd>");
    for (int i = 0; i < count; i++)
        add_element(sheet, i == 0 ? "" : "; ", seen[i], "");
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
        add_element(sheet, i == 0 ? "" : " ", word == NULL ? "" : word, "");
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
    add_element(sheet, "<dt>Started</dt><dd>", first, "");
    if (strcmp(first, last) != 0)
        add_element(sheet, " to ", last, "");
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
        add_element(sheet, i == 0 ? "" : ", ", cells->columns[i].label, " ");
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
        char ratio[PL_LOSS_TEXT_SIZE], note[NOTE_SIZE];
        pl_loss_texts(loss, metric, ours, best, ratio);
        snprintf(note, sizeof note, "%.600s", loss->our_cell->reason);
        if (loss->kind != PL_LOSS_OUTCOME)
            pl_measure_note(&loss->our_cell->measure[loss->metric], note, sizeof note);
        add_element(sheet, "<tr><th>", loss->block->name, "</th>");
        add_element(sheet, "<td>", metric, "</td>");
        add_element(sheet, "<td>", loss->ours->name, "</td>");
        open_cell(sheet, loss->kind == PL_LOSS_OUTCOME ? "n bad" : "n", note);
        add_element(sheet, "", ours, "</td>");
        add_element(sheet, "<td>", loss->best->name, "</td>");
        add_element(sheet, "<td class=\"n\">", best, "</td>");
        add_element(sheet, "<td class=\"n\">", ratio, "</td></tr>\n");
    }
    pl_sheet_add(sheet, "</tbody></table></div>\n");
}

static void add_losses(const pl_losses *losses, pl_sheet *sheet)
{
    add_element(sheet, "<h2 id=\"losses\">Where plumb loses</h2>\n<p class=\"verdict\">",
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
    add_element(sheet, "<p class=\"note\">", losses->rule.data, "</p>\n");
}

/* --- Main table --- */

static void add_main_cell(const pl_cell *cell, double fastest, pl_sheet *sheet)
{
    char text[TEXT_SIZE], note[NOTE_SIZE];
    if (cell->row == NULL) {
        pl_sheet_add(sheet, "<td class=\"n none\">not run</td>");
        return;
    }
    const pl_measure *error = &cell->measure[PL_METRIC_REFERENCE_ERROR];
    const pl_measure *time = &cell->measure[PL_METRIC_TIME_PER_STEP];
    pl_measure_note(error, note, sizeof note);
    if (!cell->ok && cell->reason[0] != '\0')
        snprintf(note, sizeof note, "%.600s", cell->reason);
    open_cell(sheet, numeric_class(cell), note);
    if (!cell->ok) {
        add_badge(cell, sheet);
        pl_sheet_add(sheet, "<br>");
    }
    pl_measure_text(error, text, sizeof text);
    if (cell->ok || error->state == PL_METRIC_VALUE)
        pl_sheet_add_html(sheet, text);
    if (pl_cell_disagrees(cell))
        pl_sheet_add(sheet, "<br><span class=\"badge bad\">not deterministic</span>");
    pl_measure_text(time, text, sizeof text);
    add_element(sheet, "<span class=\"time\">",
                cell->ok || time->state == PL_METRIC_VALUE ? text : "", "");
    if (cell->ok && time->state == PL_METRIC_VALUE && fastest > 0 && isfinite(fastest)) {
        pl_quantity_ratio(time->value / fastest, text);
        pl_sheet_format(sheet, " · %s", text);
    }
    pl_sheet_add(sheet, "</span></td>");
}

static void add_answer(const pl_block *block, pl_sheet *sheet)
{
    if (block->catalogue != NULL) {
        add_element(sheet, "<td class=\"answer\">", block->catalogue->reference, "");
        add_element(sheet, "<br><span class=\"small\">Source: ", block->catalogue->source,
                    "</span></td>");
        return;
    }
    pl_sheet_add(sheet, block->primary_error[0] != '\0'
                            ? "<td class=\"answer\">As the scene file expects.</td>"
                            : "<td class=\"answer\">None: the scene has no reference.</td>");
}

static void add_main_table(const pl_cells *cells, pl_sheet *sheet)
{
    pl_sheet_add(
        sheet,
        "<h2 id=\"results\">Results</h2>\n<p>In each cell the problem's primary error and, below "
        "it, the time of a step, with how many times that of the fastest run that is ok. Lower "
        "is better for both; a number without a unit is relative to what it should be. Green is a "
        "run that is ok, red one that failed, grey one that the engine does not support.</p>\n"
        "<p>Times are CPU time of the engine's step call alone, and machines are noisy: take "
        "differences of less than 10 % for none, and repeat runs (<code>--repeat</code>) before "
        "you trust larger ones.</p>\n<div class=\"scroll\"><table>\n"
        "<thead><tr><th>Problem</th>");
    for (int i = 0; i < cells->column_count; i++)
        add_element(sheet, "<th class=\"n\">", cells->columns[i].name, "</th>");
    pl_sheet_add(sheet, "<th>The right answer</th></tr></thead>\n<tbody>\n");
    for (int b = 0; b < cells->block_count; b++) {
        const pl_block *block = &cells->blocks[b];
        double fastest = pl_block_least(block, cells->column_count, PL_METRIC_TIME_PER_STEP);
        pl_sheet_format(sheet, "<tr><th><a href=\"#problem-%d\">", b);
        pl_sheet_add_html(sheet, block->name);
        add_element(sheet, "</a><br><span class=\"small\">",
                    block->primary_error[0] != '\0' ? block->primary_error : "no reference",
                    "</span></th>");
        for (int i = 0; i < cells->column_count; i++)
            add_main_cell(&block->cells[i], fastest, sheet);
        add_answer(block, sheet);
        pl_sheet_add(sheet, "</tr>\n");
    }
    pl_sheet_add(sheet, "</tbody></table></div>\n");
}

static void add_settings(const pl_cells *cells, pl_sheet *sheet)
{
    pl_sheet_add(
        sheet,
        "<h2 id=\"settings\">Engine settings</h2>\n<p>As recorded with the first run of each "
        "engine. A label names the profile and, after it, every option that was set off "
        "that profile's default; time step and duration are the problem's.</p>\n"
        "<div class=\"scroll\"><table>\n<thead><tr><th>Engine</th><th>Version</th>"
        "<th>Settings</th></tr></thead>\n<tbody>\n");
    for (int i = 0; i < cells->column_count; i++) {
        pl_sheet settings = {0};
        pl_cells_settings(cells, i, &settings);
        sheet->failed |= settings.failed;
        add_element(sheet, "<tr><th>", cells->columns[i].name, "</th>");
        add_element(sheet, "<td>", cells->columns[i].version, "</td>");
        add_element(sheet, "<td class=\"why\">", settings.data == NULL ? "" : settings.data,
                    "</td></tr>\n");
        pl_sheet_free(&settings);
    }
    pl_sheet_add(sheet, "</tbody></table></div>\n");
}

/* --- One problem --- */

static bool counts_for_best(const pl_cell *cell, int metric)
{
    return cell->row != NULL && cell->ok && cell->measure[metric].state == PL_METRIC_VALUE;
}

/* The least value over good runs in *best. False where there is none to single out: fewer than two
 * values, all the same up to noise, or numbers that mean different things to different engines. */
static bool find_best(const pl_block *block, int column_count, int metric, double *best)
{
    double most = -INFINITY;
    *best = pl_block_least(block, column_count, metric);
    if (!pl_loss_is_compared(metric))
        return false;
    for (int i = 0; i < column_count; i++)
        if (counts_for_best(&block->cells[i], metric))
            most = fmax(most, block->cells[i].measure[metric].value);
    return pl_loss_is_worse(block, metric, most, *best);
}

static void add_metric_row(const pl_cells *cells, const pl_block *block, int metric,
                           pl_sheet *sheet)
{
    const pl_metric_info *info = &pl_metric_table[metric];
    bool present = false;
    for (int i = 0; i < cells->column_count; i++)
        present |= block->cells[i].row != NULL &&
                   block->cells[i].measure[metric].state != PL_METRIC_ABSENT;
    if (!present)
        return;
    double best = 0;
    bool has_best = find_best(block, cells->column_count, metric, &best);
    add_element(sheet, "<tr><th title=\"", info->definition, "\">");
    pl_sheet_add_html(sheet, info->name);
    pl_sheet_add(sheet, "</th>");
    for (int i = 0; i < cells->column_count; i++) {
        const pl_cell *cell = &block->cells[i];
        const pl_measure *measure = &cell->measure[metric];
        char text[TEXT_SIZE], note[NOTE_SIZE] = "not run";
        if (cell->row != NULL)
            pl_measure_note(measure, note, sizeof note);
        open_cell(sheet, "n", note);
        pl_measure_text(measure, text, sizeof text);
        if (cell->row == NULL)
            snprintf(text, sizeof text, "%s", pl_quantity_missing);
        bool is_best = has_best && counts_for_best(cell, metric) &&
                       !pl_loss_is_worse(block, metric, measure->value, best);
        add_element(sheet, is_best ? "<b class=\"best\">" : "", text, is_best ? "</b>" : "");
        if (measure->disagrees)
            pl_sheet_add(sheet, "<br><span class=\"badge bad\">not deterministic</span>");
        pl_sheet_add(sheet, "</td>");
    }
    pl_sheet_add(sheet, "</tr>\n");
}

static void add_outcome_row(const pl_cells *cells, const pl_block *block, pl_sheet *sheet)
{
    pl_sheet_add(sheet, "<tr><th>outcome</th>");
    for (int i = 0; i < cells->column_count; i++) {
        const pl_cell *cell = &block->cells[i];
        if (cell->row == NULL) {
            pl_sheet_add(sheet, "<td class=\"n none\">not run</td>");
            continue;
        }
        open_cell(sheet, numeric_class(cell), cell->reason);
        if (cell->ok)
            pl_sheet_add(sheet, "ok");
        else
            add_badge(cell, sheet);
        pl_sheet_add(sheet, "</td>");
    }
    pl_sheet_add(sheet, "</tr>\n");
}

static void add_metric_table(const pl_cells *cells, const pl_block *block, pl_sheet *sheet)
{
    pl_sheet_add(sheet, "<div class=\"scroll\"><table>\n<thead><tr><th>Metric</th>");
    for (int i = 0; i < cells->column_count; i++)
        add_element(sheet, "<th class=\"n\">", cells->columns[i].name, "</th>");
    pl_sheet_add(sheet, "</tr></thead>\n<tbody>\n");
    add_outcome_row(cells, block, sheet);
    for (int id = 0; id < PL_METRIC_COUNT; id++)
        add_metric_row(cells, block, id, sheet);
    pl_sheet_add(sheet, "</tbody></table></div>\n");
}

static void add_params(const pl_block *block, pl_sheet *sheet)
{
    const pl_scenario *scenario = block->catalogue;
    pl_sheet_add(sheet, "<p class=\"small\">");
    for (int i = 0; i < scenario->param_count; i++) {
        const pl_param *param = &scenario->params[i];
        const json_t *value = json_object_get(block->params, param->name);
        char number[PL_QUANTITY_SIZE];
        pl_quantity_given(json_is_number(value) ? json_number_value(value) : (double)NAN,
                          param->unit, number);
        add_element(sheet, i == 0 ? "" : " · ", param->name, " = ");
        pl_sheet_add_html(sheet, number);
    }
    pl_sheet_format(sheet, " · seed = %" JSON_INTEGER_FORMAT "</p>\n", block->seed);
}

/* What a scene file's run has for parameters. */
static void add_times(const pl_block *block, pl_sheet *sheet)
{
    static const char *const names[] = {"dt", "duration"};
    pl_sheet_add(sheet, "<p class=\"small\">");
    for (int i = 0; i < 2; i++) {
        const json_t *value = json_object_get(json_object_get(block->row, "settings"), names[i]);
        char number[PL_QUANTITY_SIZE];
        pl_quantity_given(json_is_number(value) ? json_number_value(value) : (double)NAN, "s",
                          number);
        pl_sheet_format(sheet, "%s%s = %s", i == 0 ? "" : " · ", names[i], number);
    }
    pl_sheet_format(sheet, " · seed = %" JSON_INTEGER_FORMAT "</p>\n", block->seed);
}

static void add_problem(const pl_cells *cells, int index, pl_sheet *sheet)
{
    const pl_block *block = &cells->blocks[index];
    const pl_scenario *scenario = block->catalogue;
    pl_sheet_format(sheet, "<section>\n<h3 id=\"problem-%d\">", index);
    pl_sheet_add_html(sheet, block->name);
    if (scenario != NULL) {
        add_element(sheet, ": ", scenario->title, "</h3>\n");
        add_element(sheet, "<p>", scenario->description, "</p>\n");
        add_element(sheet, "<p><b>Right answer:</b> <span class=\"formula\">", scenario->reference,
                    "</span> ");
        add_element(sheet, "<span class=\"small\">(", scenario->source, ")</span></p>\n");
        add_params(block, sheet);
    } else {
        pl_sheet_add(sheet, "</h3>\n<p>A scene that is not in the catalogue.</p>\n");
        add_times(block, sheet);
    }
    add_metric_table(cells, block, sheet);
    pl_picture_row(cells, index, sheet);
    pl_sheet_add(sheet, "</section>\n");
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
        add_element(sheet, "<tr><th>", cells->blocks[b].name, "</th>");
        add_element(sheet, "<td>", cells->columns[i].name, "</td><td>");
        add_badge(cell, sheet);
        add_element(sheet, "</td><td class=\"why\">",
                    cell->reason[0] != '\0' ? cell->reason : "no reason was recorded", "");
        if (output[0] != '\0')
            add_element(sheet, "<pre>", output, "</pre>");
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
        add_element(sheet, "<dt><code>", info->name, "</code> <span class=\"small\">");
        if (strcmp(info->unit, "1") != 0 && info->unit[0] != '\0')
            add_element(sheet, "", info->unit, ", ");
        pl_sheet_add(sheet, directions[info->direction]);
        pl_sheet_add(sheet, info->deterministic ? "" : ", measured");
        add_element(sheet, "</span></dt><dd>", info->definition, "</dd>\n");
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
        add_element(sheet, "<p class=\"warn\"><b>", warnings[i].head, "</b> ");
        add_element(sheet, "", warnings[i].text, "</p>\n");
    }
    if (cells->block_count == 0) {
        pl_sheet_add(sheet, "<p>There are no results.</p>\n");
    } else {
        add_main_table(cells, sheet);
        pl_faults_html(findings, sheet);
        pl_stepping_html(cells, sheet);
        add_settings(cells, sheet);
        pl_sheet_add(sheet, "<h2 id=\"problems\">Problem by problem</h2>\n");
        for (int b = 0; b < cells->block_count; b++)
            add_problem(cells, b, sheet);
        add_failures(cells, sheet);
    }
    add_definitions(sheet);
    add_method(sheet);
    pl_sheet_add(sheet, "</main>\n</body>\n</html>\n");
}
