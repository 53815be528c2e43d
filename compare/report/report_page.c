#include "report_page.h"

#include "adapter_trust.h"
#include "case_page.h"
#include "cell_verdict.h"
#include "engine_words.h"
#include "number_format.h"
#include "page.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHOWN_LOSSES = 20, SHOWN_TIMES = 12 };

pl_status pl_report_build(const json_t *results, pl_report *report, pl_error *error)
{
    *report = (pl_report){0};
    pl_status status = pl_result_matrix_build(results, &report->matrix, error);
    if (status == PL_OK) {
        status = pl_verdict_counts_make(&report->matrix, &report->verdicts, error);
    }
    if (status == PL_OK) {
        status = pl_losses_find(&report->matrix, &report->losses, error);
    }
    if (status == PL_OK) {
        status = pl_engine_findings_find(&report->matrix, &report->findings, error);
    }
    return status;
}

void pl_report_free(pl_report *report)
{
    pl_engine_findings_free(&report->findings);
    pl_losses_free(&report->losses);
    pl_verdict_counts_free(&report->verdicts);
    pl_result_matrix_free(&report->matrix);
}

/* ---- Head ---- */

/* Adds a fact that may differ between results: each value once, sorted. */
static void add_distinct(const pl_result_matrix *matrix, const char *name, const char *object,
                         const char *key, pl_text_buffer *out)
{
    enum { MOST = 16 };
    const char *seen[MOST];
    int count = 0;
    for (size_t i = 0; i < json_array_size(matrix->results); ++i) {
        const char *text = pl_result_text(json_array_get(matrix->results, i), object, key);
        int place = 0;
        while (place < count && strcmp(seen[place], text) < 0) {
            ++place;
        }
        if (text[0] == '\0' || count == MOST || (place < count && strcmp(seen[place], text) == 0)) {
            continue;
        }
        memmove(&seen[place + 1], &seen[place], (size_t)(count - place) * sizeof seen[0]);
        seen[place] = text;
        ++count;
    }
    if (count == 0) {
        return;
    }
    pl_text_add_element(out, "<dt>", name, "</dt><dd>");
    for (int i = 0; i < count; ++i) {
        pl_text_add_element(out, i == 0 ? "" : "; ", seen[i], "");
    }
    pl_text_add(out, count == MOST ? " and perhaps more</dd>\n" : "</dd>\n");
}

static void add_command(const json_t *result, pl_text_buffer *out)
{
    const json_t *command = json_object_get(result, "command");
    if (json_array_size(command) == 0) {
        return;
    }
    pl_text_add(out, "<dt>Command</dt><dd><code>");
    for (size_t i = 0; i < json_array_size(command); ++i) {
        const char *word = json_string_value(json_array_get(command, i));
        pl_text_add_element(out, i == 0 ? "" : " ", word == NULL ? "" : word, "");
    }
    pl_text_add(out, "</code></dd>\n");
}

static void add_dates(const pl_result_matrix *matrix, pl_text_buffer *out)
{
    const char *first = "", *last = "";
    for (size_t i = 0; i < json_array_size(matrix->results); ++i) {
        const char *started = pl_json_get_text(json_array_get(matrix->results, i), "started");
        if (started[0] != '\0' && (first[0] == '\0' || strcmp(started, first) < 0)) {
            first = started;
        }
        if (strcmp(started, last) > 0) {
            last = started;
        }
    }
    if (first[0] != '\0') {
        pl_text_add_element(out, "<dt>Started</dt><dd>", first, "");
        pl_text_add_element(out, strcmp(first, last) == 0 ? "" : " to ",
                            strcmp(first, last) == 0 ? "" : last, " (UTC)</dd>\n");
    }
}

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

