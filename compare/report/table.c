/* The report for a terminal: fits the width by shortening names and reasons, never numbers. */
#include "findings.h"
#include "losses.h"
#include "quantity.h"
#include "report.h"

#include <stdlib.h>
#include <string.h>

enum { NUMBER_COLUMNS = 4, SHOWN_LOSSES = 5, TEXT_SIZE = 160, OUTCOME_WIDTH = 11 };

static const pl_metric_id shown[NUMBER_COLUMNS] = {
    PL_METRIC_REFERENCE_ERROR, PL_METRIC_PENETRATION_MAX, PL_METRIC_ITERATIONS_MEAN,
    PL_METRIC_TIME_PER_STEP};
static const char *const headings[NUMBER_COLUMNS] = {"error", "penetration", "iterations",
                                                     "time/step"};

static const char *const plain = "\033[0m", *const bold = "\033[1m", *const faint = "\033[2m",
                         *const green = "\033[32m", *const red = "\033[31m";

typedef struct table_layout {
    pl_text_buffer *buffer;
    bool colour;
    int width, name_width;
    int number_width[NUMBER_COLUMNS]; /* 0: left out, for want of width */
} table_layout;

static void paint(const table_layout *layout, const char *colour)
{
    if (layout->colour)
        pl_text_add(layout->buffer, colour);
}

static void spaces(pl_text_buffer *buffer, int count)
{
    for (int i = 0; i < count; i++)
        pl_text_add(buffer, " ");
}

/* Code points, as pl_text_add_plain counts them. */
static int length_of(const char *text)
{
    int count = 0;
    for (; *text != '\0'; text++)
        count += ((unsigned char)*text & 0xc0) != 0x80;
    return count;
}

static void add_left(pl_text_buffer *buffer, const char *text, int width)
{
    spaces(buffer, width - pl_text_add_plain(buffer, text, width));
}

static void add_right(pl_text_buffer *buffer, const char *text, int width)
{
    spaces(buffer, width - length_of(text));
    pl_text_add_plain(buffer, text, width);
}

/* The widest of a column's numbers and its heading. */
static int number_width(const pl_result_matrix *cells, int column)
{
    int widest = length_of(headings[column]);
    for (int b = 0; b < cells->block_count; b++) {
        for (int i = 0; i < cells->column_count; i++) {
            const pl_cell *cell = &cells->blocks[b].cells[i];
            char text[TEXT_SIZE];
            if (cell->row == NULL)
                continue;
            pl_measure_text(&cell->measure[shown[column]], text, sizeof text);
            int length = length_of(text);
            widest = length > widest ? length : widest;
        }
    }
    return widest;
}

/* Where the width is short, iterations go first, then penetration; then names are cut. */
static void measure_columns(const pl_result_matrix *cells, table_layout *layout)
{
    static const int dropped_first[] = {2, 1};
    int left = layout->width - 4 - OUTCOME_WIDTH, longest = 0;
    for (int k = 0; k < NUMBER_COLUMNS; k++) {
        layout->number_width[k] = number_width(cells, k);
        left -= 2 + layout->number_width[k];
    }
    for (int i = 0; i < cells->column_count; i++) {
        int length = length_of(cells->columns[i].name);
        longest = length > longest ? length : longest;
    }
    for (int i = 0; i < 2 && left < longest && left < 14; i++) {
        left += 2 + layout->number_width[dropped_first[i]];
        layout->number_width[dropped_first[i]] = 0;
    }
    layout->name_width = longest < left ? longest : left;
    if (layout->name_width < 6)
        layout->name_width = 6;
}

/* A paragraph, wrapped at blanks; from its second line on it is indented. */
static void add_wrapped(const table_layout *layout, const char *paragraph, int indent)
{
    pl_text_buffer *buffer = layout->buffer;
    int column = 0, start = 0;
    for (const char *word = paragraph; *word != '\0';) {
        size_t bytes = strcspn(word, " ");
        char text[300];
        snprintf(text, sizeof text, "%.*s", (int)bytes, word);
        if (column > start && column + 1 + length_of(text) > layout->width) {
            pl_text_add(buffer, "\n");
            spaces(buffer, indent);
            column = start = indent;
        }
        if (column > start)
            pl_text_add(buffer, " ");
        column += (column > start) + pl_text_add_plain(buffer, text, layout->width - start);
        word += bytes + strspn(word + bytes, " ");
    }
    pl_text_add(buffer, "\n");
}

static void add_losses(const pl_losses *losses, const table_layout *layout)
{
    pl_text_buffer *buffer = layout->buffer;
    paint(layout, bold);
    pl_text_add(buffer, "Where plumb loses");
    paint(layout, plain);
    pl_text_add(buffer, "\n");
    add_wrapped(layout, losses->statement.data, 0);
    for (int i = 0; i < losses->count && i < SHOWN_LOSSES; i++) {
        const pl_loss *loss = &losses->items[i];
        char metric[PL_LOSS_TEXT_SIZE], ours[PL_LOSS_TEXT_SIZE], best[PL_LOSS_TEXT_SIZE];
        char ratio[PL_LOSS_TEXT_SIZE], line[1600];
        pl_loss_texts(loss, metric, ours, best, ratio);
        snprintf(line, sizeof line, "  %s  %s: %s  %s %s, %s %s", ratio, loss->block->name, metric,
                 loss->ours->name, ours, loss->best->name, best);
        paint(layout, red);
        pl_text_add_plain(buffer, line, layout->width);
        paint(layout, plain);
        pl_text_add(buffer, "\n");
    }
    if (losses->count > SHOWN_LOSSES)
        pl_text_format(buffer, "  and %d more\n", losses->count - SHOWN_LOSSES);
}

