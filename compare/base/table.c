#include "table.h"

#include "folding.h"
#include "heap.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void pl_table_free(pl_table *table)
{
    free(table->headings);
    free(table->cells);
    pl_text_free(&table->texts);
    *table = (pl_table){0};
}

/* ---- Filling ---- */

/* Adds a text of so many bytes to table->texts. Returns where it begins. */
static size_t add_text(pl_table *table, const char *text, size_t length)
{
    const size_t offset = table->texts.length;
    pl_text_add_bytes(&table->texts, text, length);
    pl_text_add_bytes(&table->texts, "", 1);
    if (table->texts.failed) {
        pl_out_of_memory();
    }
    return offset;
}

static void push_column(pl_table *table, pl_table_align align, const char *heading, size_t length)
{
    const pl_table_heading added = {.text = add_text(table, heading, length), .align = align};
    pl_push(&table->headings, &table->column_count, &added, sizeof added);
}

void pl_table_column(pl_table *table, pl_table_align align, const char *heading, ...)
{
    va_list arguments;
    va_start(arguments, heading);
    char *text = pl_heap_format_list(heading, arguments);
    va_end(arguments);
    push_column(table, align, text, strlen(text));
    free(text);
}

void pl_table_columns(pl_table *table, const char *headings)
{
    for (const char *next = headings;; ++next) {
        const pl_table_align align = *next == '>' ? PL_RIGHT : PL_LEFT;
        next += align == PL_RIGHT;
        const size_t length = strcspn(next, "|");
        push_column(table, align, next, length);
        next += length;
        if (*next == '\0') {
            return;
        }
    }
}

void pl_table_add(pl_table *table, const char *text)
{
    const pl_table_cell cell = {.text = add_text(table, text, strlen(text))};
    pl_push(&table->cells, &table->cell_count, &cell, sizeof cell);
}

void pl_table_format_cell(pl_table *table, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *text = pl_heap_format_list(format, arguments);
    va_end(arguments);
    pl_table_add(table, text);
    free(text);
}

void pl_table_number(pl_table *table, double value, int digits)
{
    if (isfinite(value)) {
        pl_table_format_cell(table, "%.*g", digits, value);
    } else {
        pl_table_add(table, table->missing != NULL ? table->missing : "-");
    }
}

void pl_table_add_markup(pl_table *table, const char *markup)
{
    pl_table_add(table, markup);
    table->cells[table->cell_count - 1].is_markup = true;
}

void pl_table_add_span(pl_table *table, const char *text)
{
    pl_table_add(table, text);
    table->cells[table->cell_count - 1].is_span = true;
    while (table->cell_count % table->column_count != 0) {
        pl_table_add(table, "");
    }
}

void pl_table_style(pl_table *table, const char *style)
{
    table->cells[table->cell_count - 1].style = style;
}

/* ---- Reading ---- */

int pl_table_rows(const pl_table *table)
{
    return table->column_count == 0 ? 0 : table->cell_count / table->column_count;
}

const pl_table_cell *pl_table_cell_at(const pl_table *table, int row, int column)
{
    static const pl_table_cell none = {0};
    return row < 0 ? &none : &table->cells[row * table->column_count + column];
}

const char *pl_table_text(const pl_table *table, int row, int column)
{
    for (int k = 0; k < column && row >= 0; ++k) {
        if (pl_table_cell_at(table, row, k)->is_span) {
            return NULL;
        }
    }
    return table->texts.data +
           (row < 0 ? table->headings[column].text : pl_table_cell_at(table, row, column)->text);
}

/* ---- Writing ---- */

static void add_markdown_rule(const pl_table *table, pl_text_buffer *out)
{
    for (int k = 0; k < table->column_count; ++k) {
        pl_text_add(out, table->headings[k].align == PL_RIGHT ? "|---:" : "|---");
    }
    pl_text_add(out, "|\n");
}

static void add_markdown_row(const pl_table *table, int row, pl_text_buffer *out)
{
    for (int k = 0; k < table->column_count; ++k) {
        const char *text = pl_table_text(table, row, k);
        pl_text_add(out, "| ");
        if (pl_table_cell_at(table, row, k)->is_markup) {
            pl_text_add(out, text);
        } else {
            pl_text_add_markdown(out, text == NULL ? "" : text);
        }
        pl_text_add(out, " ");
    }
    pl_text_add(out, "|\n");
}

static void add_csv_row(const pl_table *table, int row, pl_text_buffer *out)
{
    for (int k = 0; k < table->column_count; ++k) {
        const char *text = pl_table_text(table, row, k);
        pl_text_add(out, k == 0 ? "" : ",");
        pl_text_add_csv(out, text == NULL ? "" : text);
    }
    pl_text_add(out, table->line_end == NULL ? "\r\n" : table->line_end);
}

void pl_table_write(const pl_table *table, pl_table_format format, pl_text_buffer *out)
{
    const int rows = pl_table_rows(table);
    const int last = table->last == 0 || table->last > rows ? rows : table->last;
    if (table->column_count == 0 || (table->first >= last && format != PL_TABLE_CSV)) {
        return;
    }
    if (format == PL_TABLE_TEXT) {
        pl_table_write_text(table, table->first, last, out);
        return;
    }
    void (*const add_row)(const pl_table *, int, pl_text_buffer *) =
        format == PL_TABLE_CSV ? add_csv_row : add_markdown_row;
    add_row(table, -1, out);
    if (format == PL_TABLE_MARKDOWN) {
        add_markdown_rule(table, out);
    }
    for (int row = table->first; row < last; ++row) {
        add_row(table, row, out);
    }
}

void pl_table_print(pl_table *table, FILE *out)
{
    pl_text_buffer text = {0};
    table->line_width = pl_window_width(out);
    pl_table_write(table, PL_TABLE_TEXT, &text);
    pl_text_print(&text, out);
}
