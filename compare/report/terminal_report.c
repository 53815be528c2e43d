/* The report for a terminal: lines and tables are folded to its width, and nothing is cut off. */
#include "adapter_trust.h"
#include "base/folding.h"
#include "base/heap.h"
#include "base/number_format.h"
#include "base/table.h"
#include "cell_verdict.h"
#include "report.h"
#include "summary.h"

#include <stdlib.h>
#include <string.h>

enum { NUMBER_COLUMNS = 4, SHOWN_LOSSES = 5, INDENT = 2 };

static const pl_metric_id shown[NUMBER_COLUMNS] = {
    PL_METRIC_REFERENCE_ERROR, PL_METRIC_PENETRATION_MAX, PL_METRIC_ITERATIONS_MEAN,
    PL_METRIC_TIME_PER_STEP};

static const char *const plain = "\033[0m", *const bold = "\033[1m", *const red = "\033[31m";

typedef struct terminal {
    pl_text_buffer *out;
    bool colour;
    int width;
} terminal;

/* Adds a line, folded to the width. */
static void add_line(const terminal *to, const char *colour, const char *line)
{
    pl_text_buffer buffer = {0};
    pl_text_add_plain(&buffer, line, strlen(line));
    char *text = pl_text_take(&buffer);
    pl_text_add(to->out, to->colour ? colour : "");
    pl_text_add_folded(to->out, text, to->width);
    pl_text_add(to->out, to->colour && colour[0] != '\0' ? plain : "");
    pl_text_add(to->out, "\n");
    free(text);
}

static void add_text(const terminal *to, const char *line)
{
    add_line(to, "", line);
}

/* Adds the runs of the home engine that are not accurate. */
static void add_home_findings(const pl_engine_findings *findings, const terminal *to)
{
    if (findings->home_count == 0) {
        return;
    }
    add_text(to, findings->home_statement.data);
    for (int i = 0; i < findings->home_count; ++i) {
        const pl_engine_finding *finding = &findings->home[i];
        const char *why = pl_cell_why(finding->cell);
        char verdict[PL_CELL_VERDICT_SIZE], line[1600];
        pl_cell_verdict(finding->cell, verdict);
        snprintf(line, sizeof line, "  %.250s, %.250s: %s%s%.600s", finding->test_case->name,
                 finding->configuration->name, verdict, why[0] != '\0' ? ": " : "", why);
        add_line(to, red, line);
    }
}

/* The counts of more than one case; of one the table is above. */
static void add_verdicts(const pl_verdict_counts *verdicts, const terminal *to)
{
    if (verdicts->cases < 2) {
        return;
    }
    pl_table table = pl_verdict_counts_table(verdicts);
    pl_text_add(to->out, "\n");
    add_line(to, bold, "Verdicts");
    add_text(to, verdicts->order.data);
    table.indent = INDENT;
    table.colour = to->colour;
    table.line_width = to->width;
    pl_table_write(&table, PL_TABLE_TEXT, to->out);
    pl_table_free(&table);
}

static void add_losses(const char *home, const pl_losses *losses, const terminal *to)
{
    if (home == NULL) {
        return;
    }
    char *heading = pl_heap_format("Where %s loses", home);
    add_line(to, bold, heading);
    free(heading);
    add_text(to, losses->statement.data);
    for (int i = 0; i < losses->count && i < SHOWN_LOSSES; ++i) {
        const pl_loss *loss = &losses->items[i];
        char metric[PL_LOSS_TEXT_SIZE], own[PL_LOSS_TEXT_SIZE], best[PL_LOSS_TEXT_SIZE];
        char ratio[PL_LOSS_TEXT_SIZE], line[1600];
        pl_loss_texts(loss, metric, own, best, ratio);
        snprintf(line, sizeof line, "  %s  %s: %s  %s %s, %s %s", ratio, loss->test_case->name,
                 metric, loss->home->name, own, loss->best->name, best);
        add_line(to, red, line);
    }
    if (losses->count > SHOWN_LOSSES) {
        pl_text_format(to->out, "  and %d more\n", losses->count - SHOWN_LOSSES);
    }
}

/* Adds what is known of the engines' adapters. */
static void add_engines(const pl_result_table *results, const terminal *to)
{
    if (results->configuration_count == 0) {
        return;
    }
    pl_text_add(to->out, "\n");
    add_line(to, bold, "Engines");
    for (int i = 0; i < results->configuration_count; ++i) {
        pl_text_buffer line = {0};
        pl_text_format(&line, "  %s %s: ", results->configurations[i].name,
                       results->configurations[i].version);
        pl_conformance_text(results, i, &line);
        char *text = pl_text_take(&line);
        add_text(to, text);
        free(text);
    }
}

/* The evidence of the causes is on the pages only. */
static void add_findings(const pl_engine_findings *findings, const terminal *to)
{
    if (findings->runs == 0) {
        return;
    }
    pl_text_add(to->out, "\n");
    add_line(to, bold, "Findings");
    add_text(to, findings->statement.data);
    if (findings->adapters.length > 0) {
        add_text(to, findings->adapters.data);
        add_text(to, findings->read_back.data);
        add_text(to, findings->origin.data);
    }
    for (int i = 0; i < findings->count; ++i) {
        const pl_engine_finding *finding = &findings->items[i];
        char error[PL_FINDING_TEXT_SIZE], line[1600];
        const char *cause = NULL, *evidence = NULL;
        pl_engine_finding_texts(finding, error, &cause, &evidence);
        snprintf(line, sizeof line, "  %.250s, %.250s: %s: %s", finding->test_case->name,
                 finding->configuration->name, error, cause);
        add_text(to, line);
    }
}