static void add_html_head(const pl_result_matrix *matrix, pl_text_buffer *out)
{
    static const char *const facts[][3] = {
        {"Processor", "host", "cpu"},     {"System", "host", "os"},
        {"Compiler", "host", "compiler"}, {"Flags", "host", "flags"},
        {"Plumb", "plumb", "version"},    {"Commit", "plumb", "git"}};
    pl_page_open(out, "Plumb report", NULL);
    pl_text_format(
        out,
        "<h1>Plumb report</h1>\n<p class=\"lead\">How far each rigid-body engine is from "
        "the right answer, and at what cost: %d run%s of %d case%s on %d engine%s.</p>\n"
        "<dl class=\"facts\">\n",
        matrix->run_count, plural(matrix->run_count), matrix->case_count,
        plural(matrix->case_count), matrix->column_count, plural(matrix->column_count));
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; ++i) {
        add_distinct(matrix, facts[i][0], facts[i][1], facts[i][2], out);
    }
    add_dates(matrix, out);
    if (matrix->case_count > 0) {
        add_command(matrix->cases[0].result, out);
    }
    pl_text_add(out, "<dt>Engines</dt><dd>");
    for (int i = 0; i < matrix->column_count; ++i) {
        pl_text_buffer known = {0};
        pl_conformance_text(matrix, i, &known);
        pl_text_add_element(out, i == 0 ? "" : "<br>", matrix->columns[i].label, " ");
        pl_text_add_element(out, "", matrix->columns[i].version, ": ");
        pl_text_add_html(out, known.data == NULL ? "" : known.data);
        out->failed |= known.failed;
        pl_text_free(&known);
    }
    pl_text_add(out, "</dd>\n</dl>\n");
}

static void add_markdown_head(const pl_result_matrix *matrix, pl_text_buffer *out)
{
    pl_text_add(out, "# Plumb report\n\n");
    if (matrix->case_count > 0) {
        const json_t *result = matrix->cases[0].result;
        pl_text_format(out, "%d run%s, %d case%s, %d engine%s; ", matrix->run_count,
                       plural(matrix->run_count), matrix->case_count, plural(matrix->case_count),
                       matrix->column_count, plural(matrix->column_count));
        pl_text_add_markdown(out, pl_result_text(result, "host", "cpu"));
        pl_text_add(out, "; plumb ");
        pl_text_add_markdown(out, pl_result_text(result, "plumb", "version"));
        pl_text_add(out, " (");
        pl_text_add_markdown(out, pl_result_text(result, "plumb", "git"));
        pl_text_add(out, ")\n\n");
    }
}

/* ---- Verdicts ---- */

static void add_verdicts(const pl_verdict_counts *verdicts, const pl_page *page)
{
    if (verdicts->cases == 0) {
        return;
    }
    pl_table table = pl_verdict_counts_table(verdicts, page->html);
    table.caption = verdicts->order.data;
    pl_page_heading(page, "verdicts", "Verdicts");
    if (!page->html) {
        pl_page_paragraph(page, "", verdicts->order.data);
    }
    pl_page_table(page, table, 0);
}

/* ---- Losses and warnings ---- */

static void add_losses(const pl_losses *losses, const pl_page *page)
{
    if (!losses->ours_present) {
        return;
    }
    pl_table table = {0};
    pl_table_columns(&table, "Case|Metric|Ours|>value|Best other|>value|>Ratio");
    for (int i = 0; i < losses->count; ++i) {
        const pl_loss *loss = &losses->items[i];
        char metric[PL_LOSS_TEXT_SIZE], ours[PL_LOSS_TEXT_SIZE], best[PL_LOSS_TEXT_SIZE];
        char ratio[PL_LOSS_TEXT_SIZE], note[PL_METRIC_NOTE_SIZE];
        pl_loss_texts(loss, metric, ours, best, ratio);
        snprintf(note, sizeof note, "%.600s", loss->our_cell->reason);
        if (loss->kind != PL_LOSS_OUTCOME) {
            pl_metric_note(&loss->our_cell->metrics[loss->metric], note);
        }
        pl_table_add(&table, loss->test_case->name);
        pl_table_add(&table, metric);
        pl_table_add(&table, loss->ours->name);
        pl_table_add(&table, ours);
        pl_table_style(&table, loss->kind == PL_LOSS_OUTCOME ? "bad" : NULL, note);
        pl_table_add(&table, loss->best->name);
        pl_table_add(&table, best);
        pl_table_add(&table, ratio);
    }
    pl_page_heading(page, "losses", "Where plumb loses");
    pl_page_paragraph(page, "verdict", losses->statement.data);
    pl_page_table(page, table, SHOWN_LOSSES);
    pl_page_paragraph(page, "note", losses->rule.data);
}

