#include "sections.h"

#include "base/heap.h"
#include "base/text_buffer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool pl_case_primary_is(const pl_result_case *test_case, int metric)
{
    return strcmp(test_case->row->primary_error, pl_metric_table[metric].name) == 0;
}

char *pl_engine_names(const pl_result_table *results, bool home)
{
    pl_text_buffer names = {0};
    for (int i = 0; i < results->configuration_count; ++i) {
        if (results->configurations[i].is_home == home) {
            pl_text_format(&names, "%s%s", names.length > 0 ? ", " : "",
                           results->configurations[i].name);
        }
    }
    return pl_text_take(&names);
}

static bool is_unsupported(const pl_result_cell *cell)
{
    return cell->worst->outcome == PL_OUTCOME_UNSUPPORTED;
}

const char *pl_cell_style(const pl_result_cell *cell)
{
    static const char *const styles[PL_VERDICT_COUNT] = {"ok", "poor", "bad", ""};
    return cell == NULL || is_unsupported(cell) ? "none" : styles[cell->worst->verdict];
}

void pl_cell_verdict(const pl_result_cell *cell, char text[PL_CELL_VERDICT_SIZE])
{
    if (cell == NULL || is_unsupported(cell)) {
        snprintf(text, PL_CELL_VERDICT_SIZE, "%s", cell == NULL ? "not run" : "unsupported");
        return;
    }
    const pl_result_row *row = cell->worst;
    const bool by_outcome = row->verdict == PL_VERDICT_FAILED && row->outcome != PL_OUTCOME_OK;
    const int used =
        snprintf(text, PL_CELL_VERDICT_SIZE, "%s%s%.60s", pl_verdict_name(row->verdict),
                 by_outcome ? ": " : "", by_outcome ? pl_outcome_name(row->outcome) : "");
    if (cell->outcomes_differ) {
        snprintf(text + used, PL_CELL_VERDICT_SIZE - (size_t)used, " in %d of %d",
                 cell->count - cell->ok_count, cell->count);
    }
}

const char *pl_cell_why(const pl_result_cell *cell)
{
    if (cell == NULL) {
        return "";
    }
    return cell->worst->outcome != PL_OUTCOME_OK
               ? cell->worst->reason
               : pl_json_get_text(cell->worst->result, "verdict_reason");
}

double pl_case_bound(const pl_result_case *test_case, char text[PL_QUANTITY_SIZE])
{
    const int metric = pl_metric_by_name(test_case->row->primary_error);
    for (int i = 0; i < test_case->count; ++i) {
        const json_t *bound = json_object_get(test_case->cells[i].worst->result, "acceptance");
        if (json_is_number(bound)) {
            pl_format_given(json_number_value(bound),
                            metric < 0 ? "1" : pl_metric_table[metric].unit, text);
            return json_number_value(bound);
        }
    }
    return (double)NAN;
}
