#include "findings.h"

#include "quantity.h"
#include "results/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double pl_fault_limit = 0.01;

static bool is_relative(const pl_block *block)
{
    int metric = pl_metric_by_name(block->primary_error);
    return metric >= 0 && strcmp(pl_metric_table[metric].unit, "1") == 0;
}

/* What an engine never claimed to simulate is no fault. */
static bool is_fault(const pl_block *block, const pl_cell *cell)
{
    const pl_measure *error = &cell->measure[PL_METRIC_REFERENCE_ERROR];
    if (!cell->ok)
        return strcmp(cell->outcome, "unsupported") != 0;
    if (!is_relative(block))
        return false;
    return error->state == PL_METRIC_FAILED ||
           (error->state == PL_METRIC_VALUE && error->value > pl_fault_limit);
}

static void list_engines(const pl_result_matrix *cells, pl_text_buffer *out)
{
    const char *separator = "";
    for (int i = 0; i < cells->column_count; i++) {
        if (cells->columns[i].ours)
            continue;
        pl_text_format(out, "%s%s", separator, cells->columns[i].name);
        separator = ", ";
    }
}

static void write_statement(const pl_result_matrix *cells, pl_faults *findings)
{
    pl_text_buffer *out = &findings->statement;
    int known = 0;
    for (int i = 0; i < findings->count; i++)
        known += findings->items[i].cause != NULL && findings->items[i].cause->text != NULL;
    if (findings->runs == 0)
        return;
    pl_text_format(out, "%d of %d runs of ", findings->count, findings->runs);
    list_engines(cells, out);
    pl_text_format(out,
                   " with a known right answer failed or are off by more than %g %% where the "
                   "error is relative",
                   100 * pl_fault_limit);
    if (findings->count > 0)
        pl_text_format(out, "; of %d the cause is known", known);
    pl_text_add(out, ".");
}

static bool has_engine(const pl_result_matrix *cells, const char *engine)
{
    for (int i = 0; i < cells->column_count; i++)
        if (strcmp(cells->columns[i].engine, engine) == 0)
            return true;
    return false;
}

static void write_innocence(const pl_result_matrix *cells, pl_faults *findings)
{
    pl_text_buffer *out = &findings->innocence;
    pl_text_add(out, "It is not the adapter: before its first step every run reads masses, "
                     "principal inertias and gravity back from the engine, and the step, "
                     "friction and restitution as the engine is handed them, and is refused "
                     "where one differs from the scene's by more than 1e-12 of it");
    if (has_engine(cells, "ode"))
        pl_text_add(out, "; ODE keeps no friction and restitution to be read, it is given them "
                         "with each contact");
    if (has_engine(cells, "bullet"))
        pl_text_add(out, "; Bullet asks for friction and restitution by callbacks, and these "
                         "are what is read");
    pl_text_format(out, ". Causes were found by experiment with %s.", pl_causes_versions);
}

pl_status pl_faults_find(const pl_result_matrix *cells, pl_faults *findings, pl_error *error)
{
    *findings = (pl_faults){0};
    size_t most = (size_t)cells->block_count * (size_t)cells->column_count;
    findings->items = calloc(most + 1, sizeof *findings->items);
    if (findings->items == NULL)
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu findings", most);
    for (int b = 0; b < cells->block_count; b++) {
        const pl_block *block = &cells->blocks[b];
        for (int i = 0; block->primary_error[0] != '\0' && i < cells->column_count; i++) {
            const pl_cell *cell = &block->cells[i];
            if (cells->columns[i].ours || cell->row == NULL)
                continue;
            findings->runs++;
            if (!is_fault(block, cell))
                continue;
            findings->items[findings->count++] =
                (pl_fault){.block = block,
                           .column = &cells->columns[i],
                           .cell = cell,
                           .cause = pl_cause_find(cells->columns[i].engine,
                                                  pl_json_get_text(cell->row, "profile"),
                                                  block->scenario, cell->outcome)};
        }
    }
    write_statement(cells, findings);
    write_innocence(cells, findings);
    if (findings->statement.failed || findings->innocence.failed)
        return pl_fail(error, PL_NO_MEMORY, "no memory for the statement of findings");
    return PL_OK;
}