/* Adds a run that is not accurate: why, of our own engine; of another the cause, and its evidence. */
static void add_finding(const pl_engine_finding *finding, bool ours, pl_table *table)
{
    char error[PL_FINDING_TEXT_SIZE];
    const char *cause = NULL, *evidence = NULL;
    pl_engine_finding_texts(finding, error, &cause, &evidence);
    pl_table_add(table, finding->test_case->name);
    pl_table_add(table, finding->column->name);
    pl_table_add(table, error);
    pl_table_style(table, pl_cell_style(finding->cell), NULL);
    pl_table_add(table, ours ? pl_cell_why(finding->cell) : cause);
    pl_table_style(table, "why", NULL);
    if (!ours) {
        pl_table_add(table, evidence);
        pl_table_style(table, "why", NULL);
    }
}

/* Adds the runs of our own engine that are not accurate. */
static void add_our_findings(const pl_engine_findings *findings, const pl_page *page)
{
    pl_table table = {0};
    if (findings->our_runs == 0) {
        return;
    }
    pl_table_columns(&table, "Case|Engine|Error|Why");
    for (int i = 0; i < findings->our_count; ++i) {
        add_finding(&findings->ours[i], true, &table);
    }
    pl_page_paragraph(page, "verdict", findings->our_statement.data);
    pl_page_table(page, table, SHOWN_LOSSES);
}

static void add_warning(const pl_page *page, const char *head, const char *text)
{
    pl_text_format(page->out, page->html ? "<p class=\"warn\"><b>%s</b> %s</p>\n" : "**%s** %s\n\n",
                   head, text);
}

static void add_warnings(const pl_result_matrix *matrix, const pl_page *page)
{
    if (matrix->several_hosts) {
        add_warning(page, "These runs come from several machines:",
                    "their times cannot be compared with each other.");
    }
    if (matrix->disagrees) {
        add_warning(page, "Not deterministic:",
                    "some repeats of the same run differ where they should agree. The cells are "
                    "marked.");
    }
}

/* ---- Results ---- */

/* Adds the cell of a run: its primary error, the time of a step and its ratio to the fastest. */
static void add_result(const pl_page *page, const pl_cell *cell, double fastest, pl_table *table)
{
    const pl_metric_summary *error = &cell->metrics[PL_METRIC_REFERENCE_ERROR];
    const pl_metric_summary *time = &cell->metrics[PL_METRIC_TIME_PER_STEP];
    const bool html = page->html;
    char text[PL_METRIC_TEXT_SIZE], note[PL_METRIC_NOTE_SIZE];
    pl_text_buffer markup = {0};
    const pl_page cell_page = {.out = &markup, .html = html};
    if (cell->result == NULL) {
        pl_table_add(table, "not run");
        pl_table_style(table, "none", NULL);
        return;
    }
    if (cell->verdict != PL_VERDICT_ACCURATE) {
        pl_cell_badge(&cell_page, cell);
        pl_text_add(&markup, html ? "<br>" : " ");
    }
    pl_metric_text(error, text);
    if (!html || cell->ok || error->state == PL_METRIC_VALUE) {
        pl_page_text(&cell_page, text);
    }
    if (pl_cell_disagrees(cell)) {
        pl_text_add(&markup, html ? PL_CELL_DISAGREES : " *not deterministic*");
    }
    pl_metric_text(time, text);
    const bool has_time = time->state == PL_METRIC_VALUE;
    pl_text_add(&markup, html ? "<span class=\"time\">" : has_time ? "<br>" : "");
    pl_page_text(&cell_page, has_time || (html && cell->ok) ? text : "");
    if (cell->ok && has_time && fastest > 0 && isfinite(fastest)) {
        pl_format_ratio(time->value / fastest, text);
        pl_text_format(&markup, html ? " · %s" : " (%s)", text);
    }
    pl_text_add(&markup, html ? "</span>" : "");
    pl_metric_note(error, note);
    if (pl_cell_why(cell)[0] != '\0') {
        snprintf(note, sizeof note, "%.600s", pl_cell_why(cell));
    }
    pl_page_add_markup(table, &markup);
    pl_table_style(table, pl_cell_style(cell), note);
}

