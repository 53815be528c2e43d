#include "document.h"

#include "base/json_field.h"
#include "folding.h"
#include "heap.h"

#include <limits.h>
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

__attribute__((format(printf, 3, 0))) static void
add_text(pl_document *document, pl_block_kind kind, const char *format, va_list arguments)
{
    add_block(document, (pl_block){.kind = kind, .text = pl_heap_format_list(format, arguments)});
}

void pl_document_heading(pl_document *document, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_text(document, PL_BLOCK_HEADING, format, arguments);
    va_end(arguments);
}

void pl_document_paragraph(pl_document *document, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_text(document, PL_BLOCK_PARAGRAPH, format, arguments);
    va_end(arguments);
}

void pl_document_item(pl_document *document, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_text(document, PL_BLOCK_ITEM, format, arguments);
    va_end(arguments);
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

/* Adds text after a mark, folded to the width; 0: not folded. */
static void add_folded(pl_text_buffer *out, const char *mark, const char *text, int width)
{
    pl_text_buffer line = {0};
    pl_text_format(&line, "%s%s\n", mark, text);
    char *whole = pl_text_take(&line);
    pl_text_add_folded(out, whole, width > 0 ? width : INT_MAX);
    free(whole);
}

/* `width` is that of a terminal; 0: Markdown. */
static void write_block(const pl_block *block, int width, pl_text_buffer *out)
{
    const int text_width = width > 0 ? width : PL_MARKDOWN_WIDTH;
    switch (block->kind) {
    case PL_BLOCK_HEADING:
        add_folded(out, width > 0 ? "" : "## ", block->text, width);
        break;
    case PL_BLOCK_PARAGRAPH:
        add_folded(out, "", block->text, text_width);
        break;
    case PL_BLOCK_ITEM:
        add_folded(out, "- ", block->text, text_width);
        break;
    case PL_BLOCK_TABLE: {
        pl_table table = block->table;
        table.line_width = width;
        pl_table_write(&table, width > 0 ? PL_TABLE_TEXT : PL_TABLE_MARKDOWN_PADDED, out);
        if (table.last > 0 && table.last < pl_table_rows(&table)) {
            pl_text_format(out, "%sand %d more\n", width > 0 ? "" : "\n",
                           pl_table_rows(&table) - table.last);
        }
        break;
    }
    case PL_BLOCK_PLOT:
        break;
    }
}

/* An empty line stands between two parts, except between the items of a list. */
static char *write_all(const pl_document *document, int width)
{
    pl_text_buffer out = {0};
    bool in_list = false;
    add_folded(&out, width > 0 ? "" : "# ", document->title, width);
    for (int i = 0; i < document->count; ++i) {
        const pl_block *block = &document->blocks[i];
        const bool is_item = block->kind == PL_BLOCK_ITEM;
        if (block->kind != PL_BLOCK_PLOT) {
            pl_text_add(&out, in_list && is_item ? "" : "\n");
            write_block(block, width, &out);
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
        if (block->kind == PL_BLOCK_TABLE) {
            pl_text_add(&out, out.length > 0 ? "\r\n" : "");
            pl_text_add_csv(&out, block->text);
            pl_text_add(&out, "\r\n");
            pl_table_write(&block->table, PL_TABLE_CSV, &out);
        }
    }
    return pl_text_take(&out);
}

/* ---- JSON ---- */

/* A cell is its text, null below a span, or {"text", "style", "span"}. */
static json_t *cell_json(const pl_table *table, int row, int column)
{
    const pl_table_cell *cell = &table->cells[row * table->column_count + column];
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
    return json_pack("{s:o, s:o, s:o}", "caption", pl_json_text(block->text), "columns", columns,
                     "rows", rows);
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
