#include "verdict_counts.h"

#include "base/heap.h"

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
    /* NOLINTNEXTLINE(clang-analyzer-core.*): every item has a configuration */
    return order != 0 ? order : strcmp(a->configuration->name, b->configuration->name);
}

void pl_verdict_counts_make(const pl_result_table *results, pl_verdict_counts *counts)
{
    *counts =
        (pl_verdict_counts){.count = results->configuration_count, .cases = results->case_count};
    counts->items = pl_heap_new((size_t)counts->count, sizeof *counts->items);
    for (int i = 0; i < counts->count; ++i) {
        counts->items[i] = (pl_verdict_count){.configuration = &results->configurations[i],
                                              .not_run = results->case_count};
    }
    for (int i = 0; i < results->cell_count; ++i) {
        const pl_result_row *row = results->cells[i].worst;
        pl_verdict_count *item = &counts->items[results->cells[i].configuration];
        const bool is_unsupported = row->outcome == PL_OUTCOME_UNSUPPORTED;
        --item->not_run;
        ++*(is_unsupported ? &item->unsupported : &item->runs[row->verdict]);
        counts->any_judged |= !is_unsupported && row->verdict != PL_VERDICT_UNJUDGED;
    }
    qsort(counts->items, (size_t)counts->count, sizeof *counts->items, compare_counts);
    pl_text_format(&counts->order,
                   "How many of %d %s each engine got right; repeats count once, by the worst. "
                   "Most accurate first, then fewest failed, then fewest inaccurate.",
                   counts->cases, counts->cases == 1 ? "case" : "cases");
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
        pl_table_add(&table, item->configuration->name);
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
