#include "document.h"

#include "base/json_field.h"
#include "folding.h"
#include "heap.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Parts ---- */

static void add_block(pl_document *document, pl_block block)
{
    pl_push(&document->blocks, &document->count, &block, sizeof block);
}

void pl_document_add(pl_document *document, pl_block_kind kind, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_block(document, (pl_block){.kind = kind, .text = pl_heap_format_list(format, arguments)});
    va_end(arguments);
}

void pl_document_words(pl_document *document, pl_text_buffer *words)
{
    if (words->length > 0) {
        add_block(document, (pl_block){.kind = PL_BLOCK_PARAGRAPH, .text = pl_text_take(words)});
    }
}

void pl_document_table(pl_document *document, const char *caption, pl_table *table)
{
    if (pl_table_rows(table) == 0) {
        pl_table_free(table);
        return;
    }
    add_block(document,
              (pl_block){.kind = PL_BLOCK_TABLE, .text = pl_heap_copy(caption), .table = *table});
    *table = (pl_table){0};
}

json_t *pl_plot_make(pl_plot_kind kind, const char *caption, const char *x, const char *y)
{
    static const char *const names[] = {"intervals", "samples", "points", "fronts", "counts"};
    return json_pack("{s:s, s:s, s:s, s:s?, s:n, s:[]}", "kind", names[kind], "caption", caption,
                     "x", x, "y", y, "rule", "rows");
}

void pl_plot_row(json_t *plot, const char *name, const double *numbers, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; ++i) {
        if (isfinite(numbers[i])) {
            json_array_append_new(list, json_real(numbers[i]));
        }
    }
    json_array_append_new(json_object_get(plot, "rows"),
                          json_pack("{s:o, s:o}", "name", pl_json_text(name), "numbers", list));
}

void pl_plot_rule(json_t *plot, double x)
{
    if (isfinite(x)) {
        json_object_set_new(plot, "rule", json_real(x));
    }
}

void pl_document_plot(pl_document *document, json_t *plot)
{
    if (json_array_size(json_object_get(plot, "rows")) == 0) {
        json_decref(plot);
        return;
    }
    add_block(document, (pl_block){.kind = PL_BLOCK_PLOT, .plot = plot});
}

void pl_document_free(pl_document *document)
{
    for (int i = 0; i < document->count; ++i) {
        free(document->blocks[i].text);
        pl_table_free(&document->blocks[i].table);
        json_decref(document->blocks[i].plot);
    }
    free(document->blocks);
    *document = (pl_document){.title = document->title};
}

/* ---- Text and Markdown ---- */

/* How text is written. */
typedef struct writer {
    pl_text_buffer *out;
    int width; /* of a terminal; 0: Markdown */
    bool colour;
} writer;

/* Adds a text after a mark: on one line in Markdown, escaped; folded for a terminal. */
static void add_line(const writer *w, const char *mark, const char *text)
{
    pl_text_buffer line = {0};
    pl_text_add(&line, mark);
    if (w->width == 0) {
        pl_text_add_markdown(&line, text);
    } else {
        pl_text_add_plain(&line, text, strlen(text));
    }
    char *whole = pl_text_take(&line);
    if (w->width == 0) {
        pl_text_add(w->out, whole);
    } else {
        pl_text_add_folded(w->out, whole, w->width);
    }
    pl_text_add(w->out, "\n");
    free(whole);
}

/* Adds a heading; `mark` is that of Markdown. */
static void add_heading(const writer *w, const char *mark, const char *text)
{
    pl_text_add(w->out, w->colour ? "\033[1m" : "");
    add_line(w, w->width > 0 ? "" : mark, text);
    pl_text_add(w->out, w->colour ? "\033[0m" : "");
}

/* Adds the rows of a table below each heading of its own, a row that is one span. */
static void add_parts(const writer *w, pl_table table, int rows)
{
    const pl_table_format format = w->width > 0 ? PL_TABLE_TEXT : PL_TABLE_MARKDOWN;
    for (int row = 0; row < rows; row = table.last) {
        if (table.cells[row * table.column_count].is_span) {
            pl_text_add(w->out, row > 0 ? "\n" : "");
            add_heading(w, "### ", pl_table_text(&table, row, 0));
            pl_text_add(w->out, w->width > 0 ? "" : "\n");
            ++row;
        }
        table.first = row;
        for (table.last = row; table.last < rows; ++table.last) {
            if (table.cells[table.last * table.column_count].is_span) {
                break;
            }
        }
        pl_table_write(&table, format, w->out);
    }
}

/* The rows after those that are shown at first are counted, and in Markdown folded up. */
static void add_table(const writer *w, pl_table table)
{
    const int rows = pl_table_rows(&table);
    const int shown = table.last == 0 || table.last > rows ? rows : table.last;
    table.line_width = w->width;
    table.colour = w->colour;
    add_parts(w, table, shown);
    if (shown < rows && w->width > 0) {
        pl_text_format(w->out, "and %d more\n", rows - shown);
    } else if (shown < rows) {
        table.first = shown;
        table.last = rows;
        pl_text_format(w->out, "\n<details><summary>%d more</summary>\n\n", rows - shown);
        pl_table_write(&table, PL_TABLE_MARKDOWN, w->out);
        pl_text_add(w->out, "\n</details>\n");
    }
}

