/* The results of all runs: for a terminal case by case, in short as a matrix. */
#include "base/heap.h"
#include "sections.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NUMBER_COLUMNS = 4 };

static const pl_metric_id shown[NUMBER_COLUMNS] = {
    PL_METRIC_REFERENCE_ERROR, PL_METRIC_PENETRATION_MAX, PL_METRIC_ITERATIONS_MEAN,
    PL_METRIC_TIME_PER_STEP};

/* Adds a number of a run, with the spread of its repeats; of a configuration that asks for several threads the elapsed
 * time of a step too: "12.3 ms, wall 6.8 ms". */
static void add_number(const pl_result_configuration *configuration, const pl_result_cell *cell,
                       pl_metric_id id, pl_text_buffer *out)
{
    const pl_metric_summary summary = pl_result_cell_metric(cell, (int)id);
    const pl_metric_summary wall = pl_result_cell_metric(cell, PL_METRIC_WALL_TIME_PER_STEP);
    char text[PL_METRIC_TEXT_SIZE];
    pl_metric_spread_text(&summary, text);
    pl_text_add(out, text);
    if (id == PL_METRIC_TIME_PER_STEP && configuration->threads > 1 &&
        wall.state == PL_METRIC_VALUE) {
        pl_metric_spread_text(&wall, text);
        pl_text_format(out, ", wall %s", text);
    }
}

/* Adds the text as a cell, and frees it. */
static void add_cell(pl_table *table, pl_text_buffer *text)
{
    char *whole = pl_text_take(text);
    pl_table_add(table, whole);
    free(whole);
}

/* Adds what the numbers need to be read: spreads, threads, and the mark of an engine that is not native. */
static void add_notes(const pl_result_table *results, pl_document *document)
{
    bool is_marked = false, has_threads = false;
    int repeats = 0;
    for (int i = 0; i < results->configuration_count; ++i) {
        is_marked = is_marked || results->configurations[i].runtime != NULL;
        has_threads = has_threads || results->configurations[i].threads > 1;
    }
    for (int i = 0; i < results->cell_count; ++i) {
        for (int k = 0; k < NUMBER_COLUMNS; ++k) {
            const int count = pl_result_cell_metric(&results->cells[i], (int)shown[k]).count;
            repeats = count > repeats ? count : repeats;
        }
    }
    if (has_threads) {
        pl_document_paragraph(document,
                              "The time of a step is the CPU time of all threads; wall: the "
                              "elapsed time, of an engine that is asked for several.");
    }
    if (is_marked) {
        pl_document_paragraph(document,
                              "* The engine runs in an interpreter or in WebAssembly: its times "
                              "are not those of its native build, and are not ranked.");
    }
    if (repeats > 1) {
        pl_document_paragraph(document,
                              "Each number is the median of %d repeats. ± is the median distance "
                              "of the repeats from it; it is left out where all are equal.",
                              repeats);
    }
}

/* ---- Case by case ---- */

static void add_run(const pl_result_configuration *configuration, const pl_result_cell *cell,
                    pl_table *table)
{
    pl_table_add(table, configuration->name);
    for (int k = 0; k < NUMBER_COLUMNS; ++k) {
        const bool is_marked =
            shown[k] == PL_METRIC_TIME_PER_STEP && configuration->runtime != NULL;
        pl_text_buffer text = {0};
        if (cell == NULL) {
            pl_text_add(&text, pl_no_number);
        } else {
            add_number(configuration, cell, shown[k], &text);
            pl_text_add(&text, is_marked ? " *" : "");
        }
        add_cell(table, &text);
    }
    char verdict[PL_CELL_VERDICT_SIZE];
    const char *why = pl_cell_why(cell);
    pl_cell_verdict(cell, verdict);
    pl_table_format_cell(table, "%s%s%s%.600s", verdict,
                         cell != NULL && cell->disagrees ? " (not deterministic)" : "",
                         why[0] != '\0' ? ": " : "", why);
    pl_table_style(table, pl_cell_style(cell));
}

/* Adds the heading of a case: its title, its primary error and the bound of that. */
static void add_case_heading(const pl_result_case *test_case, pl_table *table)
{
    const pl_scenario *scenario = test_case->row->catalogue;
    const char *title = scenario == NULL ? NULL : scenario->title;
    const char *primary = test_case->row->primary_error;
    char bound[PL_QUANTITY_SIZE];
    const bool is_bounded = isfinite(pl_case_bound(test_case, bound));
    pl_table_add_span(table, "%s%s%s%s%s%s%s", test_case->name, title != NULL ? ": " : "",
                      title != NULL ? title : "",
                      primary[0] != '\0' ? "; error = " : "; no reference", primary,
                      is_bounded ? ", accurate up to " : "", is_bounded ? bound : "");
}