void pl_faults_free(pl_faults *findings)
{
    free(findings->items);
    pl_text_free(&findings->statement);
    pl_text_free(&findings->innocence);
    *findings = (pl_faults){0};
}

void pl_fault_texts(const pl_fault *fault, char error[PL_FAULT_TEXT_SIZE], const char **cause,
                    const char **evidence)
{
    const pl_measure *measure = &fault->cell->measure[PL_METRIC_REFERENCE_ERROR];
    char number[PL_QUANTITY_SIZE] = "no value";
    if (measure->state == PL_METRIC_VALUE && is_relative(fault->block))
        snprintf(number, sizeof number, "%.3g %%", 100 * measure->value);
    else if (measure->state == PL_METRIC_VALUE)
        pl_quantity_text(measure->value, measure->unit, number);
    bool failed = !fault->cell->ok;
    if (failed && measure->state != PL_METRIC_VALUE)
        snprintf(error, PL_FAULT_TEXT_SIZE, "%.60s", fault->cell->outcome);
    else
        snprintf(error, PL_FAULT_TEXT_SIZE, "%.60s%s%s (%.60s)", failed ? fault->cell->outcome : "",
                 failed ? ", " : "", number, fault->block->primary_error);
    bool tried = fault->cause != NULL;
    *cause = tried && fault->cause->text != NULL ? fault->cause->text : "cause not known";
    *evidence = tried ? fault->cause->evidence : pl_quantity_missing;
}

void pl_faults_html(const pl_faults *findings, pl_text_buffer *out)
{
    if (findings->runs == 0)
        return;
    pl_text_add_element(out, "<h2 id=\"findings\">Findings</h2>\n<p class=\"verdict\">",
                        findings->statement.data, "</p>\n");
    pl_text_add_element(out, "<p>", findings->innocence.data, "</p>\n");
    if (findings->count == 0)
        return;
    pl_text_add(out, "<div class=\"scroll\"><table>\n<thead><tr><th>Problem</th><th>Engine</th>"
                     "<th>Error</th><th>What in the engine causes it</th>"
                     "<th>What was varied, and what changed</th></tr></thead>\n<tbody>\n");
    for (int i = 0; i < findings->count; i++) {
        char error[PL_FAULT_TEXT_SIZE];
        const char *cause = NULL, *evidence = NULL;
        pl_fault_texts(&findings->items[i], error, &cause, &evidence);
        pl_text_add_element(out, "<tr><th>", findings->items[i].block->name, "</th>");
        pl_text_add_element(out, "<td>", findings->items[i].column->name, "</td>");
        pl_text_add_element(out, findings->items[i].cell->ok ? "<td>" : "<td class=\"bad\">", error,
                            "</td>");
        pl_text_add_element(out, "<td class=\"why\">", cause, "</td>");
        pl_text_add_element(out, "<td class=\"why\">", evidence, "</td></tr>\n");
    }
    pl_text_add(out, "</tbody></table></div>\n");
}

static void add_markdown(pl_text_buffer *out, const char *text)
{
    pl_text_add(out, "| ");
    pl_text_add_markdown(out, text);
    pl_text_add(out, " ");
}

void pl_faults_markdown(const pl_faults *findings, pl_text_buffer *out)
{
    if (findings->runs == 0)
        return;
    pl_text_add(out, "## Findings\n\n");
    pl_text_add_markdown(out, findings->statement.data);
    pl_text_add(out, "\n\n");
    pl_text_add_markdown(out, findings->innocence.data);
    pl_text_add(out, "\n\n");
    if (findings->count == 0)
        return;
    pl_text_add(out, "| Problem | Engine | Error | What in the engine causes it | What was "
                     "varied, and what changed |\n|---|---|---|---|---|\n");
    for (int i = 0; i < findings->count; i++) {
        char error[PL_FAULT_TEXT_SIZE];
        const char *cause = NULL, *evidence = NULL;
        pl_fault_texts(&findings->items[i], error, &cause, &evidence);
        add_markdown(out, findings->items[i].block->name);
        add_markdown(out, findings->items[i].column->name);
        add_markdown(out, error);
        add_markdown(out, cause);
        add_markdown(out, evidence);
        pl_text_add(out, "|\n");
    }
    pl_text_add(out, "\n");
}
