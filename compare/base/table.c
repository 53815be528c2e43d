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

__attribute__((format(printf, 2, 0))) static void add_list(pl_table *table, const char *format,
                                                           va_list arguments)
{
    char *text = pl_heap_format_list(format, arguments);
    pl_table_add(table, text);
    free(text);
}

void pl_table_format_cell(pl_table *table, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_list(table, format, arguments);
    va_end(arguments);
}

void pl_table_number(pl_table *table, double value, int digits)
{
    if (isfinite(value)) {
        pl_table_format_cell(table, "%.*g", digits, value);
    } else {
        pl_table_add(table, "-");
    }
}

void pl_table_add_markup(pl_table *table, const char *markup)
{
    pl_table_add(table, markup);
    table->cells[table->cell_count - 1].is_markup = true;
}

void pl_table_add_span(pl_table *table, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_list(table, format, arguments);
    va_end(arguments);
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

/* ---- Text ----
 *
 * Each column has a natural width, in which no cell is broken, and a least width, in which no word
 * and no number is broken. Columns that share a line are as wide as their least widths; what is left
 * goes, blank by blank, to the column with the most lines. */

static const char RESET[] = "\033[0m", FAINT[] = "\033[2m";

/* The gap between columns, and the width from which on a text may be broken. */
enum { GAP = 2, TEXT_WIDTH = 20, UNLIMITED = 1 << 24 };

/* How a table is written. All arrays have an item for each column. */
typedef struct layout {
    const pl_table *table;
    pl_text_buffer *out;
    int keys;      /* columns that start each group */
    int available; /* width for columns and gaps; UNLIMITED where there is no limit */
    int *natural, *least, *width;
    int *shown;        /* the columns that share a line */
    const char **rest; /* of each cell of the row, what is not yet written */
} layout;

static int larger(int a, int b)
{
    return a > b ? a : b;
}

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

static void measure(layout *l, int column)
{
    const bool is_number = l->table->headings[column].align == PL_RIGHT;
    const char *heading = pl_table_text(l->table, -1, column);
    l->natural[column] = pl_text_width(heading);
    l->least[column] = pl_longest_word(heading);
    for (int row = 0; row < pl_table_rows(l->table); ++row) {
        const char *text = pl_table_text(l->table, row, column);
        if (text != NULL && !pl_table_cell_at(l->table, row, column)->is_span) {
            const int width = pl_text_width(text);
            const int least =
                is_number ? width : larger(smaller(width, TEXT_WIDTH), pl_longest_word(text));
            l->natural[column] = larger(l->natural[column], width);
            l->least[column] = larger(l->least[column], least);
        }
    }
}

/* The width of columns [first, last) with the gaps between them. */
static int width_of(const int *widths, int first, int last)
{
    int sum = first < last ? -GAP : 0;
    for (int k = first; k < last; ++k) {
        sum += widths[k] + GAP;
    }
    return sum;
}

/* Of the first `count` columns shown, the one whose cells have the most lines; -1: all have one. */
static int most_broken(const layout *l, int count)
{
    int found = -1;
    for (int i = 0; i < count; ++i) {
        const int k = l->shown[i];
        if (l->width[k] < l->natural[k] &&
            (found < 0 ||
             (long)l->natural[k] * l->width[found] > (long)l->natural[found] * l->width[k])) {
            found = k;
        }
    }
    return found;
}

/* Makes the key columns no wider than two thirds of the line. */
static void narrow_keys(layout *l)
{
    while (width_of(l->least, 0, l->keys) > 2 * l->available / 3) {
        int widest = 0;
        for (int k = 1; k < l->keys; ++k) {
            widest = l->least[k] > l->least[widest] ? k : widest;
        }
        if (l->least[widest] == 1) {
            return;
        }
        l->least[widest] -= 1;
    }
}

/* Sets the widths of the key columns and of as many others, from `first` on, as fit. Returns the
 * first column that does not. */
static int lay_out(layout *l, int first)
{
    int count = 0, last = first;
    int used = l->keys > 0 ? width_of(l->least, 0, l->keys) : -GAP;
    for (; count < l->keys; ++count) {
        l->shown[count] = count;
    }
    do {
        l->shown[count++] = last;
        used += l->least[last++] + GAP;
    } while (last < l->table->column_count && used + GAP + l->least[last] <= l->available);
    for (int i = 0; i < count; ++i) {
        l->width[l->shown[i]] = l->least[l->shown[i]];
    }
    if (used > l->available) {
        l->width[first] = larger(1, l->width[first] - (used - l->available));
    }
    int k = 0;
    for (; used < l->available && (k = most_broken(l, count)) >= 0; ++used) {
        l->width[k] += 1;
    }
    return last;
}

static const char *colour_of(const char *style)
{
    static const char *const colours[][2] = {
        {"ok", "\033[32m"}, {"poor", "\033[33m"}, {"bad", "\033[31m"}, {"none", "\033[2m"}};
    for (size_t i = 0; style != NULL && i < sizeof colours / sizeof colours[0]; ++i) {
        if (strcmp(style, colours[i][0]) == 0) {
            return colours[i][1];
        }
    }
    return "";
}

/* Writes the next line of a cell after `spaces`, in `width`. Returns the spaces that are then due. */
static int write_part(const layout *l, int row, int column, int width, int spaces)
{
    const pl_table_cell *cell = pl_table_cell_at(l->table, row, column);
    const bool is_right = l->table->headings[column].align == PL_RIGHT && !cell->is_span;
    const char *rest = l->rest[column], *colour = l->table->colour ? colour_of(cell->style) : "";
    size_t next = 0;
    const size_t length = pl_fold_line(rest, width, &next);
    pl_text_buffer plain = {0};
    pl_text_add_plain(&plain, rest, length);
    char *part = pl_text_take(&plain);
    const int used = pl_text_width(part);
    l->rest[column] = rest + next;
    const int blank = width - used;
    if (used > 0) {
        pl_text_add_spaces(l->out, spaces + (is_right ? blank : 0));
        pl_text_add(l->out, colour);
        pl_text_add(l->out, part);
        pl_text_add(l->out, colour[0] != '\0' ? RESET : "");
    }
    free(part);
    return GAP + (used == 0 ? spaces + width : is_right ? 0 : blank);
}

/* Writes one line of a row: what is left of its cells. Returns whether any is. */
static bool write_line(const layout *l, int row, int count)
{
    int spaces = l->table->indent, left = l->available;
    bool is_left = false;
    const bool is_faint = l->table->colour && row < 0;
    pl_text_add(l->out, is_faint ? FAINT : "");
    for (int i = 0; i < count; ++i) {
        const int k = l->shown[i];
        if (l->rest[k] == NULL) {
            break;
        }
        const int width =
            pl_table_cell_at(l->table, row, k)->is_span ? larger(1, left) : l->width[k];
        spaces = write_part(l, row, k, width, spaces);
        left -= width + GAP;
        is_left = is_left || l->rest[k][0] != '\0';
    }
    pl_text_add(l->out, is_faint ? RESET : "");
    pl_text_add(l->out, "\n");
    return is_left;
}

static void write_row(const layout *l, int row, int count)
{
    for (int i = 0; i < count; ++i) {
        l->rest[l->shown[i]] = pl_table_text(l->table, row, l->shown[i]);
    }
    while (write_line(l, row, count)) {}
}

/* Writes the table with the arrays of the layout, which have room but no values yet. */
static void write_layout(layout *l, int first, int last)
{
    const int columns = l->table->column_count;
    for (int k = 0; k < columns; ++k) {
        measure(l, k);
    }
    if (width_of(l->natural, 0, columns) <= l->available) {
        memcpy(l->least, l->natural, (size_t)columns * sizeof *l->least);
    } else {
        narrow_keys(l);
    }
    for (int from = l->keys, to = 0; from < columns; from = to) {
        to = lay_out(l, from);
        pl_text_add(l->out, from > l->keys ? "\n" : "");
        for (int row = -1; row < last; row = row < 0 ? first : row + 1) {
            write_row(l, row, l->keys + to - from);
        }
    }
}

static void write_text(const pl_table *table, int first, int last, pl_text_buffer *out)
{
    const int columns = table->column_count;
    int *numbers = pl_heap_new(4 * (size_t)columns, sizeof *numbers);
    const char **rest = pl_heap_new((size_t)columns, sizeof *rest);
    layout l = {.table = table,
                .out = out,
                .keys = smaller(larger(1, table->keys), columns - 1),
                .available = table->line_width > 0 ? larger(1, table->line_width - table->indent)
                                                   : UNLIMITED,
                .natural = numbers,
                .least = numbers + columns,
                .width = numbers + 2 * (size_t)columns,
                .shown = numbers + 3 * (size_t)columns,
                .rest = rest};
    write_layout(&l, first, last);
    free(numbers);
    free(rest);
}

/* ---- Markdown ---- */

static void write_markdown_row(const pl_table *table, int row, pl_text_buffer *out)
{
    for (int k = 0; k < table->column_count; ++k) {
        const char *text = pl_table_text(table, row, k);
        text = text == NULL ? "" : text;
        pl_text_add(out, "| ");
        if (pl_table_cell_at(table, row, k)->is_markup) {
            pl_text_add(out, text);
        } else {
            pl_text_add_markdown(out, text);
        }
        pl_text_add(out, " ");
    }
    pl_text_add(out, "|\n");
}

static void write_markdown(const pl_table *table, int first, int last, pl_text_buffer *out)
{
    write_markdown_row(table, -1, out);
    for (int k = 0; k < table->column_count; ++k) {
        pl_text_add(out, table->headings[k].align == PL_RIGHT ? "|---:" : "|---");
    }
    pl_text_add(out, "|\n");
    for (int row = first; row < last; ++row) {
        write_markdown_row(table, row, out);
    }
}

/* ---- CSV ---- */

static void write_csv(const pl_table *table, int first, int last, pl_text_buffer *out)
{
    for (int row = -1; row < last; row = row < 0 ? first : row + 1) {
        for (int k = 0; k < table->column_count; ++k) {
            const char *text = pl_table_text(table, row, k);
            pl_text_add(out, k == 0 ? "" : ",");
            pl_text_add_csv(out, text == NULL ? "" : text);
        }
        pl_text_add(out, "\r\n");
    }
}

/* ---- All ---- */

void pl_table_write(const pl_table *table, pl_table_format format, pl_text_buffer *out)
{
    static void (*const writers[])(const pl_table *, int, int,
                                   pl_text_buffer *) = {[PL_TABLE_TEXT] = write_text,
                                                        [PL_TABLE_MARKDOWN] = write_markdown,
                                                        [PL_TABLE_CSV] = write_csv};
    const int rows = pl_table_rows(table);
    const int last = table->last == 0 || table->last > rows ? rows : table->last;
    if (table->first < last || format == PL_TABLE_CSV) {
        writers[format](table, table->first, last, out);
    }
}

void pl_table_print(pl_table *table, FILE *out)
{
    pl_text_buffer text = {0};
    table->line_width = pl_window_width(out);
    pl_table_write(table, PL_TABLE_TEXT, &text);
    pl_text_print(&text, out);
}