void pl_section_cases(const pl_result_table *results, pl_document *document)
{
    pl_table table = {.indent = PL_SECTION_INDENT};
    pl_table_columns(&table, "engine|>error|>penetration|>iterations|>time/step|verdict");
    for (int i = 0; i < results->case_count; ++i) {
        add_case_heading(&results->cases[i], &table);
        for (int k = 0; k < results->configuration_count; ++k) {
            add_run(&results->configurations[k], pl_result_case_cell(&results->cases[i], k),
                    &table);
        }
    }
    pl_document_table(document, "Results", &table);
    add_notes(results, document);
}

/* ---- In short ---- */

/* The least time of a step over native engines whose outcome is ok; INFINITY without any. */
static double least_time(const pl_result_table *results, const pl_result_case *test_case)
{
    double least = INFINITY;
    for (int i = 0; i < test_case->count; ++i) {
        const pl_result_cell *cell = &test_case->cells[i];
        const pl_metric_summary time = pl_result_cell_metric(cell, PL_METRIC_TIME_PER_STEP);
        if (results->configurations[cell->configuration].runtime == NULL &&
            pl_result_cell_is_ok(cell) && time.state == PL_METRIC_VALUE) {
            least = fmin(least, time.value);
        }
    }
    return least;
}

/* Adds the time of a step and its ratio to the fastest. */
static void add_time(const pl_result_configuration *configuration, const pl_result_cell *cell,
                     double fastest, pl_text_buffer *out)
{
    const pl_metric_summary time = pl_result_cell_metric(cell, PL_METRIC_TIME_PER_STEP);
    char ratio[PL_QUANTITY_SIZE];
    if (time.state != PL_METRIC_VALUE) {
        return;
    }
    pl_text_add(out, "; ");
    add_number(configuration, cell, PL_METRIC_TIME_PER_STEP, out);
    if (configuration->runtime != NULL) {
        pl_text_format(out, " in %s", configuration->runtime);
    } else if (pl_result_cell_is_ok(cell) && fastest > 0 && isfinite(fastest)) {
        pl_format_ratio(time.value / fastest, ratio);
        pl_text_format(out, " (%s)", ratio);
    }
}

static void add_result(const pl_result_configuration *configuration, const pl_result_cell *cell,
                       double fastest, pl_table *table)
{
    char verdict[PL_CELL_VERDICT_SIZE];
    pl_text_buffer text = {0};
    pl_cell_verdict(cell, verdict);
    if (cell == NULL) {
        pl_table_add(table, verdict);
        return;
    }
    if (cell->worst->verdict != PL_VERDICT_ACCURATE) {
        pl_text_format(&text, "%s, ", verdict);
    }
    add_number(configuration, cell, PL_METRIC_REFERENCE_ERROR, &text);
    pl_text_add(&text, cell->disagrees ? ", not deterministic" : "");
    add_time(configuration, cell, fastest, &text);
    add_cell(table, &text);
}

static void add_case_name(const pl_result_case *test_case, pl_table *table)
{
    const char *primary = test_case->row->primary_error;
    char bound[PL_QUANTITY_SIZE];
    const bool is_bounded = isfinite(pl_case_bound(test_case, bound));
    pl_table_format_cell(table, "%s (%s%s%s)", test_case->name,
                         primary[0] != '\0' ? primary : "no reference",
                         is_bounded ? ", at most " : "", is_bounded ? bound : "");
}

void pl_section_matrix(const pl_result_table *results, pl_document *document)
{
    pl_table table = {0};
    pl_table_columns(&table, "case (primary error and its bound)");
    for (int i = 0; i < results->configuration_count; ++i) {
        pl_table_column(&table, PL_RIGHT, "%s", results->configurations[i].name);
    }
    for (int i = 0; i < results->case_count; ++i) {
        const pl_result_case *test_case = &results->cases[i];
        const double fastest = least_time(results, test_case);
        add_case_name(test_case, &table);
        for (int k = 0; k < results->configuration_count; ++k) {
            add_result(&results->configurations[k], pl_result_case_cell(test_case, k), fastest,
                       &table);
        }
    }
    pl_document_heading(document, "Results");
    pl_document_paragraph(
        document,
        "In each cell the verdict where it is not accurate, the primary error of the case and the "
        "time of a step, with how many times that of the fastest native run that is ok. Lower is "
        "better for both; a number without a unit is relative to the right value. Next to each "
        "case stand its primary error and the largest value that is accurate.");
    pl_document_paragraph(
        document,
        "Times are CPU time of the engine's step call alone, and machines are noisy: differences "
        "of less than 10 %% mean nothing. Repeat runs (--repeat) before you trust larger ones.");
    pl_document_table(document, "Results", &table);
}
