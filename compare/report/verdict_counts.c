#include "verdict_counts.h"

#include <stdlib.h>
#include <string.h>

/* The columns of the table; the first three are always there. */
typedef enum count_column {
    ACCURATE,
    INACCURATE,
    FAILED,
    UNSUPPORTED,
    NOT_JUDGED,
    NOT_RUN,
    COLUMN_COUNT
} count_column;

static const char *const headings[COLUMN_COUNT] = {"accurate",    "inaccurate", "failed",
                                                   "unsupported", "not judged", "not run"};
static const char *const styles[COLUMN_COUNT] = {"ok", "poor", "bad", "none", NULL, "none"};

static int value_of(const pl_verdict_count *item, count_column column)
{
    switch (column) {
    case UNSUPPORTED:
        return item->unsupported;
    case NOT_JUDGED:
        return item->runs[PL_VERDICT_UNJUDGED];
    case NOT_RUN:
        return item->not_run;
    default:
        return item->runs[column == ACCURATE     ? PL_VERDICT_ACCURATE
                          : column == INACCURATE ? PL_VERDICT_INACCURATE
                                                 : PL_VERDICT_FAILED];
    }
}

static int compare_counts(const void *left, const void *right)
{
    const pl_verdict_count *a = left, *b = right;
    int order = b->runs[PL_VERDICT_ACCURATE] - a->runs[PL_VERDICT_ACCURATE];
    order = order != 0 ? order : a->runs[PL_VERDICT_FAILED] - b->runs[PL_VERDICT_FAILED];
    order = order != 0 ? order : a->runs[PL_VERDICT_INACCURATE] - b->runs[PL_VERDICT_INACCURATE];
    /* NOLINTNEXTLINE(clang-analyzer-core.*): every item has a column */
    return order != 0 ? order : strcmp(a->column->name, b->column->name);
}

static void count_column_of(const pl_result_matrix *matrix, int column, pl_verdict_count *item)
{
    item->column = &matrix->columns[column];
    for (int i = 0; i < matrix->case_count; ++i) {
        const pl_cell *cell = &matrix->cases[i].cells[column];
        if (cell->result == NULL) {
            ++item->not_run;
        } else if (strcmp(cell->outcome, "unsupported") == 0) {
            ++item->unsupported;
        } else {
            ++item->runs[cell->verdict];
        }
    }
}

pl_status pl_verdict_counts_make(const pl_result_matrix *matrix, pl_verdict_counts *counts,
                                 pl_error *error)
{
    *counts = (pl_verdict_counts){.count = matrix->column_count, .cases = matrix->case_count};
    counts->items = calloc((size_t)matrix->column_count + 1, sizeof *counts->items);
    if (counts->items == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for the verdicts");
    }
    for (int i = 0; i < matrix->column_count; ++i) {
        pl_verdict_count *item = &counts->items[i];
        count_column_of(matrix, i, item);
        counts->any_judged |=
            value_of(item, ACCURATE) + value_of(item, INACCURATE) + value_of(item, FAILED) > 0;
    }
    qsort(counts->items, (size_t)counts->count, sizeof *counts->items, compare_counts);
    pl_text_format(&counts->order,
                   "How many of %d %s each engine got right; repeats count once, by the worst. "
                   "Most accurate first, then fewest failed, then fewest inaccurate.",
                   counts->cases, counts->cases == 1 ? "case" : "cases");
    return counts->order.failed ? pl_fail(error, PL_NO_MEMORY, "no memory for the verdicts")
                                : PL_OK;
}

void pl_verdict_counts_free(pl_verdict_counts *counts)
{
    free(counts->items);
    pl_text_free(&counts->order);
    *counts = (pl_verdict_counts){0};
}

pl_table pl_verdict_counts_table(const pl_verdict_counts *counts)
{
    pl_table table = {0};
    bool shown[COLUMN_COUNT] = {[ACCURATE] = true, [INACCURATE] = true, [FAILED] = true};
    pl_table_column(&table, PL_LEFT, "engine");
    for (int k = 0; k < COLUMN_COUNT; ++k) {
        for (int i = 0; i < counts->count; ++i) {
            shown[k] |= value_of(&counts->items[i], (count_column)k) > 0;
        }
        if (shown[k]) {
            pl_table_column(&table, PL_RIGHT, "%s", headings[k]);
        }
    }
    for (int i = 0; i < counts->count; ++i) {
        const pl_verdict_count *item = &counts->items[i];
        pl_table_add(&table, item->column->name);
        for (int k = 0; k < COLUMN_COUNT; ++k) {
            const int runs = value_of(item, (count_column)k);
            if (shown[k]) {
                pl_table_format_cell(&table, "%d", runs);
                pl_table_style(&table, runs > 0 ? styles[k] : NULL);
            }
        }
    }
    return table;
}
