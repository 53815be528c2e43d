#include "html_problem.h"

#include "html_parts.h"
#include "losses.h"
#include "picture.h"
#include "quantity.h"

#include <math.h>
#include <stdio.h>

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

static void add_metric_row(const pl_result_matrix *cells, const pl_block *block, int metric,
                           pl_text_buffer *buffer)
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
    pl_text_add_element(buffer, "<tr><th title=\"", info->definition, "\">");
    pl_text_add_html(buffer, info->name);
    pl_text_add(buffer, "</th>");
    for (int i = 0; i < cells->column_count; i++) {
        const pl_cell *cell = &block->cells[i];
        const pl_measure *measure = &cell->measure[metric];
        char text[PL_HTML_TEXT_SIZE], note[PL_HTML_NOTE_SIZE] = "not run";
        if (cell->row != NULL)
            pl_measure_note(measure, note, sizeof note);
        pl_html_open_cell(buffer, "n", note);
        pl_measure_text(measure, text, sizeof text);
        if (cell->row == NULL)
            snprintf(text, sizeof text, "%s", pl_quantity_missing);
        bool is_best = has_best && counts_for_best(cell, metric) &&
                       !pl_loss_is_worse(block, metric, measure->value, best);
        pl_text_add_element(buffer, is_best ? "<b class=\"best\">" : "", text,
                            is_best ? "</b>" : "");
        if (measure->disagrees)
            pl_text_add(buffer, "<br><span class=\"badge bad\">not deterministic</span>");
        pl_text_add(buffer, "</td>");
    }
    pl_text_add(buffer, "</tr>\n");
}

static void add_outcome_row(const pl_result_matrix *cells, const pl_block *block,
                            pl_text_buffer *buffer)
{
    pl_text_add(buffer, "<tr><th>outcome</th>");
    for (int i = 0; i < cells->column_count; i++) {
        const pl_cell *cell = &block->cells[i];
        if (cell->row == NULL) {
            pl_text_add(buffer, "<td class=\"n none\">not run</td>");
            continue;
        }
        pl_html_open_cell(buffer, pl_html_class(cell), cell->reason);
        if (cell->ok)
            pl_text_add(buffer, "ok");
        else
            pl_html_badge(cell, buffer);
        pl_text_add(buffer, "</td>");
    }
    pl_text_add(buffer, "</tr>\n");
}

static void add_metric_table(const pl_result_matrix *cells, const pl_block *block,
                             pl_text_buffer *buffer)
{
    pl_text_add(buffer, "<div class=\"scroll\"><table>\n<thead><tr><th>Metric</th>");
    for (int i = 0; i < cells->column_count; i++)
        pl_text_add_element(buffer, "<th class=\"n\">", cells->columns[i].name, "</th>");
    pl_text_add(buffer, "</tr></thead>\n<tbody>\n");
    add_outcome_row(cells, block, buffer);
    for (int id = 0; id < PL_METRIC_COUNT; id++)
        add_metric_row(cells, block, id, buffer);
    pl_text_add(buffer, "</tbody></table></div>\n");
}

static void add_params(const pl_block *block, pl_text_buffer *buffer)
{
    const pl_scenario *scenario = block->catalogue;
    pl_text_add(buffer, "<p class=\"small\">");
    for (int i = 0; i < scenario->param_count; i++) {
        const pl_param *param = &scenario->params[i];
        const json_t *value = json_object_get(block->params, param->name);
        char number[PL_QUANTITY_SIZE];
        pl_quantity_given(json_is_number(value) ? json_number_value(value) : (double)NAN,
                          param->unit, number);
        pl_text_add_element(buffer, i == 0 ? "" : " · ", param->name, " = ");
        pl_text_add_html(buffer, number);
    }
    pl_text_format(buffer, " · seed = %" JSON_INTEGER_FORMAT "</p>\n", block->seed);
}

/* What a scene file's run has for parameters. */
static void add_times(const pl_block *block, pl_text_buffer *buffer)
{
    static const char *const names[] = {"dt", "duration"};
    pl_text_add(buffer, "<p class=\"small\">");
    for (int i = 0; i < 2; i++) {
        const json_t *value = json_object_get(json_object_get(block->row, "settings"), names[i]);
        char number[PL_QUANTITY_SIZE];
        pl_quantity_given(json_is_number(value) ? json_number_value(value) : (double)NAN, "s",
                          number);
        pl_text_format(buffer, "%s%s = %s", i == 0 ? "" : " · ", names[i], number);
    }
    pl_text_format(buffer, " · seed = %" JSON_INTEGER_FORMAT "</p>\n", block->seed);
}

void pl_html_problem(const pl_result_matrix *cells, int index, pl_text_buffer *buffer)
{
    const pl_block *block = &cells->blocks[index];
    const pl_scenario *scenario = block->catalogue;
    pl_text_format(buffer, "<section>\n<h3 id=\"problem-%d\">", index);
    pl_text_add_html(buffer, block->name);
    if (scenario != NULL) {
        pl_text_add_element(buffer, ": ", scenario->title, "</h3>\n");
        pl_text_add_element(buffer, "<p>", scenario->description, "</p>\n");
        pl_text_add_element(buffer, "<p><b>Right answer:</b> <span class=\"formula\">",
                            scenario->reference, "</span> ");
        pl_text_add_element(buffer, "<span class=\"small\">(", scenario->source, ")</span></p>\n");
        add_params(block, buffer);
    } else {
        pl_text_add(buffer, "</h3>\n<p>A scene that is not in the catalogue.</p>\n");
        add_times(block, buffer);
    }
    add_metric_table(cells, block, buffer);
    pl_picture_row(cells, index, buffer);
    pl_text_add(buffer, "</section>\n");
}