static void add_case_name(const pl_page *page, const pl_result_matrix *matrix, int index,
                          pl_table *table)
{
    const pl_case *test_case = &matrix->cases[index];
    char bound[PL_NUMBER_SIZE];
    const char *reason = "";
    pl_text_buffer markup = {0};
    const pl_page cell_page = {.out = &markup, .html = page->html};
    if (page->html) {
        pl_text_format(&markup, "<a href=\"#case-%d\">", index);
    }
    pl_page_text(&cell_page, test_case->name);
    pl_text_add(&markup, page->html ? "</a><br><span class=\"small\">" : " (");
    pl_page_text(&cell_page,
                 test_case->primary_error[0] != '\0' ? test_case->primary_error : "no reference");
    if (pl_case_acceptance(matrix, test_case, bound, &reason)) {
        pl_page_text(&cell_page, ", at most ");
        pl_page_text(&cell_page, bound);
    }
    pl_text_add(&markup, page->html ? "</span>" : ")");
    pl_page_add_markup(table, &markup);
    pl_table_style(table, NULL, reason);
}

static void add_right_answer(const pl_case *test_case, pl_table *table)
{
    pl_text_buffer markup = {0};
    if (test_case->catalogue != NULL) {
        pl_text_add_element(&markup, "", test_case->catalogue->reference, "");
        pl_text_add_element(
            &markup, "<br><span class=\"small\">Source: ", test_case->catalogue->source, "</span>");
    } else {
        pl_text_add(&markup, test_case->primary_error[0] != '\0'
                                 ? "As the scene file expects."
                                 : "None: the scene has no reference.");
    }
    pl_page_add_markup(table, &markup);
    pl_table_style(table, "answer", NULL);
}

static void add_results(const pl_result_matrix *matrix, const pl_page *page)
{
    pl_table table = {0};
    pl_table_columns(&table, page->html ? "Case" : "Case (primary error and its bound)");
    pl_case_columns(matrix, &table);
    if (page->html) {
        pl_table_columns(&table, "The right answer");
    }
    for (int i = 0; i < matrix->case_count; ++i) {
        const pl_case *test_case = &matrix->cases[i];
        double fastest = pl_case_least(test_case, matrix->column_count, PL_METRIC_TIME_PER_STEP);
        add_case_name(page, matrix, i, &table);
        for (int k = 0; k < matrix->column_count; ++k) {
            add_result(page, &test_case->cells[k], fastest, &table);
        }
        if (page->html) {
            add_right_answer(test_case, &table);
        }
    }
    pl_page_heading(page, "results", "Results");
    pl_page_paragraph(page, "",
                      "In each cell the verdict where it is not accurate, the primary error of the "
                      "case and, below it, the time of a step, with how many times that of the "
                      "fastest run that is ok. Lower is better for both; a number without a unit "
                      "is relative to the right value. Below each case stand its primary error and "
                      "the largest value that is accurate.");
    pl_page_paragraph(page, "",
                      "Times are CPU time of the engine's step call alone, and machines are noisy: "
                      "differences of less than 10 % mean nothing. Repeat runs (--repeat) before "
                      "you trust larger ones.");
    pl_page_table(page, table, 0);
}

/* ---- Findings ---- */

static void add_findings(const pl_engine_findings *findings, const pl_page *page)
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
    pl_page_heading(page, "findings", "Findings");
    pl_page_paragraph(page, "verdict", findings->statement.data);
    if (findings->adapters.length > 0) {
        pl_page_paragraph(page, "", findings->adapters.data);
        pl_page_paragraph(page, "", findings->read_back.data);
        pl_page_paragraph(page, "", findings->origin.data);
    }
    pl_page_table(page, table, 0);
}

/* ---- Time stepping ---- */

/* Whether an ok run has both a relative primary error and a discrete_error. */
static bool has_both_errors(const pl_case *test_case, const pl_cell *cell)
{
    const int primary = pl_metric_by_name(test_case->primary_error);
    return cell->ok && (primary == PL_METRIC_TRAVEL_ERROR || primary == PL_METRIC_VALUE_ERROR) &&
           cell->metrics[PL_METRIC_REFERENCE_ERROR].state == PL_METRIC_VALUE &&
           cell->metrics[PL_METRIC_DISCRETE_ERROR].state == PL_METRIC_VALUE;
}

