/* The report as Markdown for GitHub (GitHub Flavored Markdown Spec 0.29, section 4.10). */
#include "report/markdown.h"

#include "report/published.h"
#include "report/quantity.h"
#include "report/stepping.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHOWN_LOSSES = 20 };

static void add_cell(pl_sheet *sheet, const char *text)
{
    pl_sheet_add(sheet, "| ");
    pl_sheet_add_markdown(sheet, text);
    pl_sheet_add(sheet, " ");
}

static void add_loss_lines(const pl_losses *losses, int first, int last, pl_sheet *sheet)
{
    pl_sheet_add(sheet, "\n| Problem | Ours | Metric | Ours | Best other | Its value | Ratio |\n"
                        "|---|---|---|---:|---|---:|---:|\n");
    for (int i = first; i < last; i++) {
        const pl_loss *loss = &losses->items[i];
        char metric[PL_LOSS_TEXT_SIZE], ours[PL_LOSS_TEXT_SIZE], best[PL_LOSS_TEXT_SIZE];
        char ratio[PL_LOSS_TEXT_SIZE];
        pl_loss_texts(loss, metric, ours, best, ratio);
        add_cell(sheet, loss->block->name);
        add_cell(sheet, loss->ours->name);
        add_cell(sheet, metric);
        add_cell(sheet, ours);
        add_cell(sheet, loss->best->name);
        add_cell(sheet, best);
        add_cell(sheet, ratio);
        pl_sheet_add(sheet, "|\n");
    }
}

static void add_losses(const pl_losses *losses, pl_sheet *sheet)
{
    pl_sheet_add(sheet, "## Where plumb loses\n\n");
    pl_sheet_add_markdown(sheet, losses->statement.data);
    pl_sheet_add(sheet, "\n");
    int shown = losses->count < SHOWN_LOSSES ? losses->count : SHOWN_LOSSES;
    if (shown > 0)
        add_loss_lines(losses, 0, shown, sheet);
    if (losses->count > shown) {
        pl_sheet_format(sheet, "\n<details><summary>%d more</summary>\n", losses->count - shown);
        add_loss_lines(losses, shown, losses->count, sheet);
        pl_sheet_add(sheet, "\n</details>\n");
    }
    pl_sheet_add(sheet, "\n<sub>");
    pl_sheet_add_markdown(sheet, losses->rule.data);
    pl_sheet_add(sheet, "</sub>\n\n");
}

static void add_result(const pl_cell *cell, double fastest, pl_sheet *sheet)
{
    const pl_measure *time = &cell->measure[PL_METRIC_TIME_PER_STEP];
    char text[160];
    pl_sheet_add(sheet, "| ");
    if (cell->row == NULL) {
        pl_sheet_add(sheet, "not run ");
        return;
    }
    if (!cell->ok) {
        pl_sheet_add(sheet, "**");
        pl_sheet_add_markdown(sheet, cell->outcome);
        pl_sheet_add(sheet, "** ");
    }
    pl_measure_text(&cell->measure[PL_METRIC_REFERENCE_ERROR], text, sizeof text);
    pl_sheet_add_markdown(sheet, text);
    if (pl_cell_disagrees(cell))
        pl_sheet_add(sheet, " *not deterministic*");
    if (time->state == PL_METRIC_VALUE) {
        pl_measure_text(time, text, sizeof text);
        pl_sheet_add(sheet, "<br>");
        pl_sheet_add_markdown(sheet, text);
        if (cell->ok && isfinite(fastest) && fastest > 0) {
            pl_quantity_ratio(time->value / fastest, text);
            pl_sheet_format(sheet, " (%s)", text);
        }
    }
    pl_sheet_add(sheet, " ");
}

static void add_main_table(const pl_cells *cells, pl_sheet *sheet)
{
    pl_sheet_add(sheet,
                 "## Results\n\nPrimary error (without a unit: relative); below it the CPU time of "
                 "the engine's step call alone, and how many times that of the fastest run that is "
                 "ok. Machines are noisy: differences of less than 10 % are none.\n\n| Problem "
                 "(primary error) ");
    for (int i = 0; i < cells->column_count; i++)
        add_cell(sheet, cells->columns[i].name);
    pl_sheet_add(sheet, "|\n|---");
    for (int i = 0; i < cells->column_count; i++)
        pl_sheet_add(sheet, "|---:");
    pl_sheet_add(sheet, "|\n");
    for (int b = 0; b < cells->block_count; b++) {
        const pl_block *block = &cells->blocks[b];
        double fastest = pl_block_least(block, cells->column_count, PL_METRIC_TIME_PER_STEP);
        add_cell(sheet, block->name);
        pl_sheet_add(sheet, "(");
        pl_sheet_add_markdown(sheet, block->primary_error[0] != '\0' ? block->primary_error
                                                                     : "no reference");
        pl_sheet_add(sheet, ") ");
        for (int i = 0; i < cells->column_count; i++)
            add_result(&block->cells[i], fastest, sheet);
        pl_sheet_add(sheet, "|\n");
    }
    pl_sheet_add(sheet, "\n");
}

/* A metric's value, or that there is none, and the outcome. */
static void add_outcome(const pl_cell *cell, int metric, pl_sheet *sheet)
{
    char text[160];
    pl_sheet_add(sheet, "| ");
    if (cell->row == NULL) {
        pl_sheet_add(sheet, "not run ");
        return;
    }
    pl_measure_text(&cell->measure[metric], text, sizeof text);
    pl_sheet_add_markdown(sheet, text);
    pl_sheet_add(sheet, cell->ok ? "<br>" : "<br>**");
    pl_sheet_add_markdown(sheet, cell->outcome);
    pl_sheet_add(sheet, cell->ok ? " " : "** ");
}

