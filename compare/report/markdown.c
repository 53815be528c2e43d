/* The report as Markdown for GitHub (GitHub Flavored Markdown Spec 0.29, section 4.10). */
#include "markdown.h"

#include "published.h"
#include "quantity.h"
#include "time_stepping.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHOWN_LOSSES = 20 };

static void add_cell(pl_text_buffer *out, const char *text)
{
    pl_text_add(out, "| ");
    pl_text_add_markdown(out, text);
    pl_text_add(out, " ");
}

static void add_loss_lines(const pl_losses *losses, int first, int last, pl_text_buffer *out)
{
    pl_text_add(out, "\n| Problem | Ours | Metric | Ours | Best other | Its value | Ratio |\n"
                     "|---|---|---|---:|---|---:|---:|\n");
    for (int i = first; i < last; i++) {
        const pl_loss *loss = &losses->items[i];
        char metric[PL_LOSS_TEXT_SIZE], ours[PL_LOSS_TEXT_SIZE], best[PL_LOSS_TEXT_SIZE];
        char ratio[PL_LOSS_TEXT_SIZE];
        pl_loss_texts(loss, metric, ours, best, ratio);
        add_cell(out, loss->block->name);
        add_cell(out, loss->ours->name);
        add_cell(out, metric);
        add_cell(out, ours);
        add_cell(out, loss->best->name);
        add_cell(out, best);
        add_cell(out, ratio);
        pl_text_add(out, "|\n");
    }
}

static void add_losses(const pl_losses *losses, pl_text_buffer *out)
{
    pl_text_add(out, "## Where plumb loses\n\n");
    pl_text_add_markdown(out, losses->statement.data);
    pl_text_add(out, "\n");
    int shown = losses->count < SHOWN_LOSSES ? losses->count : SHOWN_LOSSES;
    if (shown > 0)
        add_loss_lines(losses, 0, shown, out);
    if (losses->count > shown) {
        pl_text_format(out, "\n<details><summary>%d more</summary>\n", losses->count - shown);
        add_loss_lines(losses, shown, losses->count, out);
        pl_text_add(out, "\n</details>\n");
    }
    pl_text_add(out, "\n<sub>");
    pl_text_add_markdown(out, losses->rule.data);
    pl_text_add(out, "</sub>\n\n");
}

static void add_result(const pl_cell *cell, double fastest, pl_text_buffer *out)
{
    const pl_measure *time = &cell->measure[PL_METRIC_TIME_PER_STEP];
    char text[160];
    pl_text_add(out, "| ");
    if (cell->row == NULL) {
        pl_text_add(out, "not run ");
        return;
    }
    if (!cell->ok) {
        pl_text_add(out, "**");
        pl_text_add_markdown(out, cell->outcome);
        pl_text_add(out, "** ");
    }
    pl_measure_text(&cell->measure[PL_METRIC_REFERENCE_ERROR], text, sizeof text);
    pl_text_add_markdown(out, text);
    if (pl_cell_disagrees(cell))
        pl_text_add(out, " *not deterministic*");
    if (time->state == PL_METRIC_VALUE) {
        pl_measure_text(time, text, sizeof text);
        pl_text_add(out, "<br>");
        pl_text_add_markdown(out, text);
        if (cell->ok && isfinite(fastest) && fastest > 0) {
            pl_quantity_ratio(time->value / fastest, text);
            pl_text_format(out, " (%s)", text);
        }
    }
    pl_text_add(out, " ");
}

static void add_main_table(const pl_result_matrix *cells, pl_text_buffer *out)
{
    pl_text_add(out,
                "## Results\n\nPrimary error (without a unit: relative); below it the CPU time of "
                "the engine's step call alone, and how many times that of the fastest run that is "
                "ok. Machines are noisy: differences of less than 10 % are none.\n\n| Problem "
                "(primary error) ");
    for (int i = 0; i < cells->column_count; i++)
        add_cell(out, cells->columns[i].name);
    pl_text_add(out, "|\n|---");
    for (int i = 0; i < cells->column_count; i++)
        pl_text_add(out, "|---:");
    pl_text_add(out, "|\n");
    for (int b = 0; b < cells->block_count; b++) {
        const pl_block *block = &cells->blocks[b];
        double fastest = pl_block_least(block, cells->column_count, PL_METRIC_TIME_PER_STEP);
        add_cell(out, block->name);
        pl_text_add(out, "(");
        pl_text_add_markdown(out, block->primary_error[0] != '\0' ? block->primary_error
                                                                  : "no reference");
        pl_text_add(out, ") ");
        for (int i = 0; i < cells->column_count; i++)
            add_result(&block->cells[i], fastest, out);
        pl_text_add(out, "|\n");
    }
    pl_text_add(out, "\n");
}

/* A metric's value, or that there is none, and the outcome. */
static void add_outcome(const pl_cell *cell, int metric, pl_text_buffer *out)
{
    char text[160];
    pl_text_add(out, "| ");
    if (cell->row == NULL) {
        pl_text_add(out, "not run ");
        return;
    }
    pl_measure_text(&cell->measure[metric], text, sizeof text);
    pl_text_add_markdown(out, text);
    pl_text_add(out, cell->ok ? "<br>" : "<br>**");
    pl_text_add_markdown(out, cell->outcome);
    pl_text_add(out, cell->ok ? " " : "** ");
}

