#include "cell_verdict.h"

#include <stdio.h>
#include <string.h>

static bool is_unsupported(const pl_cell *cell)
{
    return strcmp(cell->outcome, "unsupported") == 0;
}

const char *pl_cell_style(const pl_cell *cell)
{
    static const char *const styles[PL_VERDICT_COUNT] = {"ok", "poor", "bad", ""};
    return cell->result == NULL || is_unsupported(cell) ? "none" : styles[cell->verdict];
}

void pl_cell_verdict(const pl_cell *cell, char text[PL_CELL_VERDICT_SIZE])
{
    const bool by_outcome = cell->verdict == PL_VERDICT_FAILED && strcmp(cell->outcome, "ok") != 0;
    if (cell->result == NULL || is_unsupported(cell)) {
        snprintf(text, PL_CELL_VERDICT_SIZE, "%s",
                 cell->result == NULL ? "not run" : cell->outcome);
        return;
    }
    snprintf(text, PL_CELL_VERDICT_SIZE, "%s%s%.60s", pl_verdict_name(cell->verdict),
             by_outcome ? ": " : "", by_outcome ? cell->outcome : "");
}

const char *pl_cell_why(const pl_cell *cell)
{
    if (cell->result == NULL) {
        return "";
    }
    return strcmp(cell->outcome, "ok") != 0 ? cell->reason
                                            : pl_json_get_text(cell->result, "verdict_reason");
}

void pl_cell_badge(const pl_cell *cell, pl_text_buffer *out)
{
    char text[PL_CELL_VERDICT_SIZE];
    pl_cell_verdict(cell, text);
    pl_text_add(out, "**");
    pl_text_add_markdown(out, text);
    if (cell->outcomes_differ) {
        pl_text_format(out, " in %d of %d", cell->repeats - cell->ok_repeats, cell->repeats);
    }
    pl_text_add(out, "**");
}

bool pl_case_acceptance(const pl_result_matrix *matrix, const pl_case *test_case,
                        char bound[PL_NUMBER_SIZE], const char **reason)
{
    const pl_scenario *scenario = test_case->catalogue;
    const int metric = pl_metric_by_name(test_case->primary_error);
    for (int i = 0; i < matrix->column_count; ++i) {
        const json_t *result = test_case->cells[i].result;
        const json_t *acceptance = json_object_get(result, "acceptance");
        if (json_is_number(acceptance)) {
            const double value = json_number_value(acceptance);
            const bool is_known = scenario != NULL && scenario->acceptance == value &&
                                  scenario->acceptance_reason != NULL;
            pl_format_given(value, metric < 0 ? "1" : pl_metric_table[metric].unit, bound);
            *reason = is_known ? scenario->acceptance_reason : "";
            return true;
        }
    }
    return false;
}
