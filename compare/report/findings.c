#include "findings.h"

#include "adapter_trust.h"
#include "cell_verdict.h"
#include "results/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool has_no_value(const pl_cell *cell)
{
    return cell->ok && cell->metrics[PL_METRIC_REFERENCE_ERROR].state == PL_METRIC_FAILED;
}

/* Whether something can be said of the run's answer. */
static bool is_counted(const pl_cell *cell)
{
    return cell->result != NULL && (cell->verdict != PL_VERDICT_UNJUDGED || has_no_value(cell));
}

static bool is_finding(const pl_cell *cell)
{
    return is_counted(cell) && cell->verdict != PL_VERDICT_ACCURATE;
}

/* Says how many runs of our own engine, or of the others, are not accurate. */
static void write_count(const pl_result_matrix *matrix, bool ours, int count, int runs,
                        pl_text_buffer *out)
{
    pl_text_format(out, "%d of %d runs of ", count, runs);
    pl_result_matrix_engines(matrix, ours, out);
    pl_text_add(out, " that were judged are not accurate");
}

static void write_statements(const pl_result_matrix *matrix, pl_engine_findings *findings)
{
    int known = 0;
    for (int i = 0; i < findings->count; ++i) {
        known += findings->items[i].cause != NULL && findings->items[i].cause->cause != NULL;
    }
    if (findings->runs > 0) {
        write_count(matrix, false, findings->count, findings->runs, &findings->statement);
        if (findings->count > 0) {
            pl_text_format(&findings->statement, "; of %d the cause is known", known);
        }
        pl_text_add(&findings->statement, ".");
    }
    if (findings->our_runs > 0) {
        write_count(matrix, true, findings->our_count, findings->our_runs,
                    &findings->our_statement);
        pl_text_add(&findings->our_statement, ".");
    }
}

/* Of the engines that have a finding: reports accuse no others. */
static void write_adapters(const pl_result_matrix *matrix, pl_engine_findings *findings)
{
    bool *listed = calloc((size_t)matrix->column_count + 1, sizeof *listed);
    if (listed == NULL) {
        findings->adapters.failed = true;
        return;
    }
    for (int i = 0; i < findings->count; ++i) {
        listed[findings->items[i].column - matrix->columns] = true;
    }
    if (findings->count > 0) {
        pl_verified_statement(matrix, listed, &findings->adapters);
        pl_read_back_statement(matrix, listed, &findings->read_back);
        pl_text_format(&findings->origin,
                       "Causes were found by experiment with %s; each is shown only for the "
                       "version, profile and parameters of its experiment.",
                       findings->causes.found_with);
    }
    free(listed);
}

/* Counts a run, and adds it where it is a finding. */
static void note_run(const pl_case *test_case, const pl_column *column, const pl_cell *cell,
                     pl_engine_findings *findings)
{
    *(column->ours ? &findings->our_runs : &findings->runs) += is_counted(cell);
    if (!is_finding(cell)) {
        return;
    }
    const pl_engine_finding finding = {.test_case = test_case,
                                       .column = column,
                                       .cell = cell,
                                       .cause =
                                           pl_known_cause_find(&findings->causes, cell->result)};
    if (column->ours) {
        findings->ours[findings->our_count++] = finding;
    } else {
        findings->items[findings->count++] = finding;
    }
}

pl_status pl_engine_findings_find(const pl_result_matrix *matrix, pl_engine_findings *findings,
                                  pl_error *error)
{
    *findings = (pl_engine_findings){0};
    size_t most = (size_t)matrix->case_count * (size_t)matrix->column_count;
    findings->items = calloc(most + 1, sizeof *findings->items);
    findings->ours = calloc(most + 1, sizeof *findings->ours);
    if (findings->items == NULL || findings->ours == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu findings", most);
    }
    pl_status status = pl_known_causes_read(NULL, NULL, &findings->causes, error);
    if (status != PL_OK) {
        return status;
    }
    for (int b = 0; b < matrix->case_count; ++b) {
        const pl_case *test_case = &matrix->cases[b];
        for (int i = 0; i < matrix->column_count; ++i) {
            note_run(test_case, &matrix->columns[i], &test_case->cells[i], findings);
        }
    }
    write_statements(matrix, findings);
    write_adapters(matrix, findings);
    if (findings->statement.failed || findings->our_statement.failed || findings->adapters.failed ||
        findings->read_back.failed || findings->origin.failed) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for the statement of findings");
    }
    return PL_OK;
}

void pl_engine_findings_free(pl_engine_findings *findings)
{
    pl_known_causes_free(&findings->causes);
    free(findings->items);
    free(findings->ours);
    pl_text_free(&findings->statement);
    pl_text_free(&findings->our_statement);
    pl_text_free(&findings->adapters);
    pl_text_free(&findings->read_back);
    pl_text_free(&findings->origin);
    *findings = (pl_engine_findings){0};
}

void pl_engine_finding_texts(const pl_engine_finding *finding, char error[PL_FINDING_TEXT_SIZE],
                             const char **cause, const char **evidence)
{
    const pl_metric_summary *summary = &finding->cell->metrics[PL_METRIC_REFERENCE_ERROR];
    const char *primary = finding->test_case->primary_error;
    const int metric = pl_metric_by_name(primary);
    char number[PL_NUMBER_SIZE] = "no value", verdict[PL_CELL_VERDICT_SIZE];
    pl_cell_verdict(finding->cell, verdict);
    if (summary->state == PL_METRIC_VALUE && metric >= 0 &&
        strcmp(pl_metric_table[metric].unit, "1") == 0) {
        snprintf(number, sizeof number, "%.3g %%", 100 * summary->value);
    } else if (summary->state == PL_METRIC_VALUE) {
        pl_format_number(summary->value, summary->unit, number);
    }
    if (summary->state != PL_METRIC_VALUE && !has_no_value(finding->cell)) {
        snprintf(error, PL_FINDING_TEXT_SIZE, "%s", verdict);
    } else {
        snprintf(error, PL_FINDING_TEXT_SIZE, "%s, %s (%.60s)", verdict, number, primary);
    }
    bool tried = finding->cause != NULL;
    *cause = tried && finding->cause->cause != NULL ? finding->cause->cause : "cause not known";
    *evidence = tried ? finding->cause->evidence : pl_no_number;
}