/* Adds the error of the time-stepping rule, and the rest: the error of contacts and friction. */
static void add_time_stepping(const pl_result_matrix *matrix, const pl_page *page)
{
    pl_table table = {0};
    pl_table_columns(&table, "Case|Engine|Rule, as detected|>Error against the right answer|"
                             ">Against its own rule: contact");
    for (int i = 0, k = 0; pl_result_matrix_next(matrix, has_both_errors, &i, &k); ++k) {
        const pl_cell *cell = &matrix->cases[i].cells[k];
        const pl_metric_summary *rule = &cell->metrics[PL_METRIC_INTEGRATOR];
        char text[PL_METRIC_TEXT_SIZE];
        pl_table_add(&table, matrix->cases[i].name);
        pl_table_add(&table, matrix->columns[k].name);
        pl_table_add(&table, rule->state == PL_METRIC_TEXT ? rule->text : "not detected");
        pl_metric_text(&cell->metrics[PL_METRIC_REFERENCE_ERROR], text);
        pl_table_add(&table, text);
        pl_metric_text(&cell->metrics[PL_METRIC_DISCRETE_ERROR], text);
        pl_table_add(&table, text);
    }
    if (pl_table_rows(&table) > 0) {
        pl_page_heading(page, "stepping", "Time stepping and contact");
        pl_page_paragraph(
            page, "",
            "The error against the right answer has two parts. A time-stepping rule has an error "
            "even where every force is right: semi-implicit Euler, of first order, always; a rule "
            "of second order where a body stops within a step. Compared with the exact answer of "
            "the engine's own rule at the same step that part is gone, and the rest comes from "
            "contacts and friction. The rule is detected from the frames: semi-implicit Euler, x' "
            "= x + h v', or a rule of second order, x' = x + h (v + v')/2, which is exact for a "
            "constant force. Where none was detected, the answer is the same by either.");
    }
    pl_page_table(page, table, 0);
}

/* ---- Times ---- */

static bool has_times(const pl_case *test_case, const pl_cell *cell)
{
    (void)test_case;
    return cell->metrics[PL_METRIC_TIME_CREATE].state == PL_METRIC_VALUE;
}

/* Adds CPU and wall time of create, step and read. */
static void add_times(const pl_result_matrix *matrix, const pl_page *page)
{
    static const pl_metric_id shown[] = {PL_METRIC_TIME_CREATE,   PL_METRIC_WALL_TIME_CREATE,
                                         PL_METRIC_TIME_PER_STEP, PL_METRIC_WALL_TIME_PER_STEP,
                                         PL_METRIC_TIME_READ,     PL_METRIC_WALL_TIME_READ};
    pl_table table = {0};
    pl_table_columns(&table, "Case|Engine|>Create, CPU|>wall|>Step, CPU|>wall|>Read, CPU|>wall");
    for (int i = 0, k = 0; pl_result_matrix_next(matrix, has_times, &i, &k); ++k) {
        const pl_cell *cell = &matrix->cases[i].cells[k];
        pl_table_add(&table, matrix->cases[i].name);
        pl_table_add(&table, matrix->columns[k].name);
        for (size_t m = 0; m < sizeof shown / sizeof shown[0]; ++m) {
            char text[PL_METRIC_TEXT_SIZE], note[PL_METRIC_NOTE_SIZE];
            pl_metric_text(&cell->metrics[shown[m]], text);
            pl_metric_note(&cell->metrics[shown[m]], note);
            pl_table_add(&table, text);
            pl_table_style(&table, NULL, note);
        }
    }
    if (pl_table_rows(&table) > 0) {
        pl_page_heading(page, "times", "Times of create, step and read");
        pl_page_paragraph(
            page, "",
            "Create is the call that builds the scene, read are the calls that hand "
            "out the frame and the contacts after each step. A wall time above the "
            "CPU time shows that the engine waited, or that the machine was busy; a "
            "CPU time above the wall time, that several threads worked. Work that "
            "an engine does in create or read is not in the time of its step. The timer "
            "itself takes up to a microsecond of each call.");
    }
    pl_page_table(page, table, SHOWN_TIMES);
}

