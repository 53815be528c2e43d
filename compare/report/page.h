/* What pages are put together from. A page is HTML or Markdown for GitHub; every text that comes
 * from results or the catalogue is escaped. */
#ifndef PLUMB_REPORT_PAGE_H
#define PLUMB_REPORT_PAGE_H

#include "base/table.h"

/* Files that compare/CMakeLists.txt builds into the program. */
extern const char pl_method_html[]; /* page/method.html */
extern const char pl_page_css[];    /* page/page.css */
extern const char pl_sweep_css[];   /* page/sweep.css */

/* A page that is being written. */
typedef struct pl_page {
    pl_text_buffer *out;
    bool html; /* else Markdown */
} pl_page;

/* Opens a self-contained HTML page, without scripts and requests, up to and with the start of its
 * main element. `style` is more CSS than page/page.css, or NULL. */
void pl_page_open(pl_text_buffer *out, const char *title, const char *style);

/* Closes an HTML page. */
void pl_page_close(pl_text_buffer *out);

/* Adds text, escaped for the page's format. */
void pl_page_text(const pl_page *page, const char *text);

/* Adds a heading of the second level; `id` is its anchor in HTML. */
void pl_page_heading(const pl_page *page, const char *id, const char *text);

/* Adds a paragraph. `style` is its class in HTML ("": none); "note" is small in Markdown too. */
void pl_page_paragraph(const pl_page *page, const char *style, const char *text);

/* Opens a part that is folded up at first: a details element, which the caller closes. HTML only.
 */
void pl_page_details(const pl_page *page, const char *summary);

/* Adds a table, which is freed: at most `most` rows, the others folded up; 0: all rows. Nothing
 * where it has no rows. */
void pl_page_table(const pl_page *page, pl_table table, int most);

/* Adds a cell of markup to a table, and frees the markup. */
void pl_page_add_markup(pl_table *table, pl_text_buffer *markup);

#endif
