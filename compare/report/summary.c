#include "summary.h"

#include "adapter_trust.h"
#include "base/heap.h"
#include "base/number_format.h"
#include "base/program_name.h"
#include "cell_verdict.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN_LOSSES = 20 };

pl_status pl_report_build(const pl_result_table *results, pl_report *report, pl_error *error)
{
    *report = (pl_report){.results = results};
    pl_verdict_counts_make(results, &report->verdicts);
    pl_losses_find(results, &report->losses);
    return pl_engine_findings_find(results, &report->findings, error);
}

void pl_report_free(pl_report *report)
{
    pl_engine_findings_free(&report->findings);
    pl_losses_free(&report->losses);
    pl_verdict_counts_free(&report->verdicts);
}

/* ---- Markdown ---- */

static void add_heading(pl_text_buffer *out, const char *text)
{
    pl_text_add(out, "## ");
    pl_text_add_markdown(out, text);
    pl_text_add(out, "\n\n");
}

static void add_paragraph(pl_text_buffer *out, const char *text)
{
    pl_text_add_markdown(out, text);
    pl_text_add(out, "\n\n");
}

static void add_note(pl_text_buffer *out, const char *text)
{
    pl_text_add(out, "<sub>");
    pl_text_add_markdown(out, text);
    pl_text_add(out, "</sub>\n\n");
}

/* Adds a table, which is freed: at most `most` rows, the others folded up; 0: all rows. Nothing
 * where it has no rows. */
static void add_table(pl_text_buffer *out, pl_table table, int most)
{
    const int rows = pl_table_rows(&table);
    table.last = most == 0 || rows < most ? rows : most;
    if (rows > 0) {
        pl_table_write(&table, PL_TABLE_MARKDOWN, out);
        pl_text_add(out, "\n");
    }
    if (rows > table.last) {
        table.first = table.last;
        table.last = rows;
        pl_text_format(out, "<details><summary>%d more</summary>\n\n", rows - table.first);
        pl_table_write(&table, PL_TABLE_MARKDOWN, out);
        pl_text_add(out, "\n</details>\n\n");
    }
    pl_table_free(&table);
}

/* Adds a cell of markup to a table, and frees the markup. */
static void add_markup(pl_table *table, pl_text_buffer *markup)
{
    char *text = pl_text_take(markup);
    pl_table_add_markup(table, text);
    free(text);
}

static void add_engine_columns(const pl_result_table *results, pl_table *table)
{
    for (int i = 0; i < results->configuration_count; ++i) {
        pl_table_column(table, PL_RIGHT, "%s", results->configurations[i].name);
    }
}

/* ---- Head ---- */

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

static void add_markdown_head(const pl_result_table *results, pl_text_buffer *out)
{
    pl_text_add(out, "# Plumb report\n\n");
    if (results->case_count > 0) {
        const json_t *result = results->cases[0].row->result;
        pl_text_format(out, "%d run%s, %d case%s, %d engine%s; ", results->row_count,
                       plural(results->row_count), results->case_count, plural(results->case_count),
                       results->configuration_count, plural(results->configuration_count));
        pl_text_add_markdown(out, pl_result_text(result, "host", "cpu"));
        pl_text_add(out, "; plumb ");
        pl_text_add_markdown(out, pl_result_text(result, PL_PROGRAM, "version"));
        pl_text_add(out, " (");
        pl_text_add_markdown(out, pl_result_text(result, PL_PROGRAM, "git"));
        pl_text_add(out, ")\n\n");
    }
}

/* ---- Verdicts ---- */

static void add_verdicts(const pl_verdict_counts *verdicts, pl_text_buffer *out)
{
    if (verdicts->cases == 0) {
        return;
    }
    pl_table table = pl_verdict_counts_table(verdicts);
    add_heading(out, "Verdicts");
    add_paragraph(out, verdicts->order.data);
    add_table(out, table, 0);
}

/* ---- Losses and warnings ---- */

