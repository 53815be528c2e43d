#include "findings.h"

#include "adapter_trust.h"
#include "base/heap.h"
#include "cell_verdict.h"
#include "results/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool has_no_value(const pl_result_cell *cell)
{
    return pl_result_cell_is_ok(cell) &&
           pl_result_cell_metric(cell, PL_METRIC_REFERENCE_ERROR).state == PL_METRIC_FAILED;
}

/* Whether something can be said of the run's answer. */
static bool is_counted(const pl_result_cell *cell)
{
    return cell->worst->verdict != PL_VERDICT_UNJUDGED || has_no_value(cell);
}

/* Says how many runs of the home engine, or of the others, are not accurate. */
static void write_count(const pl_result_table *results, bool home, int count, int runs,
                        pl_text_buffer *out)
{
    pl_text_format(out, "%d of %d runs of ", count, runs);
    pl_add_engine_names(results, home, out);
    pl_text_add(out, " that were judged are not accurate");
}

static void write_statements(const pl_result_table *results, pl_engine_findings *findings)
{
    int known = 0;
    for (int i = 0; i < findings->count; ++i) {
        known += findings->items[i].cause != NULL && findings->items[i].cause->cause != NULL;
    }
    if (findings->runs > 0) {
        write_count(results, false, findings->count, findings->runs, &findings->statement);
        if (findings->count > 0) {
            pl_text_format(&findings->statement, "; of %d the cause is known", known);
        }
        pl_text_add(&findings->statement, ".");
    }
    if (findings->home_runs > 0) {
        write_count(results, true, findings->home_count, findings->home_runs,
                    &findings->home_statement);
        pl_text_add(&findings->home_statement, ".");
    }
}

/* Of the engines that have a finding: reports accuse no others. */
static void write_adapters(const pl_result_table *results, pl_engine_findings *findings)
{
    bool *listed = pl_heap_new((size_t)results->configuration_count, sizeof *listed);
    for (int i = 0; i < findings->count; ++i) {
        listed[findings->items[i].cell->configuration] = true;
    }
    if (findings->count > 0) {
        pl_verified_statement(results, listed, &findings->adapters);
        pl_read_back_statement(results, listed, &findings->read_back);
        pl_text_format(&findings->origin,
                       "Causes were found by experiment with %s; each is shown only for the "
                       "version, profile and parameters of its experiment.",
                       findings->causes.found_with);
    }
    free(listed);
}

/* Counts a run, and adds it where it is a finding. */
static void note_run(const pl_result_table *results, const pl_result_cell *cell,
                     pl_engine_findings *findings)
{
    const pl_engine_finding finding = {
        .test_case = &results->cases[cell->test_case],
        .configuration = &results->configurations[cell->configuration],
        .cell = cell,
        .cause = pl_known_cause_find(&findings->causes, cell->worst->result)};
    const bool is_home = finding.configuration->is_home;
    *(is_home ? &findings->home_runs : &findings->runs) += is_counted(cell);
    if (!is_counted(cell) || cell->worst->verdict == PL_VERDICT_ACCURATE) {
        return;
    }
    if (is_home) {
        pl_push(&findings->home, &findings->home_count, &finding, sizeof finding);
    } else {
        pl_push(&findings->items, &findings->count, &finding, sizeof finding);
    }
}

pl_status pl_engine_findings_find(const pl_result_table *results, pl_engine_findings *findings,
                                  pl_error *error)
{
    *findings = (pl_engine_findings){0};
    pl_status status = pl_known_causes_read(NULL, NULL, &findings->causes, error);
    for (int i = 0; i < results->cell_count && status == PL_OK; ++i) {
        note_run(results, &results->cells[i], findings);
    }
    if (status == PL_OK) {
        write_statements(results, findings);
        write_adapters(results, findings);
    }
    return status;
}

void pl_engine_findings_free(pl_engine_findings *findings)
{
    pl_known_causes_free(&findings->causes);
    free(findings->items);
    free(findings->home);
    pl_text_free(&findings->statement);
    pl_text_free(&findings->home_statement);
    pl_text_free(&findings->adapters);
    pl_text_free(&findings->read_back);
    pl_text_free(&findings->origin);
    *findings = (pl_engine_findings){0};
}

void pl_engine_finding_texts(const pl_engine_finding *finding, char error[PL_FINDING_TEXT_SIZE],
                             const char **cause, const char **evidence)
{
    const pl_metric_summary summary =
        pl_result_cell_metric(finding->cell, PL_METRIC_REFERENCE_ERROR);
    const char *primary = finding->test_case->row->primary_error;
    const int metric = pl_metric_by_name(primary);
    char number[PL_QUANTITY_SIZE] = "no value", verdict[PL_CELL_VERDICT_SIZE];
    pl_cell_verdict(finding->cell, verdict);
    if (summary.state == PL_METRIC_VALUE && metric >= 0 &&
        strcmp(pl_metric_table[metric].unit, "1") == 0) {
        snprintf(number, sizeof number, "%.3g %%", 100 * summary.value);
    } else if (summary.state == PL_METRIC_VALUE) {
        pl_format_number(summary.value, summary.unit, number);
    }
    if (summary.state != PL_METRIC_VALUE && !has_no_value(finding->cell)) {
        snprintf(error, PL_FINDING_TEXT_SIZE, "%s", verdict);
    } else {
        snprintf(error, PL_FINDING_TEXT_SIZE, "%s, %s (%.60s)", verdict, number, primary);
    }
    bool tried = finding->cause != NULL;
    *cause = tried && finding->cause->cause != NULL ? finding->cause->cause : "cause not known";
    *evidence = tried ? finding->cause->evidence : pl_no_number;
}
