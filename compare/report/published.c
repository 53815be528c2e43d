/* The numbers that others published, next to those of the engines. */
#include "sections.h"

#include <string.h>

/* Whether the case is that of a suite's entry. */
static bool is_entry(const pl_result_case *test_case, const pl_suite_entry *entry)
{
    const pl_scenario *scenario = test_case->row->catalogue;
    double values[PL_MAX_PARAMS];
    if (scenario == NULL || strcmp(test_case->row->scenario, entry->scenario) != 0 ||
        pl_scenario_values(scenario, &entry->setting, entry->setting == NULL ? 0 : 1, values,
                           NULL) != PL_OK) {
        return false;
    }
    for (int i = 0; i < scenario->param_count; ++i) {
        const char *name = scenario->params[i].name;
        const json_t *value = json_object_get(test_case->row->params, name);
        if (strcmp(name, "dt") != 0 && strcmp(name, "duration") != 0 &&
            (!json_is_number(value) || json_number_value(value) != values[i])) {
            return false;
        }
    }
    return true;
}

/* Adds the value of an engine with its verdict. */
static void add_value(const pl_result_cell *cell, int metric, pl_table *table)
{
    char verdict[PL_CELL_VERDICT_SIZE], text[PL_METRIC_TEXT_SIZE];
    pl_cell_verdict(cell, verdict);
    if (cell == NULL) {
        pl_table_add(table, verdict);
        return;
    }
    const pl_metric_summary summary = pl_result_cell_metric(cell, metric);
    pl_metric_text(&summary, text);
    pl_table_format_cell(table, "%s, %s", text, verdict);
}

/* Adds a row for each case of an entry. Returns whether there is one. */
static bool add_rows(const pl_result_table *results, const pl_suite_entry *entry, int metric,
                     pl_table *table)
{
    const int before = pl_table_rows(table);
    char text[PL_QUANTITY_SIZE];
    pl_format_given(entry->published, pl_metric_table[metric].unit, text);
    for (int i = 0; i < results->case_count; ++i) {
        const pl_result_case *test_case = &results->cases[i];
        if (!is_entry(test_case, entry)) {
            continue;
        }
        pl_table_add(table, test_case->name);
        pl_table_add(table, text);
        for (int k = 0; k < results->configuration_count; ++k) {
            add_value(pl_result_case_cell(test_case, k), metric, table);
        }
    }
    return pl_table_rows(table) > before;
}

static void add_suite(const pl_result_table *results, const pl_suite *suite, pl_document *document)
{
    pl_table table = {0};
    bool is_whole = true;
    pl_table_columns(&table, "case|>published");
    for (int i = 0; i < results->configuration_count; ++i) {
        pl_table_column(&table, PL_RIGHT, "%s", results->configurations[i].name);
    }
    for (int i = 0; i < suite->entry_count && is_whole; ++i) {
        is_whole = add_rows(results, &suite->entries[i], pl_metric_by_name(suite->published_metric),
                            &table);
    }
    if (is_whole) {
        pl_document_heading(document, "Next to published numbers: %s", suite->published_metric);
        pl_document_table(document, suite->published_metric, &table);
        pl_document_paragraph(document, "%s: the engine reports none. Published: %s.", pl_no_number,
                              suite->source);
    }
    pl_table_free(&table);
}

void pl_section_published(const pl_result_table *results, pl_document *document)
{
    int count = 0;
    const pl_suite *suites = pl_suites(&count);
    for (int i = 0; i < count; ++i) {
        if (suites[i].published_metric != NULL) {
            add_suite(results, &suites[i], document);
        }
    }
}