static void add_losses(const char *home, const pl_losses *losses, pl_text_buffer *out)
{
    if (home == NULL) {
        return;
    }
    pl_table table = {0};
    pl_table_columns(&table, "Case|Metric|Home|>value|Best other|>value|>Ratio");
    for (int i = 0; i < losses->count; ++i) {
        const pl_loss *loss = &losses->items[i];
        char metric[PL_LOSS_TEXT_SIZE], own[PL_LOSS_TEXT_SIZE], best[PL_LOSS_TEXT_SIZE];
        char ratio[PL_LOSS_TEXT_SIZE];
        pl_loss_texts(loss, metric, own, best, ratio);
        pl_table_add(&table, loss->test_case->name);
        pl_table_add(&table, metric);
        pl_table_add(&table, loss->home->name);
        pl_table_add(&table, own);
        pl_table_add(&table, loss->best->name);
        pl_table_add(&table, best);
        pl_table_add(&table, ratio);
    }
    char *heading = pl_heap_format("Where %s loses", home);
    add_heading(out, heading);
    free(heading);
    add_paragraph(out, losses->statement.data);
    add_table(out, table, SHOWN_LOSSES);
    add_note(out, losses->rule.data);
}

/* Adds a run that is not accurate: of the home engine also why. */
static void add_finding(const pl_engine_finding *finding, bool is_home, pl_table *table)
{
    char error[PL_FINDING_TEXT_SIZE];
    const char *cause = NULL, *evidence = NULL;
    pl_engine_finding_texts(finding, error, &cause, &evidence);
    pl_table_add(table, finding->test_case->name);
    pl_table_add(table, finding->configuration->name);
    pl_table_add(table, error);
    if (is_home) {
        pl_table_add(table, pl_cell_why(finding->cell));
    }
    pl_table_add(table, cause);
    pl_table_add(table, evidence);
}

/* Adds the runs of the home engine that are not accurate. */
static void add_home_findings(const pl_engine_findings *findings, pl_text_buffer *out)
{
    pl_table table = {0};
    if (findings->home_runs == 0) {
        return;
    }
    pl_table_columns(&table, "Case|Engine|Error|Why|What in the engine causes it|"
                             "What was varied, and what changed");
    for (int i = 0; i < findings->home_count; ++i) {
        add_finding(&findings->home[i], true, &table);
    }
    add_paragraph(out, findings->home_statement.data);
    add_table(out, table, SHOWN_LOSSES);
}

static void add_warning(pl_text_buffer *out, const char *head, const char *text)
{
    pl_text_format(out, "**%s** %s\n\n", head, text);
}

static void add_warnings(const pl_result_table *results, pl_text_buffer *out)
{
    if (results->several_hosts) {
        add_warning(out, "These runs come from several machines:",
                    "their times cannot be compared with each other.");
    }
    if (results->disagrees) {
        add_warning(out, "Not deterministic:",
                    "some repeats of the same run differ where they should agree. The cells are "
                    "marked.");
    }
}

/* ---- Results ---- */

/* Adds the cell of a run: its primary error, the time of a step and its ratio to the fastest. */
static void add_result(const pl_result_configuration *configuration, const pl_result_cell *cell,
                       double fastest, pl_table *table)
{
    char text[PL_METRIC_TEXT_SIZE], time_text[PL_CELL_TIME_SIZE];
    pl_text_buffer markup = {0};
    if (cell == NULL) {
        pl_table_add(table, "not run");
        return;
    }
    const pl_metric_summary error = pl_result_cell_metric(cell, PL_METRIC_REFERENCE_ERROR);
    const pl_metric_summary time = pl_result_cell_metric(cell, PL_METRIC_TIME_PER_STEP);
    const bool has_time = time.state == PL_METRIC_VALUE;
    if (cell->worst->verdict != PL_VERDICT_ACCURATE) {
        pl_cell_badge(cell, &markup);
        pl_text_add(&markup, " ");
    }
    pl_metric_text(&error, text);
    pl_text_add_markdown(&markup, text);
    if (cell->disagrees) {
        pl_text_add(&markup, " *not deterministic*");
    }
    pl_cell_time_text(configuration, cell, pl_metric_text, time_text);
    pl_text_add(&markup, has_time ? "<br>" : "");
    pl_text_add_markdown(&markup, has_time ? time_text : "");
    if (configuration->runtime != NULL && has_time) {
        pl_text_add(&markup, " in ");
        pl_text_add_markdown(&markup, configuration->runtime);
    } else if (pl_result_cell_is_ok(cell) && has_time && fastest > 0 && isfinite(fastest)) {
        pl_format_ratio(time.value / fastest, text);
        pl_text_format(&markup, " (%s)", text);
    }
    add_markup(table, &markup);
}

