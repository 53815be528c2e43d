/* A table of texts that is written both for a terminal and for a page. */
#ifndef PLUMB_REPORT_SWEEP_TABLE_H
#define PLUMB_REPORT_SWEEP_TABLE_H

#include "base/text_buffer.h"

enum { PL_SWEEP_COLUMNS_MOST = 12 };

/* Starts as {0} but for heads and columns. The cells' texts are one after another in `texts`, each
 * with its zero. Look at texts.failed at the end; freed by pl_sweep_table_free. */
typedef struct pl_sweep_table {
    int columns;
    const char *heads[PL_SWEEP_COLUMNS_MOST]; /* plain text */
    bool numeric[PL_SWEEP_COLUMNS_MOST];      /* to the right */
    pl_text_buffer texts;
    int cells;
} pl_sweep_table;

void pl_sweep_table_free(pl_sweep_table *table);

/* The next cell, row by row. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_sweep_table_add(pl_sweep_table *table, const char *format, ...);

int pl_sweep_table_rows(const pl_sweep_table *table);

/* Rows [first, last), with the headings; nothing where there are none. For a terminal, columns are
 * padded, long first columns shortened, and control characters are '?'. */
void pl_sweep_table_html(const pl_sweep_table *table, int first, int last, pl_text_buffer *out);
void pl_sweep_table_text(const pl_sweep_table *table, int first, int last, pl_text_buffer *out);

#endif
