/* A document as data: headings, sentences, lists, tables and plots. Three writers print it: for a terminal, as
 * Markdown, and as JSON for a page.
 *
 *     pl_document document = {.title = "Thresholds"};
 *     pl_document_heading(&document, "%s", scenario);
 *     pl_document_paragraph(&document, "closed form: %.9g", critical);
 *     pl_document_table(&document, "Critical values", &table);
 *     char *text = pl_document_text(&document, pl_window_width(stdout));
 *     pl_document_free(&document);
 *
 * Memory that ends ends the program. */
#ifndef PLUMB_DOCUMENT_H
#define PLUMB_DOCUMENT_H

#include "table.h"

#include <jansson.h>

/* A part of a document. */
typedef enum pl_block_kind {
    PL_BLOCK_HEADING,
    PL_BLOCK_PARAGRAPH,
    PL_BLOCK_ITEM,  /* of a list */
    PL_BLOCK_TABLE, /* with its caption */
    PL_BLOCK_PLOT   /* on a page only */
} pl_block_kind;

/* A part with what it says. */
typedef struct pl_block {
    pl_block_kind kind;
    char *text;     /* owned */
    pl_table table; /* of a table */
    json_t *plot;   /* of a plot; owned */
} pl_block;

/* Starts with its title alone. */
typedef struct pl_document {
    const char *title; /* borrowed */
    pl_block *blocks;  /* (count) */
    int count;
    bool colour; /* text for a terminal: bold headings, and cells coloured by style */
} pl_document;

/* Frees the parts. */
void pl_document_free(pl_document *document);

/* Adds a heading below the title, which begins a section, a paragraph or an item of a list: `kind`. Its text is
 * formatted as printf does. */
__attribute__((format(printf, 3, 4))) void
pl_document_add(pl_document *document, pl_block_kind kind, const char *format, ...);
#define pl_document_heading(document, ...) pl_document_add(document, PL_BLOCK_HEADING, __VA_ARGS__)
#define pl_document_paragraph(document, ...)                                                       \
    pl_document_add(document, PL_BLOCK_PARAGRAPH, __VA_ARGS__)
#define pl_document_item(document, ...) pl_document_add(document, PL_BLOCK_ITEM, __VA_ARGS__)

/* Adds words as a paragraph, whose text the document takes: `words` is empty then. Nothing where there are none. */
void pl_document_words(pl_document *document, pl_text_buffer *words);

/* Adds a table, whose contents the document takes: `table` is empty then. One without rows is left out. Of its rows
 * `table->last` are shown at first (0: all), and the others are folded up, or counted on a terminal. A row that is one
 * span is a heading of those below it, which stand in a table of their own. */
void pl_document_table(pl_document *document, const char *caption, pl_table *table);

/* ---- Plots ---- */

/* The kinds of plots, by the drawing of a row. */
typedef enum pl_plot_kind {
    PL_PLOT_INTERVALS, /* numbers low, value, high along x: a bar with a dot */
    PL_PLOT_SAMPLES,   /* any numbers along x: their quartiles and dots */
    PL_PLOT_POINTS,    /* numbers x, y, x, y ...: dots */
    PL_PLOT_FRONTS, /* the same, and a line through those that no other of the row is below and left of */
    PL_PLOT_COUNTS /* ascending numbers along x from 1 to 100: how many there are up to x, as steps */
} pl_plot_kind;

/* A plot without rows. `x` and `y` name the axes with their units; y NULL: rows stand below each other. */
json_t *pl_plot_make(pl_plot_kind kind, const char *caption, const char *x, const char *y);

/* Adds the numbers of a row; one that is not finite is left out. */
void pl_plot_row(json_t *plot, const char *name, const double *numbers, int count);

/* Draws a line across the rows at x. */
void pl_plot_rule(json_t *plot, double x);

/* Adds a plot, which the document takes. One without rows is left out. */
void pl_document_plot(pl_document *document, json_t *plot);

/* ---- Writers: malloc'd text ---- */

/* For a terminal with lines of `width` columns. Wider tables are folded: each part of a row keeps its key columns. */
char *pl_document_text(const pl_document *document, int width);

/* As GitHub Flavored Markdown: every text is escaped, and so stays a text. */
char *pl_document_markdown(const pl_document *document);

/* All tables as CSV, each after a line with its caption, those of a section after a line with its heading. */
char *pl_document_csv(const pl_document *document);

/* {"title", "sections": [{"title", "blocks": [...]}]}: a block is {"text"}, {"item"}, a table {"caption", "columns",
 * "most", "rows"} or a plot {"kind", "caption", "x", "y", "rule", "rows"}. A new reference. */
json_t *pl_document_json(const pl_document *document);

#endif