static void add_published_rows(const pl_result_matrix *cells, const pl_suite_entry *entry,
                               int metric, pl_text_buffer *out)
{
    for (int b = 0; b < cells->block_count; b++) {
        const pl_block *block = &cells->blocks[b];
        char published[PL_QUANTITY_SIZE];
        if (!pl_published_is(block, entry))
            continue;
        pl_quantity_given(entry->published, pl_metric_table[metric].unit, published);
        add_cell(out, block->name);
        add_cell(out, published);
        for (int i = 0; i < cells->column_count; i++)
            add_outcome(&block->cells[i], metric, out);
        pl_text_add(out, "|\n");
    }
}

/* What others published of the problems here. */
static void add_published(const pl_result_matrix *cells, pl_text_buffer *out)
{
    int count = 0;
    const pl_suite *suites = pl_suites(&count);
    for (int s = 0; s < count; s++) {
        const pl_suite *suite = &suites[s];
        if (!pl_published_applies(suite, cells))
            continue;
        int metric = pl_metric_by_name(suite->published_metric);
        pl_text_add(out, "## Beside published numbers: ");
        pl_text_add_markdown(out, suite->published_metric);
        pl_text_add(out, "\n\n| Problem | Published ");
        for (int i = 0; i < cells->column_count; i++)
            add_cell(out, cells->columns[i].name);
        pl_text_add(out, "|\n|---|---:");
        for (int i = 0; i < cells->column_count; i++)
            pl_text_add(out, "|---:");
        pl_text_add(out, "|\n");
        for (int i = 0; i < suite->entry_count; i++)
            add_published_rows(cells, &suite->entries[i], metric, out);
        pl_text_add(out, "\n");
        pl_text_format(out, "<sub>%s: the engine reports none. Published: ", pl_quantity_missing);
        pl_text_add_markdown(out, suite->source);
        pl_text_add(out, ".</sub>\n\n");
    }
}

static void add_failures(const pl_result_matrix *cells, pl_text_buffer *out)
{
    int b = 0, i = 0;
    if (!pl_result_matrix_next_failure(cells, &b, &i)) {
        pl_text_add(out, "No run failed.\n\n");
        return;
    }
    pl_text_add(out, "## Failed runs\n\n| Problem | Engine | Outcome | Reason |\n"
                     "|---|---|---|---|\n");
    for (; pl_result_matrix_next_failure(cells, &b, &i); i++) {
        add_cell(out, cells->blocks[b].name);
        add_cell(out, cells->columns[i].name);
        add_cell(out, cells->blocks[b].cells[i].outcome);
        add_cell(out, cells->blocks[b].cells[i].reason);
        pl_text_add(out, "|\n");
    }
    pl_text_add(out, "\n");
}

static void add_settings(const pl_result_matrix *cells, pl_text_buffer *out)
{
    pl_text_add(out, "## Engine settings\n\n");
    for (int i = 0; i < cells->column_count; i++) {
        pl_text_buffer settings = {0};
        pl_result_matrix_settings(cells, i, &settings);
        out->failed |= settings.failed;
        pl_text_add(out, "- ");
        pl_text_add_markdown(out, cells->columns[i].name);
        pl_text_add(out, ": ");
        pl_text_add_markdown(out, settings.data == NULL ? "" : settings.data);
        pl_text_add(out, "\n");
        pl_text_free(&settings);
    }
}

void pl_markdown_write(const pl_result_matrix *cells, const pl_losses *losses,
                       const pl_faults *findings, pl_text_buffer *out)
{
    pl_text_add(out, "# Plumb report\n\n");
    if (cells->block_count > 0) {
        const json_t *row = cells->blocks[0].row;
        pl_text_format(out, "%d runs, %d problems, %d engines; ", cells->run_count,
                       cells->block_count, cells->column_count);
        pl_text_add_markdown(out, pl_row_text_in(row, "host", "cpu"));
        pl_text_add(out, "; plumb ");
        pl_text_add_markdown(out, pl_row_text_in(row, "plumb", "version"));
        pl_text_add(out, " (");
        pl_text_add_markdown(out, pl_row_text_in(row, "plumb", "git"));
        pl_text_add(out, ")\n\n");
    }
    add_losses(losses, out);
    pl_warning warnings[PL_WARNINGS_MOST];
    int warning_count = pl_result_matrix_warnings(cells, warnings);
    for (int i = 0; i < warning_count; i++) {
        pl_text_format(out, "**%s** ", warnings[i].head);
        pl_text_add_markdown(out, warnings[i].text);
        pl_text_add(out, "\n\n");
    }
    if (cells->block_count == 0) {
        pl_text_add(out, "There are no results.\n");
        return;
    }
    add_main_table(cells, out);
    pl_faults_markdown(findings, out);
    pl_stepping_markdown(cells, out);
    add_published(cells, out);
    add_failures(cells, out);
    add_settings(cells, out);
}
