#include "report_document.h"

#include "base/heap.h"
#include "base/program_name.h"
#include "results/result.h"
#include "sections.h"

#include <stdlib.h>
#include <string.h>

enum { LOSSES_ON_TERMINAL = 5, SHOWN_LOSSES = 20 };

pl_report pl_report_build(const pl_result_table *results)
{
    pl_report report = {.results = results};
    pl_losses_find(results, &report.losses);
    pl_findings_find(results, &report.findings);
    return report;
}

void pl_report_free(pl_report *report)
{
    json_decref(report->findings.causes);
    free(report->findings.home.items);
    free(report->findings.others.items);
    free(report->losses.items);
}

/* ---- Sections ---- */

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

static void add_head(const pl_result_table *results, pl_document *document)
{
    const json_t *result = results->cases[0].row->result;
    pl_document_paragraph(
        document, "%d run%s, %d case%s, %d engine%s; %s; plumb %s (%s)", results->row_count,
        plural(results->row_count), results->case_count, plural(results->case_count),
        results->configuration_count, plural(results->configuration_count),
        pl_result_text(result, "host", "cpu"), pl_result_text(result, PL_PROGRAM, "version"),
        pl_result_text(result, PL_PROGRAM, "git"));
}

/* Where the home engine is worse than others, and which of its runs are not accurate. */
static void add_home(const pl_report *report, pl_reader reader, pl_document *document)
{
    const bool is_terminal = reader == PL_READER_TERMINAL;
    const int shown = is_terminal ? LOSSES_ON_TERMINAL : SHOWN_LOSSES;
    if (report->results->home != NULL) {
        pl_losses_describe(&report->losses, shown, is_terminal, document);
        pl_findings_describe(&report->findings, true, is_terminal ? 0 : shown, is_terminal,
                             document);
    }
}

static void add_warnings(const pl_result_table *results, pl_document *document)
{
    if (results->several_hosts) {
        pl_document_paragraph(document, "These runs come from several machines: their times cannot "
                                        "be compared with each other.");
    }
    if (results->disagrees) {
        pl_document_paragraph(document,
                              "Not deterministic: some repeats of the same run differ where they "
                              "should agree. The cells are marked.");
    }
}

static void add_metric(const pl_result_cell *cell, int metric, pl_table *table)
{
    const pl_metric_summary summary = pl_result_cell_metric(cell, metric);
    char text[PL_METRIC_TEXT_SIZE];
    pl_metric_text(&summary, text);
    pl_table_add(table, text);
}

/* Whether an ok run has both a relative primary error and a discrete_error. */
static bool has_both_errors(const pl_result_cell *cell)
{
    const int primary = pl_metric_by_name(cell->worst->primary_error);
    return pl_result_cell_is_ok(cell) &&
           (primary == PL_METRIC_TRAVEL_ERROR || primary == PL_METRIC_VALUE_ERROR) &&
           pl_result_cell_metric(cell, PL_METRIC_REFERENCE_ERROR).state == PL_METRIC_VALUE &&
           pl_result_cell_metric(cell, PL_METRIC_DISCRETE_ERROR).state == PL_METRIC_VALUE;
}

/* Adds the error of the time-stepping rule, and the rest: the error of contacts and friction. */
static void add_time_stepping(const pl_result_table *results, pl_document *document)
{
    pl_table table = {0};
    pl_table_columns(&table, "case|engine|rule, as detected|>error against the right answer|"
                             ">against its own rule: contact");
    for (int i = 0; i < results->cell_count; ++i) {
        const pl_result_cell *cell = &results->cells[i];
        const pl_metric_summary rule = pl_result_cell_metric(cell, PL_METRIC_INTEGRATOR);
        if (!has_both_errors(cell)) {
            continue;
        }
        pl_table_add(&table, results->cases[cell->test_case].name);
        pl_table_add(&table, results->configurations[cell->configuration].name);
        pl_table_add(&table, rule.state == PL_METRIC_TEXT ? rule.text : "not detected");
        add_metric(cell, PL_METRIC_REFERENCE_ERROR, &table);
        add_metric(cell, PL_METRIC_DISCRETE_ERROR, &table);
    }
    if (pl_table_rows(&table) > 0) {
        pl_document_heading(document, "Time stepping and contact");
        pl_document_paragraph(
            document,
            "The error against the right answer has two parts. A time-stepping rule has an error "
            "even where every force is right: semi-implicit Euler, of first order, always; a rule "
            "of second order where a body stops within a step. Compared with the exact answer of "
            "the engine's own rule at the same step that part is gone, and the rest comes from "
            "contacts and friction. The rule is detected from the frames: semi-implicit Euler, x' "
            "= x + h v', or a rule of second order, x' = x + h (v + v')/2, which is exact for a "
            "constant force. Where none was detected, the answer is the same by either.");
    }
    pl_document_table(document, "Both errors of each run", &table);
}

