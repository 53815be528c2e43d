/* A Markdown table (GitHub Flavored Markdown 4.10) whose columns are padded, so that it reads as
 * well on a terminal. */
#ifndef PLUMB_ALIGNED_H
#define PLUMB_ALIGNED_H

#include <stdio.h>

typedef struct pl_aligned pl_aligned;

/* NULL when out of memory, which the others allow: they then do nothing. */
pl_aligned *pl_aligned_begin(const char *const *heads, int columns);

/* The next cell, row by row. A '|' in it is escaped, control characters become '?'. */
void pl_aligned_add(pl_aligned *table, const char *text);
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_aligned_format(pl_aligned *table, const char *format, ...);

/* Writes a table that has rows, with an empty line after it, and frees it. */
void pl_aligned_end(pl_aligned *table, FILE *out);

#endif