static void add_published_rows(const pl_cells *cells, const pl_suite_entry *entry, int metric,
                               pl_sheet *sheet)
{
    for (int b = 0; b < cells->block_count; b++) {
        const pl_block *block = &cells->blocks[b];
        char published[PL_QUANTITY_SIZE];
        if (!pl_published_is(block, entry))
            continue;
        pl_quantity_given(entry->published, pl_metric_table[metric].unit, published);
        add_cell(sheet, block->name);
        add_cell(sheet, published);
        for (int i = 0; i < cells->column_count; i++)
            add_outcome(&block->cells[i], metric, sheet);
        pl_sheet_add(sheet, "|\n");
    }
}

/* What others published of the problems here. */
static void add_published(const pl_cells *cells, pl_sheet *sheet)
{
    int count = 0;
    const pl_suite *suites = pl_suites(&count);
    for (int s = 0; s < count; s++) {
        const pl_suite *suite = &suites[s];
        if (!pl_published_applies(suite, cells))
            continue;
        int metric = pl_metric_by_name(suite->published_metric);
        pl_sheet_add(sheet, "## Beside published numbers: ");
        pl_sheet_add_markdown(sheet, suite->published_metric);
        pl_sheet_add(sheet, "\n\n| Problem | Published ");
        for (int i = 0; i < cells->column_count; i++)
            add_cell(sheet, cells->columns[i].name);
        pl_sheet_add(sheet, "|\n|---|---:");
        for (int i = 0; i < cells->column_count; i++)
            pl_sheet_add(sheet, "|---:");
        pl_sheet_add(sheet, "|\n");
        for (int i = 0; i < suite->entry_count; i++)
            add_published_rows(cells, &suite->entries[i], metric, sheet);
        pl_sheet_add(sheet, "\n");
        pl_sheet_format(sheet,
                        "<sub>%s: the engine reports none. Published: ", pl_quantity_missing);
        pl_sheet_add_markdown(sheet, suite->source);
        pl_sheet_add(sheet, ".</sub>\n\n");
    }
}

static void add_failures(const pl_cells *cells, pl_sheet *sheet)
{
    int b = 0, i = 0;
    if (!pl_cells_next_failure(cells, &b, &i)) {
        pl_sheet_add(sheet, "No run failed.\n\n");
        return;
    }
    pl_sheet_add(sheet, "## Failed runs\n\n| Problem | Engine | Outcome | Reason |\n"
                        "|---|---|---|---|\n");
    for (; pl_cells_next_failure(cells, &b, &i); i++) {
        add_cell(sheet, cells->blocks[b].name);
        add_cell(sheet, cells->columns[i].name);
        add_cell(sheet, cells->blocks[b].cells[i].outcome);
        add_cell(sheet, cells->blocks[b].cells[i].reason);
        pl_sheet_add(sheet, "|\n");
    }
    pl_sheet_add(sheet, "\n");
}

static void add_settings(const pl_cells *cells, pl_sheet *sheet)
{
    pl_sheet_add(sheet, "## Engine settings\n\n");
    for (int i = 0; i < cells->column_count; i++) {
        pl_sheet settings = {0};
        pl_cells_settings(cells, i, &settings);
        sheet->failed |= settings.failed;
        pl_sheet_add(sheet, "- ");
        pl_sheet_add_markdown(sheet, cells->columns[i].name);
        pl_sheet_add(sheet, ": ");
        pl_sheet_add_markdown(sheet, settings.data == NULL ? "" : settings.data);
        pl_sheet_add(sheet, "\n");
        pl_sheet_free(&settings);
    }
}

void pl_markdown_write(const pl_cells *cells, const pl_losses *losses, const pl_faults *findings,
                       pl_sheet *sheet)
{
    pl_sheet_add(sheet, "# Plumb report\n\n");
    if (cells->block_count > 0) {
        const json_t *row = cells->blocks[0].row;
        pl_sheet_format(sheet, "%d runs, %d problems, %d engines; ", cells->run_count,
                        cells->block_count, cells->column_count);
        pl_sheet_add_markdown(sheet, pl_row_text_in(row, "host", "cpu"));
        pl_sheet_add(sheet, "; plumb ");
        pl_sheet_add_markdown(sheet, pl_row_text_in(row, "plumb", "version"));
        pl_sheet_add(sheet, " (");
        pl_sheet_add_markdown(sheet, pl_row_text_in(row, "plumb", "git"));
        pl_sheet_add(sheet, ")\n\n");
    }
    add_losses(losses, sheet);
    pl_warning warnings[PL_WARNINGS_MOST];
    int warning_count = pl_cells_warnings(cells, warnings);
    for (int i = 0; i < warning_count; i++) {
        pl_sheet_format(sheet, "**%s** ", warnings[i].head);
        pl_sheet_add_markdown(sheet, warnings[i].text);
        pl_sheet_add(sheet, "\n\n");
    }
    if (cells->block_count == 0) {
        pl_sheet_add(sheet, "There are no results.\n");
        return;
    }
    add_main_table(cells, sheet);
    pl_faults_markdown(findings, sheet);
    pl_stepping_markdown(cells, sheet);
    add_published(cells, sheet);
    add_failures(cells, sheet);
    add_settings(cells, sheet);
}
