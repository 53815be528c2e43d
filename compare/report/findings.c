#include "findings.h"

#include "adapter_trust.h"
#include "number_format.h"
#include "results/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double pl_finding_threshold = 0.01;

static bool is_relative(const pl_case *test_case)
{
    int metric = pl_metric_by_name(test_case->primary_error);
    return metric >= 0 && strcmp(pl_metric_table[metric].unit, "1") == 0;
}

/* A scene that an engine does not support is no finding. */
static bool is_finding(const pl_case *test_case, const pl_cell *cell)
{
    const pl_metric_summary *error = &cell->metrics[PL_METRIC_REFERENCE_ERROR];
    if (!cell->ok) {
        return strcmp(cell->outcome, "unsupported") != 0;
    }
    if (!is_relative(test_case)) {
        return false;
    }
    return error->state == PL_METRIC_FAILED ||
           (error->state == PL_METRIC_VALUE && error->value > pl_finding_threshold);
}

static void write_statement(const pl_result_matrix *matrix, pl_engine_findings *findings)
{
    pl_text_buffer *out = &findings->statement;
    int known = 0;
    for (int i = 0; i < findings->count; ++i) {
        known += findings->items[i].cause != NULL && findings->items[i].cause->cause != NULL;
    }
    if (findings->runs == 0) {
        return;
    }
    pl_text_format(out, "%d of %d runs of ", findings->count, findings->runs);
    pl_result_matrix_engines(matrix, false, out);
    pl_text_format(out, " with a known right answer failed, or have a relative error above %g %%",
                   100 * pl_finding_threshold);
    if (findings->count > 0) {
        pl_text_format(out, "; of %d the cause is known", known);
    }
    pl_text_add(out, ".");
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

pl_status pl_engine_findings_find(const pl_result_matrix *matrix, pl_engine_findings *findings,
                                  pl_error *error)
{
    *findings = (pl_engine_findings){0};
    size_t most = (size_t)matrix->case_count * (size_t)matrix->column_count;
    findings->items = calloc(most + 1, sizeof *findings->items);
    if (findings->items == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu findings", most);
    }
    pl_status status = pl_known_causes_read(NULL, NULL, &findings->causes, error);
    if (status != PL_OK) {
        return status;
    }
    for (int b = 0; b < matrix->case_count; ++b) {
        const pl_case *test_case = &matrix->cases[b];
        for (int i = 0; test_case->primary_error[0] != '\0' && i < matrix->column_count; ++i) {
            const pl_cell *cell = &test_case->cells[i];
            if (matrix->columns[i].ours || cell->result == NULL) {
                continue;
            }
            ++findings->runs;
            if (!is_finding(test_case, cell)) {
                continue;
            }
            findings->items[findings->count++] =
                (pl_engine_finding){.test_case = test_case,
                                    .column = &matrix->columns[i],
                                    .cell = cell,
                                    .cause = pl_known_cause_find(&findings->causes, cell->result)};
        }
    }
    write_statement(matrix, findings);
    write_adapters(matrix, findings);
    if (findings->statement.failed || findings->adapters.failed || findings->read_back.failed ||
        findings->origin.failed) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for the statement of findings");
    }
    return PL_OK;
}

void pl_engine_findings_free(pl_engine_findings *findings)
{
    pl_known_causes_free(&findings->causes);
    free(findings->items);
    pl_text_free(&findings->statement);
    pl_text_free(&findings->adapters);
    pl_text_free(&findings->read_back);
    pl_text_free(&findings->origin);
    *findings = (pl_engine_findings){0};
}

void pl_engine_finding_texts(const pl_engine_finding *finding, char error[PL_FINDING_TEXT_SIZE],
                             const char **cause, const char **evidence)
{
    const pl_metric_summary *summary = &finding->cell->metrics[PL_METRIC_REFERENCE_ERROR];
    char number[PL_NUMBER_SIZE] = "no value";
    if (summary->state == PL_METRIC_VALUE && is_relative(finding->test_case)) {
        snprintf(number, sizeof number, "%.3g %%", 100 * summary->value);
    } else if (summary->state == PL_METRIC_VALUE) {
        pl_format_number(summary->value, summary->unit, number);
    }
    bool failed = !finding->cell->ok;
    if (failed && summary->state != PL_METRIC_VALUE) {
        snprintf(error, PL_FINDING_TEXT_SIZE, "%.60s", finding->cell->outcome);
    } else {
        snprintf(error, PL_FINDING_TEXT_SIZE, "%.60s%s%s (%.60s)",
                 failed ? finding->cell->outcome : "", failed ? ", " : "", number,
                 finding->test_case->primary_error);
    }
    bool tried = finding->cause != NULL;
    *cause = tried && finding->cause->cause != NULL ? finding->cause->cause : "cause not known";
    *evidence = tried ? finding->cause->evidence : pl_no_number;
}