/* Without what was varied, which the pages have. */
static void add_findings(const pl_faults *findings, const table_layout *layout)
{
    pl_text_buffer *buffer = layout->buffer;
    if (findings->runs == 0)
        return;
    pl_text_add(buffer, "\n");
    paint(layout, bold);
    pl_text_add(buffer, "Findings");
    paint(layout, plain);
    pl_text_add(buffer, "\n");
    add_wrapped(layout, findings->statement.data, 0);
    add_wrapped(layout, findings->innocence.data, 0);
    for (int i = 0; i < findings->count; i++) {
        const pl_fault *fault = &findings->items[i];
        char error[PL_FAULT_TEXT_SIZE], line[1600];
        const char *cause = NULL, *evidence = NULL;
        pl_fault_texts(fault, error, &cause, &evidence);
        snprintf(line, sizeof line, "%.250s, %.250s: %s: %s", fault->block->name,
                 fault->column->name, error, cause);
        add_wrapped(layout, line, 4);
    }
}

static void add_heading(const pl_block *block, const table_layout *layout)
{
    pl_text_buffer *buffer = layout->buffer;
    char line[640];
    snprintf(line, sizeof line, "%s%s%s%s%s", block->name,
             block->catalogue != NULL && block->catalogue->title != NULL ? ": " : "",
             block->catalogue != NULL ? block->catalogue->title : "",
             block->primary_error[0] != '\0' ? "; error = " : "; no reference",
             block->primary_error);
    pl_text_add(buffer, "\n");
    paint(layout, bold);
    pl_text_add_plain(buffer, line, layout->width);
    paint(layout, plain);
    pl_text_add(buffer, "\n");
    paint(layout, faint);
    add_left(buffer, "  engine", 2 + layout->name_width);
    for (int k = 0; k < NUMBER_COLUMNS; k++) {
        if (layout->number_width[k] == 0)
            continue;
        pl_text_add(buffer, "  ");
        add_right(buffer, headings[k], layout->number_width[k]);
    }
    pl_text_add(buffer, "  outcome");
    paint(layout, plain);
    pl_text_add(buffer, "\n");
}

static void add_line(const pl_column *column, const pl_cell *cell, const table_layout *layout)
{
    pl_text_buffer *buffer = layout->buffer;
    int used = 2 + layout->name_width;
    pl_text_add(buffer, "  ");
    add_left(buffer, column->name, layout->name_width);
    for (int k = 0; k < NUMBER_COLUMNS; k++) {
        char text[TEXT_SIZE];
        if (layout->number_width[k] == 0)
            continue;
        pl_measure_text(&cell->measure[shown[k]], text, sizeof text);
        pl_text_add(buffer, "  ");
        add_right(buffer, cell->row == NULL ? pl_quantity_missing : text, layout->number_width[k]);
        used += 2 + layout->number_width[k];
    }
    char outcome[1024];
    snprintf(outcome, sizeof outcome, "%.60s%s%s%.600s",
             cell->row == NULL ? "not run" : cell->outcome,
             cell->row != NULL && pl_cell_disagrees(cell) ? " (not deterministic)" : "",
             cell->reason[0] != '\0' ? ": " : "", cell->reason);
    pl_text_add(buffer, "  ");
    paint(layout, cell->row == NULL ? faint : cell->ok ? green : red);
    pl_text_add_plain(buffer, outcome, layout->width - used - 2);
    paint(layout, plain);
    pl_text_add(buffer, "\n");
}

void pl_report_print_table(FILE *out, const json_t *results, bool colour, int width)
{
    pl_result_matrix cells = {0};
    pl_losses losses = {0};
    pl_faults findings = {0};
    pl_text_buffer buffer = {0};
    pl_error error = {PL_OK, ""};
    table_layout layout = {.buffer = &buffer, .colour = colour, .width = width < 40 ? 40 : width};
    pl_status status = pl_result_matrix_build(results, &cells, &error);
    if (status == PL_OK)
        status = pl_losses_find(&cells, &losses, &error);
    if (status == PL_OK)
        status = pl_faults_find(&cells, &findings, &error);
    if (status == PL_OK) {
        measure_columns(&cells, &layout);
        add_losses(&losses, &layout);
        for (int b = 0; b < cells.block_count; b++) {
            add_heading(&cells.blocks[b], &layout);
            for (int i = 0; i < cells.column_count; i++)
                add_line(&cells.columns[i], &cells.blocks[b].cells[i], &layout);
        }
        add_findings(&findings, &layout);
    } else {
        pl_text_format(&buffer, "no table: %s\n", error.message);
    }
    if (buffer.failed || buffer.data == NULL)
        fputs("no table: no memory\n", out);
    else
        fputs(buffer.data, out);
    pl_text_free(&buffer);
    pl_faults_free(&findings);
    pl_losses_free(&losses);
    pl_result_matrix_free(&cells);
}
