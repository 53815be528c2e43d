/* How many runs of each engine are accurate, inaccurate or failed. */
#include "base/heap.h"
#include "sections.h"

#include <stdlib.h>
#include <string.h>

/* What is counted: verdicts, and cases without any. */
enum { UNSUPPORTED = PL_VERDICT_COUNT, NOT_RUN, KIND_COUNT };

/* The columns; the first three are always there, the others where some engine has any. */
static const struct {
    int kind;
    const char *heading, *style;
} columns[KIND_COUNT] = {
    {PL_VERDICT_ACCURATE, "accurate", "ok"},   {PL_VERDICT_INACCURATE, "inaccurate", "poor"},
    {PL_VERDICT_FAILED, "failed", "bad"},      {UNSUPPORTED, "unsupported", "none"},
    {PL_VERDICT_UNJUDGED, "not judged", NULL}, {NOT_RUN, "not run", "none"}};

/* Of an engine configuration. The repeats of a run count once, by the worst. */
typedef struct verdict_count {
    const char *name;
    int runs[KIND_COUNT];
} verdict_count;

static int compare_counts(const void *left, const void *right)
{
    const verdict_count *a = left, *b = right;
    int order = b->runs[PL_VERDICT_ACCURATE] - a->runs[PL_VERDICT_ACCURATE];
    order = order != 0 ? order : a->runs[PL_VERDICT_FAILED] - b->runs[PL_VERDICT_FAILED];
    order = order != 0 ? order : a->runs[PL_VERDICT_INACCURATE] - b->runs[PL_VERDICT_INACCURATE];
    /* NOLINTNEXTLINE(clang-analyzer-core.*): every item has a name */
    return order != 0 ? order : strcmp(a->name, b->name);
}

/* The caller frees. */
static verdict_count *count_verdicts(const pl_result_table *results)
{
    const int count = results->configuration_count;
    verdict_count *counts = pl_heap_new((size_t)count, sizeof *counts);
    for (int i = 0; i < count; ++i) {
        counts[i].name = results->configurations[i].name;
        counts[i].runs[NOT_RUN] = results->case_count;
    }
    for (int i = 0; i < results->cell_count; ++i) {
        const pl_result_row *row = results->cells[i].worst;
        int *runs = counts[results->cells[i].configuration].runs;
        --runs[NOT_RUN];
        ++runs[row->outcome == PL_OUTCOME_UNSUPPORTED ? (int)UNSUPPORTED : (int)row->verdict];
    }
    qsort(counts, (size_t)count, sizeof *counts, compare_counts);
    return counts;
}

void pl_section_verdicts(const pl_result_table *results, pl_document *document)
{
    if (results->case_count < 2) {
        return;
    }
    verdict_count *counts = count_verdicts(results);
    pl_table table = {.indent = PL_SECTION_INDENT};
    bool shown[KIND_COUNT] = {true, true, true};
    pl_table_columns(&table, "engine");
    for (int k = 0; k < KIND_COUNT; ++k) {
        for (int i = 0; i < results->configuration_count; ++i) {
            shown[k] |= counts[i].runs[columns[k].kind] > 0;
        }
        if (shown[k]) {
            pl_table_column(&table, PL_RIGHT, "%s", columns[k].heading);
        }
    }
    for (int i = 0; i < results->configuration_count; ++i) {
        pl_table_add(&table, counts[i].name);
        for (int k = 0; k < KIND_COUNT; ++k) {
            const int runs = counts[i].runs[columns[k].kind];
            if (shown[k]) {
                pl_table_format_cell(&table, "%d", runs);
                pl_table_style(&table, runs > 0 ? columns[k].style : NULL);
            }
        }
    }
    pl_document_heading(document, "Verdicts");
    pl_document_paragraph(document,
                          "How many of %d cases each engine got right; repeats count once, by the "
                          "worst. Most accurate first, then fewest failed, then fewest inaccurate.",
                          results->case_count);
    pl_document_table(document, "Verdicts on each engine", &table);
    free(counts);
}
