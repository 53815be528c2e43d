/* A table as text with aligned columns. One that is wider than its line_width is folded, and nothing
 * is cut off: headings and texts are broken into several lines, and where that is not enough, the
 * columns are written in groups, one below the other, each after the columns that name a row. */
#ifndef PLUMB_TABLE_TEXT_H
#define PLUMB_TABLE_TEXT_H

#include "table.h"

/* Appends the rows [first, last) below the headings. Columns are as wide as all rows need, so that
 * parts of one table line up. */
void pl_table_write_text(const pl_table *table, int first, int last, pl_text_buffer *out);

#endif