/* Adds a number of a run. */
static void add_number(const pl_result_configuration *configuration, const pl_result_cell *cell,
                       pl_metric_id id, pl_table *table)
{
    const bool is_time = id == PL_METRIC_TIME_PER_STEP;
    const pl_metric_summary summary = pl_result_cell_metric(cell, id);
    char text[PL_CELL_TIME_SIZE];
    if (is_time) {
        pl_cell_time_text(configuration, cell, pl_metric_spread_text, text);
    } else {
        pl_metric_spread_text(&summary, text);
    }
    pl_table_format_cell(table, "%s%s", text,
                         is_time && configuration->runtime != NULL ? " *" : "");
}

static void add_run(const pl_result_configuration *configuration, const pl_result_cell *cell,
                    pl_table *table)
{
    const bool run = cell != NULL;
    pl_table_add(table, configuration->name);
    for (int k = 0; k < NUMBER_COLUMNS; ++k) {
        if (run) {
            add_number(configuration, cell, shown[k], table);
        } else {
            pl_table_add(table, pl_no_number);
        }
    }
    char verdict[PL_CELL_VERDICT_SIZE];
    const char *why = pl_cell_why(cell);
    pl_cell_verdict(cell, verdict);
    pl_table_format_cell(table, "%s%s%s%.600s", verdict,
                         run && cell->disagrees ? " (not deterministic)" : "",
                         why[0] != '\0' ? ": " : "", why);
    pl_table_style(table, pl_cell_style(cell));
}

/* The largest number of repeats that a number shown is the median of. */
static int most_repeats(const pl_result_table *results)
{
    int most = 0;
    for (int i = 0; i < results->cell_count; ++i) {
        for (int k = 0; k < NUMBER_COLUMNS; ++k) {
            const int count = pl_result_cell_metric(&results->cells[i], shown[k]).count;
            most = count > most ? count : most;
        }
    }
    return most;
}

/* Adds a heading for each case, and a line for each engine below it. */
static void add_cases(const pl_result_table *results, const terminal *to)
{
    pl_table table = {.indent = INDENT, .line_width = to->width, .colour = to->colour};
    pl_table_columns(&table, "engine|>error|>penetration|>iterations|>time/step|verdict");
    for (int i = 0; i < results->case_count; ++i) {
        for (int k = 0; k < results->configuration_count; ++k) {
            add_run(&results->configurations[k], pl_result_case_cell(&results->cases[i], k),
                    &table);
        }
    }
    for (int i = 0; i < results->case_count; ++i) {
        const pl_result_case *test_case = &results->cases[i];
        const char *title =
            test_case->row->catalogue == NULL ? NULL : test_case->row->catalogue->title;
        char line[800], bound[PL_QUANTITY_SIZE];
        const char *reason = NULL;
        const bool is_bounded = pl_case_acceptance(test_case, bound, &reason);
        snprintf(line, sizeof line, "%s%s%s%s%s%s%s", test_case->name, title != NULL ? ": " : "",
                 title != NULL ? title : "",
                 test_case->row->primary_error[0] != '\0' ? "; error = " : "; no reference",
                 test_case->row->primary_error, is_bounded ? ", accurate up to " : "",
                 is_bounded ? bound : "");
        pl_text_add(to->out, "\n");
        add_line(to, bold, line);
        table.first = i * results->configuration_count;
        table.last = table.first + results->configuration_count;
        pl_table_write(&table, PL_TABLE_TEXT, to->out);
    }
    pl_table_free(&table);
    bool is_marked = false, has_threads = false;
    for (int i = 0; i < results->configuration_count; ++i) {
        is_marked = is_marked || results->configurations[i].runtime != NULL;
        has_threads = has_threads || results->configurations[i].threads > 1;
    }
    if (has_threads) {
        pl_text_add(to->out, "\n");
        add_text(to,
                 "The time of a step is the CPU time of all threads; wall: the elapsed time, of an "
                 "engine that is asked for several.");
    }
    if (is_marked) {
        pl_text_add(to->out, "\n");
        add_text(
            to, "* The engine runs in an interpreter or in WebAssembly: its times are not those of "
                "its native build, and are not ranked.");
    }
    const int repeats = most_repeats(results);
    if (repeats > 1) {
        char line[200];
        snprintf(line, sizeof line,
                 "Each number is the median of %d repeats. ± is the median distance of the repeats "
                 "from it; it is left out where all are equal.",
                 repeats);
        pl_text_add(to->out, "\n");
        add_text(to, line);
    }
}

void pl_report_print_table(FILE *out, const pl_result_table *results, bool colour, int width)
{
    pl_report report;
    pl_text_buffer text = {0};
    pl_error error = {PL_OK, ""};
    const terminal to = {
        .out = &text, .colour = colour, .width = width < PL_LEAST_WINDOW ? PL_LEAST_WINDOW : width};
    if (pl_report_build(results, &report, &error) == PL_OK) {
        add_losses(results->home, &report.losses, &to);
        add_home_findings(&report.findings, &to);
        add_cases(results, &to);
        add_engines(results, &to);
        add_findings(&report.findings, &to);
        add_verdicts(&report.verdicts, &to);
    } else {
        pl_text_format(&text, "no table: %s\n", error.message);
    }
    pl_text_print(&text, out);
    pl_report_free(&report);
}
