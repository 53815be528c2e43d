/* A Markdown table (GitHub Flavored Markdown 4.10) whose columns are padded, so that it reads as
 * well on a terminal. */
#ifndef PLUMB_ALIGNED_H
#define PLUMB_ALIGNED_H

#include <stdio.h>

typedef struct pl_text_table pl_text_table;

/* NULL when out of memory, which the others allow: they then do nothing. */
pl_text_table *pl_text_table_begin(const char *const *heads, int columns);

/* The next cell, row by row. A '|' in it is escaped, control characters become '?'. */
void pl_text_table_add(pl_text_table *table, const char *text);
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_text_table_format(pl_text_table *table, const char *format, ...);

/* Writes a table that has rows, with an empty line after it, and frees it. */
void pl_text_table_end(pl_text_table *table, FILE *out);

#endif
