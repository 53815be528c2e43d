#include "report_document.h"

#include "base/heap.h"
#include "base/number_format.h"
#include "results/result.h"
#include "sections.h"

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

/* Counts a run, and adds it where it is a finding. */
static void note_run(const pl_result_table *results, const pl_result_cell *cell,
                     pl_all_findings *all)
{
    const pl_engine_finding finding = {
        .cell = cell, .cause = pl_known_cause_find(all->causes, cell->worst->result)};
    const bool is_home = results->configurations[cell->configuration].is_home;
    pl_engine_findings *findings = is_home ? &all->home : &all->others;
    findings->runs += is_counted(cell);
    if (is_counted(cell) && cell->worst->verdict != PL_VERDICT_ACCURATE) {
        pl_push(&findings->items, &findings->count, &finding, sizeof finding);
    }
}

void pl_findings_find(const pl_result_table *results, pl_all_findings *findings)
{
    *findings = (pl_all_findings){.results = results, .causes = pl_known_causes()};
    for (int i = 0; i < results->cell_count; ++i) {
        note_run(results, &results->cells[i], findings);
    }
}

/* ---- In words ---- */

/* Adds the error: "inaccurate, 74 % (value_error)" or "failed: collapsed, 0.764 m (rest_position_error)". */
static void add_error(const pl_result_cell *cell, pl_table *table)
{
    const pl_metric_summary summary = pl_result_cell_metric(cell, PL_METRIC_REFERENCE_ERROR);
    const char *primary = cell->worst->primary_error;
    const int metric = pl_metric_by_name(primary);
    char number[PL_QUANTITY_SIZE] = "no value", verdict[PL_CELL_VERDICT_SIZE];
    pl_cell_verdict(cell, verdict);
    if (summary.state == PL_METRIC_VALUE && metric >= 0 &&
        strcmp(pl_metric_table[metric].unit, "1") == 0) {
        snprintf(number, sizeof number, "%.3g %%", 100 * summary.value);
    } else if (summary.state == PL_METRIC_VALUE) {
        pl_format_number(summary.value, summary.unit, number);
    }
    if (summary.state != PL_METRIC_VALUE && !has_no_value(cell)) {
        pl_table_add(table, verdict);
    } else {
        pl_table_format_cell(table, "%s, %s (%s)", verdict, number, primary);
    }
}

/* The cause in words; "" where none is known, though it may have been sought. */
static const char *cause_of(const pl_engine_finding *finding)
{
    return pl_json_get_text(finding->cause, "cause");
}

static void add_row(const pl_result_table *results, const pl_engine_finding *finding, bool is_short,
                    pl_table *table)
{
    const char *cause = cause_of(finding);
    pl_table_add(table, results->cases[finding->cell->test_case].name);
    pl_table_add(table, results->configurations[finding->cell->configuration].name);
    add_error(finding->cell, table);
    pl_table_style(table, pl_cell_style(finding->cell));
    pl_table_add(table, cause[0] != '\0' ? cause : "cause not known");
    if (!is_short) {
        pl_table_add(table, finding->cause == NULL ? pl_no_number
                                                   : pl_json_get_text(finding->cause, "evidence"));
        pl_table_add(table, pl_cell_why(finding->cell));
    }
}

/* Of the engines that have a finding: reports accuse no others. */
static void add_adapters(const pl_all_findings *all, pl_document *document)
{
    bool *listed = pl_heap_new((size_t)all->results->configuration_count, sizeof *listed);
    for (int i = 0; i < all->others.count; ++i) {
        listed[all->others.items[i].cell->configuration] = true;
    }
    if (all->others.count > 0) {
        pl_document_paragraph(document,
                              "Causes were found by experiment with %s; each is shown only for the "
                              "version, profile and parameters of its experiment. Where the "
                              "conformance of an engine is not verified or FAILED, a deviation may "
                              "be its adapter's.",
                              pl_json_get_text(all->causes, "found_with"));
        pl_describe_read_back(all->results, listed, document);
    }
    free(listed);
}

void pl_findings_describe(const pl_all_findings *all, bool home, int shown, bool is_short,
                          pl_document *document)
{
    const pl_engine_findings *findings = home ? &all->home : &all->others;
    pl_table table = {.last = shown, .keys = 2};
    int known = 0;
    if (findings->runs == 0) {
        return;
    }
    pl_table_columns(&table, is_short ? "case|engine|error|what in the engine causes it"
                                      : "case|engine|error|what in the engine causes it|"
                                        "what was varied, and what changed|why");
    for (int i = 0; i < findings->count; ++i) {
        add_row(all->results, &findings->items[i], is_short, &table);
        known += cause_of(&findings->items[i])[0] != '\0';
    }
    if (!home) {
        pl_document_heading(document, "Findings");
    }
    char *names = pl_engine_names(all->results, home);
    char *causes = findings->count == 0 ? pl_heap_copy("")
                                        : pl_heap_format("; of %d the cause is known", known);
    pl_document_paragraph(document, "%d of %d runs of %s that were judged are not accurate%s.",
                          findings->count, findings->runs, names, causes);
    free(names);
    free(causes);
    pl_document_table(document, "Runs that are not accurate", &table);
    if (!home) {
        add_adapters(all, document);
    }
}
