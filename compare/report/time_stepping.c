#include "time_stepping.h"

#include <stdio.h>

enum { TEXT_SIZE = 160 };

static const char introduction[] =
    "The error against the right answer has two parts. A rule of motion is off even where every "
    "force is right: semi-implicit Euler, of first order, always, a rule of second order where a "
    "body stops within a step. Against the exact answer of the engine's own rule at the same step "
    "that part is gone, and what is left comes from contacts and friction. The rule is told from "
    "the frames, not asked for: semi-implicit Euler, x' = x + h v', or a rule of second order, "
    "x' = x + h (v + v')/2, which is exact for a constant force. Where nothing told it, the answer "
    "is the same by either.";

static bool is_split(const pl_block *block, const pl_cell *cell)
{
    int primary = pl_metric_by_name(block->primary_error);
    return cell->row != NULL && cell->ok &&
           (primary == PL_METRIC_TRAVEL_ERROR || primary == PL_METRIC_VALUE_ERROR) &&
           cell->measure[PL_METRIC_REFERENCE_ERROR].state == PL_METRIC_VALUE &&
           cell->measure[PL_METRIC_DISCRETE_ERROR].state == PL_METRIC_VALUE;
}

/* Moves *block, *column to the next run from there on that has both errors. */
static bool next_split(const pl_result_matrix *cells, int *block, int *column)
{
    for (; *block < cells->block_count; ++*block, *column = 0)
        for (; *column < cells->column_count; ++*column)
            if (is_split(&cells->blocks[*block], &cells->blocks[*block].cells[*column]))
                return true;
    return false;
}

/* The texts of a line: problem, engine, rule, the two errors. */
enum { LINE_PARTS = 5 };
typedef struct stepping_line {
    char part[LINE_PARTS][256];
} stepping_line;

static void fill_line(const pl_result_matrix *cells, int block, int column, stepping_line *line)
{
    const pl_cell *cell = &cells->blocks[block].cells[column];
    const pl_measure *rule = &cell->measure[PL_METRIC_INTEGRATOR];
    char truth[TEXT_SIZE], own[TEXT_SIZE];
    pl_measure_text(&cell->measure[PL_METRIC_REFERENCE_ERROR], truth, sizeof truth);
    pl_measure_text(&cell->measure[PL_METRIC_DISCRETE_ERROR], own, sizeof own);
    const char *texts[LINE_PARTS] = {cells->blocks[block].name, cells->columns[column].name,
                                     rule->state == PL_METRIC_TEXT ? rule->text : "not told", truth,
                                     own};
    for (int i = 0; i < LINE_PARTS; i++)
        snprintf(line->part[i], sizeof line->part[i], "%.250s", texts[i]);
}

void pl_stepping_html(const pl_result_matrix *cells, pl_text_buffer *buffer)
{
    int b = 0, i = 0;
    if (!next_split(cells, &b, &i))
        return;
    pl_text_add(buffer, "<h2 id=\"stepping\">Time stepping and contact</h2>\n<p>");
    pl_text_add_html(buffer, introduction);
    pl_text_add(buffer, "</p>\n<div class=\"scroll\"><table>\n<thead><tr><th>Problem</th>"
                        "<th>Engine</th><th>Rule, as found out</th>"
                        "<th class=\"n\">Error against the right answer</th>"
                        "<th class=\"n\">Against its own rule: contact</th></tr></thead>\n"
                        "<tbody>\n");
    for (; next_split(cells, &b, &i); i++) {
        stepping_line line;
        fill_line(cells, b, i, &line);
        for (int k = 0; k < LINE_PARTS; k++) {
            pl_text_add(buffer, k == 0 ? "<tr><th>" : k < 3 ? "<td>" : "<td class=\"n\">");
            pl_text_add_html(buffer, line.part[k]);
            pl_text_add(buffer, k == 0 ? "</th>" : "</td>");
        }
        pl_text_add(buffer, "</tr>\n");
    }
    pl_text_add(buffer, "</tbody></table></div>\n");
}

void pl_stepping_markdown(const pl_result_matrix *cells, pl_text_buffer *buffer)
{
    int b = 0, i = 0;
    if (!next_split(cells, &b, &i))
        return;
    pl_text_add(buffer, "## Time stepping and contact\n\n");
    pl_text_add_markdown(buffer, introduction);
    pl_text_add(buffer, "\n\n| Problem | Engine | Rule, as found out | Error against the right "
                        "answer | Against its own rule: contact |\n|---|---|---|---:|---:|\n");
    for (; next_split(cells, &b, &i); i++) {
        stepping_line line;
        fill_line(cells, b, i, &line);
        for (int k = 0; k < LINE_PARTS; k++) {
            pl_text_add(buffer, "| ");
            pl_text_add_markdown(buffer, line.part[k]);
            pl_text_add(buffer, " ");
        }
        pl_text_add(buffer, "|\n");
    }
    pl_text_add(buffer, "\n");
}