/* ---- Published numbers ---- */

static bool has_every_case(const pl_suite *suite, const pl_result_matrix *matrix)
{
    bool complete = true;
    for (int i = 0; i < suite->entry_count && complete; ++i) {
        complete = false;
        for (int k = 0; k < matrix->case_count && !complete; ++k) {
            complete = pl_case_is_entry(&matrix->cases[k], &suite->entries[i]);
        }
    }
    return complete;
}

/* Adds a row for each case of an entry, with the verdict below each engine's value. */
static void add_published_rows(const pl_result_matrix *matrix, const pl_suite_entry *entry,
                               int metric, pl_table *table)
{
    for (int i = 0; i < matrix->case_count; ++i) {
        const pl_case *test_case = &matrix->cases[i];
        char text[PL_METRIC_TEXT_SIZE];
        if (!pl_case_is_entry(test_case, entry)) {
            continue;
        }
        pl_format_given(entry->published, pl_metric_table[metric].unit, text);
        pl_table_add(table, test_case->name);
        pl_table_add(table, text);
        for (int k = 0; k < matrix->column_count; ++k) {
            const pl_cell *cell = &test_case->cells[k];
            const char *bold = cell->verdict == PL_VERDICT_ACCURATE ? "" : "**";
            char verdict[PL_CELL_VERDICT_SIZE];
            pl_text_buffer markup = {0};
            pl_cell_verdict(cell, verdict);
            if (cell->result != NULL) {
                pl_metric_text(&cell->metrics[metric], text);
                pl_text_add_markdown(&markup, text);
                pl_text_format(&markup, "<br>%s", bold);
            }
            pl_text_add_markdown(&markup, verdict);
            pl_text_add(&markup, cell->result != NULL ? bold : "");
            pl_page_add_markup(table, &markup);
        }
    }
}

/* Adds the numbers that others published, for suites of which every case was run. Markdown only. */
static void add_published(const pl_result_matrix *matrix, const pl_page *page)
{
    int count = 0;
    const pl_suite *suites = pl_suites(&count);
    for (int s = 0; s < count; ++s) {
        const pl_suite *suite = &suites[s];
        pl_table table = {0};
        if (suite->published_metric == NULL || !has_every_case(suite, matrix)) {
            continue;
        }
        pl_table_columns(&table, "Case|>Published");
        pl_case_columns(matrix, &table);
        for (int i = 0; i < suite->entry_count; ++i) {
            add_published_rows(matrix, &suite->entries[i],
                               pl_metric_by_name(suite->published_metric), &table);
        }
        pl_text_add(page->out, "## Next to published numbers: ");
        pl_text_add_markdown(page->out, suite->published_metric);
        pl_text_add(page->out, "\n\n");
        pl_page_table(page, table, 0);
        pl_text_format(page->out, "<sub>%s: the engine reports none. Published: ", pl_no_number);
        pl_text_add_markdown(page->out, suite->source);
        pl_text_add(page->out, ".</sub>\n\n");
    }
}

/* ---- Settings, failed runs and metrics ---- */

static void add_settings(const pl_result_matrix *matrix, const pl_page *page)
{
    pl_table table = {0};
    pl_table_columns(&table, "Engine|Version|Conformance|Settings");
    for (int i = 0; i < matrix->column_count; ++i) {
        pl_text_buffer settings = {0}, known = {0};
        pl_result_matrix_settings(matrix, i, &settings);
        pl_conformance_text(matrix, i, &known);
        pl_table_add(&table, matrix->columns[i].name);
        pl_table_add(&table, matrix->columns[i].version);
        pl_table_add(&table, known.data == NULL ? "" : known.data);
        pl_table_style(&table, "why", NULL);
        pl_table_add(&table, settings.data == NULL ? "" : settings.data);
        pl_table_style(&table, "why", NULL);
        page->out->failed |= settings.failed || known.failed;
        pl_text_free(&settings);
        pl_text_free(&known);
    }
    pl_page_heading(page, "settings", "Engine settings");
    pl_page_paragraph(page, "",
                      "As recorded with the first run of each engine. Conformance is what plumb "
                      "check-engine found of the engine and its adapter, with the profile's "
                      "default options. A label names the profile "
                      "and, after it, every option that was set off that profile's default; time "
                      "step and duration belong to the case.");
    pl_page_table(page, table, 0);
}