static void write_block(const writer *w, const pl_block *block)
{
    switch (block->kind) {
    case PL_BLOCK_HEADING:
        add_heading(w, "## ", block->text);
        break;
    case PL_BLOCK_PARAGRAPH:
        add_line(w, "", block->text);
        break;
    case PL_BLOCK_ITEM:
        add_line(w, "- ", block->text);
        break;
    case PL_BLOCK_TABLE:
        add_table(w, block->table);
        break;
    case PL_BLOCK_PLOT:
        break;
    }
}

/* An empty line stands between two parts, except between the items of a list. */
static char *write_all(const pl_document *document, int width)
{
    pl_text_buffer out = {0};
    const writer w = {&out, width, document->colour && width > 0};
    bool in_list = false;
    add_heading(&w, "# ", document->title);
    for (int i = 0; i < document->count; ++i) {
        const pl_block *block = &document->blocks[i];
        const bool is_item = block->kind == PL_BLOCK_ITEM;
        if (block->kind != PL_BLOCK_PLOT) {
            pl_text_add(&out, in_list && is_item ? "" : "\n");
            write_block(&w, block);
            in_list = is_item;
        }
    }
    return pl_text_take(&out);
}

char *pl_document_text(const pl_document *document, int width)
{
    return write_all(document, width < 1 ? 1 : width);
}

char *pl_document_markdown(const pl_document *document)
{
    return write_all(document, 0);
}

char *pl_document_csv(const pl_document *document)
{
    pl_text_buffer out = {0};
    for (int i = 0; i < document->count; ++i) {
        const pl_block *block = &document->blocks[i];
        if (block->kind == PL_BLOCK_HEADING || block->kind == PL_BLOCK_TABLE) {
            pl_text_add_csv(&out, block->text);
            pl_text_add(&out, "\r\n");
        }
        if (block->kind == PL_BLOCK_TABLE) {
            pl_table_write(&block->table, PL_TABLE_CSV, &out);
        }
    }
    return pl_text_take(&out);
}

/* ---- JSON ---- */

/* A cell is its text, null below a span, or {"text", "style", "span"}. */
static json_t *cell_json(const pl_table *table, int row, int column)
{
    const pl_table_cell *cell = pl_table_cell_at(table, row, column);
    const char *text = pl_table_text(table, row, column);
    if (text == NULL) {
        return json_null();
    }
    return cell->style == NULL && !cell->is_span
               ? pl_json_text(text)
               : json_pack("{s:o, s:s?, s:b}", "text", pl_json_text(text), "style", cell->style,
                           "span", (int)cell->is_span);
}

static json_t *table_json(const pl_block *block)
{
    const pl_table *table = &block->table;
    json_t *columns = json_array(), *rows = json_array();
    for (int k = 0; k < table->column_count; ++k) {
        json_array_append_new(columns, json_pack("{s:o, s:b}", "name",
                                                 pl_json_text(pl_table_text(table, -1, k)), "right",
                                                 table->headings[k].align == PL_RIGHT));
    }
    for (int i = 0; i < pl_table_rows(table); ++i) {
        json_t *row = json_array();
        for (int k = 0; k < table->column_count; ++k) {
            json_array_append_new(row, cell_json(table, i, k));
        }
        json_array_append_new(rows, row);
    }
    return json_pack("{s:o, s:o, s:i, s:o}", "caption", pl_json_text(block->text), "columns",
                     columns, "most", table->last, "rows", rows);
}

static json_t *block_json(const pl_block *block)
{
    return block->kind == PL_BLOCK_TABLE ? table_json(block)
           : block->kind == PL_BLOCK_PLOT
               ? json_incref(block->plot)
               : json_pack("{s:o}", block->kind == PL_BLOCK_ITEM ? "item" : "text",
                           pl_json_text(block->text));
}

static json_t *begin_section(json_t *sections, const char *title)
{
    json_t *blocks = json_array();
    json_array_append_new(sections,
                          json_pack("{s:o, s:o}", "title", pl_json_text(title), "blocks", blocks));
    return blocks;
}

json_t *pl_document_json(const pl_document *document)
{
    json_t *sections = json_array(), *blocks = NULL;
    for (int i = 0; i < document->count; ++i) {
        const pl_block *block = &document->blocks[i];
        if (block->kind == PL_BLOCK_HEADING) {
            blocks = begin_section(sections, block->text);
            continue;
        }
        blocks = blocks == NULL ? begin_section(sections, document->title) : blocks;
        json_array_append_new(blocks, block_json(block));
    }
    return json_pack("{s:o, s:o}", "title", pl_json_text(document->title), "sections", sections);
}