static void add_case_name(const pl_result_case *test_case, pl_table *table)
{
    const bool has_primary = test_case->row->primary_error[0] != '\0';
    char bound[PL_QUANTITY_SIZE];
    const char *reason = "";
    pl_text_buffer markup = {0};
    pl_text_add_markdown(&markup, test_case->name);
    pl_text_add(&markup, " (");
    pl_text_add_markdown(&markup, has_primary ? test_case->row->primary_error : "no reference");
    if (pl_case_acceptance(test_case, bound, &reason)) {
        pl_text_add(&markup, ", at most ");
        pl_text_add_markdown(&markup, bound);
    }
    pl_text_add(&markup, ")");
    add_markup(table, &markup);
}

static void add_results(const pl_result_table *results, pl_text_buffer *out)
{
    pl_table table = {0};
    pl_table_columns(&table, "Case (primary error and its bound)");
    add_engine_columns(results, &table);
    for (int i = 0; i < results->case_count; ++i) {
        const pl_result_case *test_case = &results->cases[i];
        double fastest = pl_case_least_time(results, test_case);
        add_case_name(test_case, &table);
        for (int k = 0; k < results->configuration_count; ++k) {
            add_result(&results->configurations[k], pl_result_case_cell(test_case, k), fastest,
                       &table);
        }
    }
    add_heading(out, "Results");
    add_paragraph(
        out, "In each cell the verdict where it is not accurate, the primary error of the "
             "case and, below it, the time of a step, with how many times that of the "
             "fastest native run that is ok. Lower is better for both; a number without a unit "
             "is relative to the right value. Below each case stand its primary error and "
             "the largest value that is accurate.");
    add_paragraph(out,
                  "Times are CPU time of the engine's step call alone, and machines are noisy: "
                  "differences of less than 10 % mean nothing. Repeat runs (--repeat) before "
                  "you trust larger ones.");
    add_table(out, table, 0);
}

/* ---- Findings ---- */

static void add_findings(const pl_engine_findings *findings, pl_text_buffer *out)
{
    pl_table table = {0};
    if (findings->runs == 0) {
        return;
    }
    pl_table_columns(&table, "Case|Engine|Error|What in the engine causes it|"
                             "What was varied, and what changed");
    for (int i = 0; i < findings->count; ++i) {
        add_finding(&findings->items[i], false, &table);
    }
    add_heading(out, "Findings");
    add_paragraph(out, findings->statement.data);
    if (findings->adapters.length > 0) {
        add_paragraph(out, findings->adapters.data);
        add_paragraph(out, findings->read_back.data);
        add_paragraph(out, findings->origin.data);
    }
    add_table(out, table, 0);
}

/* ---- Time stepping ---- */

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
static void add_time_stepping(const pl_result_table *results, pl_text_buffer *out)
{
    pl_table table = {0};
    pl_table_columns(&table, "Case|Engine|Rule, as detected|>Error against the right answer|"
                             ">Against its own rule: contact");
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
        add_heading(out, "Time stepping and contact");
        add_paragraph(
            out,
            "The error against the right answer has two parts. A time-stepping rule has an error "
            "even where every force is right: semi-implicit Euler, of first order, always; a rule "
            "of second order where a body stops within a step. Compared with the exact answer of "
            "the engine's own rule at the same step that part is gone, and the rest comes from "
            "contacts and friction. The rule is detected from the frames: semi-implicit Euler, x' "
            "= x + h v', or a rule of second order, x' = x + h (v + v')/2, which is exact for a "
            "constant force. Where none was detected, the answer is the same by either.");
    }
    add_table(out, table, 0);
}

/* ---- Published numbers ---- */

static bool has_every_case(const pl_suite *suite, const pl_result_table *results)
{
    bool complete = true;
    for (int i = 0; i < suite->entry_count && complete; ++i) {
        complete = false;
        for (int k = 0; k < results->case_count && !complete; ++k) {
            complete = pl_case_is_entry(&results->cases[k], &suite->entries[i]);
        }
    }
    return complete;
}

/* Adds a row for each case of an entry, with the verdict below each engine's value. */
static void add_published_rows(const pl_result_table *results, const pl_suite_entry *entry,
                               int metric, pl_table *table)
{
    for (int i = 0; i < results->case_count; ++i) {
        const pl_result_case *test_case = &results->cases[i];
        char text[PL_METRIC_TEXT_SIZE];
        if (!pl_case_is_entry(test_case, entry)) {
            continue;
        }
        pl_format_given(entry->published, pl_metric_table[metric].unit, text);
        pl_table_add(table, test_case->name);
        pl_table_add(table, text);
        for (int k = 0; k < results->configuration_count; ++k) {
            const pl_result_cell *cell = pl_result_case_cell(test_case, k);
            const bool is_marked = cell != NULL && cell->worst->verdict != PL_VERDICT_ACCURATE;
            char verdict[PL_CELL_VERDICT_SIZE];
            pl_text_buffer markup = {0};
            pl_cell_verdict(cell, verdict);
            if (cell != NULL) {
                const pl_metric_summary summary = pl_result_cell_metric(cell, metric);
                pl_metric_text(&summary, text);
                pl_text_add_markdown(&markup, text);
                pl_text_add(&markup, "<br>");
            }
            pl_text_add(&markup, is_marked ? "**" : "");
            pl_text_add_markdown(&markup, verdict);
            pl_text_add(&markup, is_marked ? "**" : "");
            add_markup(table, &markup);
        }
    }
}