static bool has_failed(const pl_case *test_case, const pl_cell *cell)
{
    (void)test_case;
    return !cell->ok || cell->verdict == PL_VERDICT_FAILED;
}

static void add_failures(const pl_result_matrix *matrix, const pl_page *page)
{
    pl_table table = {0};
    pl_table_columns(&table, page->html ? "Case|Engine|Verdict|Reason and output"
                                        : "Case|Engine|Verdict|Reason");
    for (int i = 0, k = 0; pl_result_matrix_next(matrix, has_failed, &i, &k); ++k) {
        const pl_cell *cell = &matrix->cases[i].cells[k];
        const char *output = pl_json_get_text(cell->result, "output");
        pl_text_buffer badge = {0}, reason = {0};
        const pl_page cell_page = {.out = &badge, .html = page->html};
        const pl_page reason_page = {.out = &reason, .html = page->html};
        pl_cell_badge(&cell_page, cell);
        pl_page_text(&reason_page,
                     pl_cell_why(cell)[0] != '\0' ? pl_cell_why(cell) : "no reason was recorded");
        if (page->html && output[0] != '\0') {
            pl_text_add_element(&reason, "<pre>", output, "</pre>");
        }
        pl_table_add(&table, matrix->cases[i].name);
        pl_table_add(&table, matrix->columns[k].name);
        pl_page_add_markup(&table, &badge);
        pl_page_add_markup(&table, &reason);
        pl_table_style(&table, "why", NULL);
    }
    pl_page_heading(page, "failures", "Failed runs");
    if (pl_table_rows(&table) == 0) {
        pl_page_paragraph(page, "", "No run failed.");
    }
    pl_page_table(page, table, 0);
}

static void add_definitions(pl_text_buffer *out)
{
    static const char *const directions[] = {"lower is better", "higher is better", "no direction"};
    pl_text_add(out, "<h2 id=\"metrics\">Metrics</h2>\n<dl class=\"metrics\">\n");
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        const pl_metric_info *info = &pl_metric_table[id];
        pl_text_add_element(out, "<dt><code>", info->name, "</code> <span class=\"small\">");
        if (strcmp(info->unit, "1") != 0 && info->unit[0] != '\0') {
            pl_text_add_element(out, "", info->unit, ", ");
        }
        pl_text_add(out, directions[info->direction]);
        pl_text_add(out, info->deterministic ? "" : ", measured");
        pl_text_add_element(out, "</span></dt><dd>", info->definition, "</dd>\n");
    }
    pl_text_add(out, "</dl>\n");
}

void pl_report_page(const pl_report *report, bool html, pl_text_buffer *out)
{
    const pl_result_matrix *matrix = &report->matrix;
    const pl_page page = {.out = out, .html = html};
    (html ? add_html_head : add_markdown_head)(matrix, out);
    add_verdicts(&report->verdicts, &page);
    add_losses(&report->losses, &page);
    add_our_findings(&report->findings, &page);
    add_warnings(matrix, &page);
    if (matrix->case_count == 0) {
        pl_page_paragraph(&page, "", "There are no results.");
    } else {
        add_results(matrix, &page);
        add_findings(&report->findings, &page);
        add_time_stepping(matrix, &page);
        if (html) {
            add_times(matrix, &page);
            add_settings(matrix, &page);
            pl_engine_words_add(matrix, &page);
            pl_page_heading(&page, "cases", "Case by case");
            for (int i = 0; i < matrix->case_count; ++i) {
                pl_case_page(matrix, i, out);
            }
            add_failures(matrix, &page);
        } else {
            add_published(matrix, &page);
            add_failures(matrix, &page);
            add_settings(matrix, &page);
        }
    }
    if (html) {
        add_definitions(out);
        pl_text_add(out, pl_method_html);
        pl_page_close(out);
    }
}
