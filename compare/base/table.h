/* Tables. A table is filled cell by cell, row by row, and written as plain text with aligned
 * columns, as Markdown (GitHub Flavored Markdown 0.29, section 4.10) or as CSV (RFC 4180).
 *
 *     pl_table table = {0};
 *     pl_table_column(&table, PL_LEFT, "engine");
 *     pl_table_column(&table, PL_RIGHT, "to %g m/s", tolerance);
 *     pl_table_add(&table, name);
 *     pl_table_number(&table, seconds, 3);
 *     pl_table_write(&table, PL_TABLE_MARKDOWN, &buffer);
 *     pl_table_free(&table);
 *
 * Every text is copied. Memory that ends ends the program. */
#ifndef PLUMB_TABLE_H
#define PLUMB_TABLE_H

#include "base/text_buffer.h"

#include <stdio.h>

/* The format in which a table is written. */
typedef enum pl_table_format {
    PL_TABLE_TEXT,     /* aligned columns for a terminal */
    PL_TABLE_MARKDOWN, /* every cell escaped, so that it contains no markup */
    PL_TABLE_CSV       /* lines end with CR LF; the headings are always written */
} pl_table_format;

/* Where the cells of a column stand. */
typedef enum pl_table_align { PL_LEFT, PL_RIGHT } pl_table_align;

/* The heading of a column, with its alignment. */
typedef struct pl_table_heading {
    size_t text; /* offset in texts */
    pl_table_align align;
} pl_table_heading;

/* A cell of a table. */
typedef struct pl_table_cell {
    size_t text;       /* offset in texts */
    const char *style; /* borrowed; NULL: none */
    bool is_markup;    /* not escaped in Markdown */
    bool is_span;      /* stands in all columns up to the end of the row */
} pl_table_cell;

/* Starts as {0}. The fields of the second group may be set before the table is written. */
typedef struct pl_table {
    pl_table_heading *headings;
    int column_count;
    pl_table_cell *cells; /* by rows; a row has column_count cells */
    int cell_count;
    pl_text_buffer texts; /* of headings and cells, each with its zero */

    int first, last; /* the rows to write, [first, last); last = 0: all. A table with no row to
                           * write is left out */
    int indent;      /* text: spaces before each line */
    int line_width;  /* text: a wider table is folded to it; 0: no limit */
    int keys;        /* text: the first columns that name a row; 0 counts as 1 */
    bool colour;     /* text: colours by style, by escape sequences */
} pl_table;

/* Frees all that the table has; it is then as at the start. */
void pl_table_free(pl_table *table);

/* Adds a column with a heading, formatted as printf does. All columns are added before any cell. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void pl_table_column(pl_table *table, pl_table_align align, const char *heading, ...);

/* Adds the columns of a list of headings, "engine|outcome|>time, s": separated by bars; a '>'
 * before a heading aligns its column to the right. A unit follows its heading after a comma. */
void pl_table_columns(pl_table *table, const char *headings);

/* Adds the next cell, with this text. */
void pl_table_add(pl_table *table, const char *text);

/* Adds the next cell, with text formatted as printf does. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_table_format_cell(pl_table *table, const char *format, ...);

/* Adds the next cell, with a number of `digits` significant digits ("%.*g"); "-" if it is not finite. */
void pl_table_number(pl_table *table, double value, int digits);

/* Adds a cell that is already Markdown, and is not escaped when written as such. */
void pl_table_add_markup(pl_table *table, const char *markup);

/* Adds a cell that takes the rest of its row, formatted as printf does. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_table_add_span(pl_table *table, const char *format, ...);

/* Sets the style of the last cell, which there is, borrowed: its colour in text is "ok" green, "poor" yellow, "bad" red,
 * "none" faint; NULL or another: none. */
void pl_table_style(pl_table *table, const char *style);

/* Complete rows. */
int pl_table_rows(const pl_table *table);

/* A cell; for a heading (row -1) one without a style. */
const pl_table_cell *pl_table_cell_at(const pl_table *table, int row, int column);

/* The text of a cell, or of a heading (row -1); NULL for a cell that a span covers. Valid until the
 * next change of the table. */
const char *pl_table_text(const pl_table *table, int row, int column);

/* Appends the table to `out`. Text that is wider than its line_width is folded, and nothing is cut off: headings and
 * texts are broken into several lines, and where that is not enough, the columns are written in groups, one below the
 * other, each after the columns that name a row. Columns of text are as wide as all rows need, so that parts of one
 * table line up. */
void pl_table_write(const pl_table *table, pl_table_format format, pl_text_buffer *out);

/* Writes the table as text that fits the window of a stream. */
void pl_table_print(pl_table *table, FILE *out);

#endif