/* Adds the numbers that others published, for suites of which every case was run. Markdown only. */
static void add_published(const pl_result_table *results, pl_text_buffer *out)
{
    int count = 0;
    const pl_suite *suites = pl_suites(&count);
    for (int s = 0; s < count; ++s) {
        const pl_suite *suite = &suites[s];
        pl_table table = {0};
        if (suite->published_metric == NULL || !has_every_case(suite, results)) {
            continue;
        }
        pl_table_columns(&table, "Case|>Published");
        add_engine_columns(results, &table);
        for (int i = 0; i < suite->entry_count; ++i) {
            add_published_rows(results, &suite->entries[i],
                               pl_metric_by_name(suite->published_metric), &table);
        }
        pl_text_add(out, "## Next to published numbers: ");
        pl_text_add_markdown(out, suite->published_metric);
        pl_text_add(out, "\n\n");
        add_table(out, table, 0);
        pl_text_format(out, "<sub>%s: the engine reports none. Published: ", pl_no_number);
        pl_text_add_markdown(out, suite->source);
        pl_text_add(out, ".</sub>\n\n");
    }
}

/* ---- Settings, failed runs and metrics ---- */

static void add_settings(const pl_result_table *results, pl_text_buffer *out)
{
    pl_table table = {0};
    pl_table_columns(&table, "Engine|Version|Conformance|Settings");
    for (int i = 0; i < results->configuration_count; ++i) {
        pl_text_buffer set = {0}, found = {0};
        pl_add_settings(results, i, &set);
        pl_conformance_text(results, i, &found);
        char *settings = pl_text_take(&set), *known = pl_text_take(&found);
        pl_table_add(&table, results->configurations[i].name);
        pl_table_add(&table, results->configurations[i].version);
        pl_table_add(&table, known);
        pl_table_add(&table, settings);
        free(settings);
        free(known);
    }
    add_heading(out, "Engine settings");
    add_paragraph(out, "As recorded with the first run of each engine. Conformance is what plumb "
                       "check-engine found of the engine and its adapter, with the profile's "
                       "default options. A label names the profile "
                       "and, after it, every option that was set off that profile's default; time "
                       "step and duration belong to the case.");
    add_table(out, table, 0);
}

static void add_failures(const pl_result_table *results, pl_text_buffer *out)
{
    pl_table table = {0};
    pl_table_columns(&table, "Case|Engine|Verdict|Reason");
    for (int i = 0; i < results->cell_count; ++i) {
        const pl_result_cell *cell = &results->cells[i];
        const char *why = pl_cell_why(cell);
        pl_text_buffer badge = {0};
        if (pl_result_cell_is_ok(cell) && cell->worst->verdict != PL_VERDICT_FAILED) {
            continue;
        }
        pl_cell_badge(cell, &badge);
        pl_table_add(&table, results->cases[cell->test_case].name);
        pl_table_add(&table, results->configurations[cell->configuration].name);
        add_markup(&table, &badge);
        pl_table_add(&table, why[0] != '\0' ? why : "no reason was recorded");
    }
    add_heading(out, "Failed runs");
    if (pl_table_rows(&table) == 0) {
        add_paragraph(out, "No run failed.");
    }
    add_table(out, table, 0);
}

void pl_report_summary(const pl_report *report, pl_text_buffer *out)
{
    const pl_result_table *results = report->results;
    add_markdown_head(results, out);
    add_verdicts(&report->verdicts, out);
    add_losses(results->home, &report->losses, out);
    add_home_findings(&report->findings, out);
    add_warnings(results, out);
    if (results->case_count == 0) {
        add_paragraph(out, "There are no results.");
        return;
    }
    add_results(results, out);
    add_findings(&report->findings, out);
    add_time_stepping(results, out);
    add_published(results, out);
    add_failures(results, out);
    add_settings(results, out);
}
