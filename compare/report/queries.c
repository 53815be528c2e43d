#include "queries.h"

#include "base/number_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool pl_case_primary_is(const pl_result_case *test_case, int metric)
{
    return strcmp(test_case->row->primary_error, pl_metric_table[metric].name) == 0;
}

bool pl_case_is_entry(const pl_result_case *test_case, const pl_suite_entry *entry)
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

void pl_cell_time_text(const pl_result_configuration *configuration, const pl_result_cell *cell,
                       void (*write)(const pl_metric_summary *summary,
                                     char text[PL_METRIC_TEXT_SIZE]),
                       char text[PL_CELL_TIME_SIZE])
{
    const pl_metric_summary time = pl_result_cell_metric(cell, PL_METRIC_TIME_PER_STEP);
    const pl_metric_summary wall = pl_result_cell_metric(cell, PL_METRIC_WALL_TIME_PER_STEP);
    char cpu[PL_METRIC_TEXT_SIZE], elapsed[PL_METRIC_TEXT_SIZE] = "";
    const bool is_shown = configuration->threads > 1 && wall.state == PL_METRIC_VALUE;
    write(&time, cpu);
    if (is_shown) {
        write(&wall, elapsed);
    }
    snprintf(text, PL_CELL_TIME_SIZE, "%s%s%s", cpu, is_shown ? ", wall " : "", elapsed);
}

double pl_case_least_time(const pl_result_table *results, const pl_result_case *test_case)
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

void pl_add_engine_names(const pl_result_table *results, bool home, pl_text_buffer *out)
{
    const char *separator = "";
    for (int i = 0; i < results->configuration_count; ++i) {
        if (results->configurations[i].is_home == home) {
            pl_text_format(out, "%s%s", separator, results->configurations[i].name);
            separator = ", ";
        }
    }
}

/* A run of the configuration on the first case that it has. */
static const pl_result_row *first_run(const pl_result_table *results, int configuration)
{
    const pl_result_cell *cell = NULL;
    for (int i = 0; cell == NULL; ++i) {
        cell = pl_result_case_cell(&results->cases[i], configuration);
    }
    return cell->worst;
}

void pl_add_settings(const pl_result_table *results, int configuration, pl_text_buffer *out)
{
    json_t *settings = json_object_get(first_run(results, configuration)->result, "settings");
    const char *name, *separator = "";
    json_t *value;
    json_object_foreach(settings, name, value)
    {
        if (strcmp(name, "dt") == 0 || strcmp(name, "duration") == 0) {
            continue;
        }
        pl_text_format(out, "%s%s = ", separator, name);
        if (json_is_integer(value)) {
            pl_text_format(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        } else if (json_is_real(value)) {
            pl_text_format(out, "%.6g", json_real_value(value));
        } else {
            pl_text_add(out, json_is_string(value) ? json_string_value(value) : pl_no_number);
        }
        separator = ", ";
    }
    if (separator[0] == '\0') {
        pl_text_add(out, "none are recorded");
    }
}
