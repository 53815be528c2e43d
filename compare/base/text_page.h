/* A page of headings, paragraphs, lists and tables, as Markdown for a file or as text for a
 * terminal. An empty line stands between its parts.
 *
 *     pl_text_page page = {.out = &buffer, .width = pl_window_width(stdout)};
 *     pl_text_page_heading(&page, 1, "Ensembles of %d members", count);
 *     pl_text_page_table(&page, &table); */
#ifndef PLUMB_TEXT_PAGE_H
#define PLUMB_TEXT_PAGE_H

#include "table.h"

/* The width in which Markdown's paragraphs are written. */
enum { PL_MARKDOWN_WIDTH = 90 };

/* Where a page is written, and how. */
typedef struct pl_text_page {
    pl_text_buffer *out; /* borrowed; its `failed` is set when memory runs out */
    int width;           /* of the lines of a terminal; 0: Markdown */
    bool in_list;        /* set by the functions: the last part is an item */
} pl_text_page;

/* Adds a heading of level 1 to 6, formatted as printf does. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void pl_text_page_heading(pl_text_page *page, int level, const char *format, ...);

/* Adds a paragraph, formatted as printf does, folded to the width. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_text_page_paragraph(pl_text_page *page, const char *format, ...);

/* Adds an item of a list, formatted as printf does, folded to the width. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_text_page_item(pl_text_page *page, const char *format, ...);

/* Adds a table and frees it. One without rows is left out. */
void pl_text_page_table(pl_text_page *page, pl_table *table);

#endif