static void add_failures(const pl_result_table *results, pl_document *document)
{
    pl_table table = {.keys = 2};
    pl_table_columns(&table, "case|engine|verdict|reason");
    for (int i = 0; i < results->cell_count; ++i) {
        const pl_result_cell *cell = &results->cells[i];
        const char *why = pl_cell_why(cell);
        char verdict[PL_CELL_VERDICT_SIZE];
        if (pl_result_cell_is_ok(cell) && cell->worst->verdict != PL_VERDICT_FAILED) {
            continue;
        }
        pl_cell_verdict(cell, verdict);
        pl_table_add(&table, results->cases[cell->test_case].name);
        pl_table_add(&table, results->configurations[cell->configuration].name);
        pl_table_add(&table, verdict);
        pl_table_add(&table, why[0] != '\0' ? why : "no reason was recorded");
    }
    pl_document_heading(document, "Failed runs");
    if (pl_table_rows(&table) == 0) {
        pl_document_paragraph(document, "No run failed.");
    }
    pl_document_table(document, "Failed runs", &table);
}

/* Adds what the engine was set to, as a cell: "iterations = 20, erp = 0.2". */
static void add_settings(const json_t *settings, pl_table *table)
{
    pl_text_buffer text = {0};
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)settings, name, value)
    {
        if (strcmp(name, "dt") == 0 || strcmp(name, "duration") == 0) {
            continue;
        }
        pl_text_format(&text, "%s%s = ", text.length > 0 ? ", " : "", name);
        if (json_is_integer(value)) {
            pl_text_format(&text, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        } else if (json_is_real(value)) {
            pl_text_format(&text, "%.6g", json_real_value(value));
        } else {
            pl_text_add(&text, json_is_string(value) ? json_string_value(value) : pl_no_number);
        }
    }
    char *whole = pl_text_take(&text);
    pl_table_add(table, whole[0] != '\0' ? whole : "none are recorded");
    free(whole);
}

/* The settings are too long for a terminal. */
static void add_engines(const pl_result_table *results, pl_reader reader, pl_document *document)
{
    const bool has_settings = reader != PL_READER_TERMINAL;
    pl_table table = {.indent = PL_SECTION_INDENT};
    pl_table_columns(&table, has_settings ? "engine|version|conformance|settings"
                                          : "engine|version|conformance");
    for (int i = 0; i < results->configuration_count; ++i) {
        char *conformance = pl_conformance_text(results, i);
        pl_table_add(&table, results->configurations[i].name);
        pl_table_add(&table, results->configurations[i].version);
        pl_table_add(&table, conformance);
        if (has_settings) {
            add_settings(json_object_get(pl_first_run(results, i)->result, "settings"), &table);
        }
        free(conformance);
    }
    pl_document_heading(document, has_settings ? "Engines and their settings" : "Engines");
    if (has_settings) {
        pl_document_paragraph(
            document,
            "As recorded with the first run of each engine. Conformance is what plumb check-engine "
            "found of the engine and its adapter by small scenes that each catch one mistake, for "
            "the engine's very binary and the profile's default options. \"Not verified\" means "
            "that nothing is known: a deviation may be the adapter's. A label names the profile "
            "and, after it, every option that was set off that profile's default; time step and "
            "duration belong to the case.");
    }
    pl_document_table(document, "Engines", &table);
}

/* What every reader is told of the results themselves; a page shows them in its own way. */
static void add_results(const pl_report *report, pl_reader reader, pl_document *document)
{
    add_head(report->results, document);
    if (reader == PL_READER_SUMMARY) {
        pl_section_verdicts(report->results, document);
    }
    add_home(report, reader, document);
    add_warnings(report->results, document);
    if (reader == PL_READER_SUMMARY) {
        pl_section_matrix(report->results, document);
    } else {
        pl_section_cases(report->results, document);
    }
}

void pl_report_document(const pl_report *report, pl_reader reader, pl_document *document)
{
    const pl_result_table *results = report->results;
    document->title = "Plumb report";
    if (results->case_count == 0) {
        pl_document_paragraph(document, "There are no results.");
        return;
    }
    if (reader == PL_READER_PAGE) {
        add_home(report, reader, document);
    } else {
        add_results(report, reader, document);
    }
    pl_findings_describe(&report->findings, false, 0, reader == PL_READER_TERMINAL, document);
    if (reader == PL_READER_TERMINAL) {
        add_engines(results, reader, document);
        pl_section_verdicts(results, document);
        return;
    }
    add_time_stepping(results, document);
    pl_section_published(results, document);
    if (reader == PL_READER_SUMMARY) {
        add_failures(results, document);
    }
    add_engines(results, reader, document);
}
