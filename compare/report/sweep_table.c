#include "sweep_table.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { CELL_SIZE = 1024, WIDTH_MOST = 60 };

void pl_sweep_table_free(pl_sweep_table *table)
{
    pl_text_free(&table->texts);
}

void pl_sweep_table_add(pl_sweep_table *table, const char *format, ...)
{
    char text[CELL_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    pl_text_add(&table->texts, text);
    pl_text_format(&table->texts, "%c", '\0');
    table->cells++;
}

int pl_sweep_table_rows(const pl_sweep_table *table)
{
    return table->texts.failed ? 0 : table->cells / table->columns;
}

static const char *next_text(const char *from)
{
    return from + strlen(from) + 1;
}

static const char *row_text(const pl_sweep_table *table, int row)
{
    const char *text = table->texts.data;
    for (int i = 0; i < row * table->columns; i++)
        text = next_text(text);
    return text;
}

void pl_sweep_table_html(const pl_sweep_table *table, int first, int last, pl_text_buffer *out)
{
    if (first >= last || pl_sweep_table_rows(table) < last)
        return;
    pl_text_add(out, "<div class=\"scroll\"><table>\n<thead><tr>");
    for (int k = 0; k < table->columns; k++)
        pl_text_add_element(out, table->numeric[k] ? "<th class=\"n\">" : "<th>", table->heads[k],
                            "</th>");
    pl_text_add(out, "</tr></thead>\n<tbody>\n");
    const char *text = row_text(table, first);
    for (int i = first; i < last; i++) {
        for (int k = 0; k < table->columns; k++, text = next_text(text)) {
            pl_text_add(out, k == 0 ? "<tr><th>" : table->numeric[k] ? "<td class=\"n\">" : "<td>");
            pl_text_add_html(out, text);
            pl_text_add(out, k == 0 ? "</th>" : "</td>");
        }
        pl_text_add(out, "</tr>\n");
    }
    pl_text_add(out, "</tbody></table></div>\n");
}

/* Code points. */
static int length_of(const char *text)
{
    int count = 0;
    for (; *text != '\0'; text++)
        count += ((unsigned char)*text & 0xc0) != 0x80;
    return count < WIDTH_MOST ? count : WIDTH_MOST;
}

static void spaces(pl_text_buffer *out, int count)
{
    for (int i = 0; i < count; i++)
        pl_text_add(out, " ");
}

static void add_cell(const char *text, bool right, bool is_last, int width, pl_text_buffer *out)
{
    if (right)
        spaces(out, width - length_of(text));
    int used = pl_text_add_plain(out, text, WIDTH_MOST);
    if (!right && !is_last)
        spaces(out, width - used);
    pl_text_add(out, is_last ? "\n" : "  ");
}

void pl_sweep_table_text(const pl_sweep_table *table, int first, int last, pl_text_buffer *out)
{
    int width[PL_SWEEP_COLUMNS_MOST] = {0};
    if (first >= last || pl_sweep_table_rows(table) < last)
        return;
    for (int k = 0; k < table->columns; k++)
        width[k] = length_of(table->heads[k]);
    const char *text = row_text(table, first);
    for (int i = first; i < last; i++)
        for (int k = 0; k < table->columns; k++, text = next_text(text))
            width[k] = length_of(text) > width[k] ? length_of(text) : width[k];
    for (int k = 0; k < table->columns; k++)
        add_cell(table->heads[k], table->numeric[k], k + 1 == table->columns, width[k], out);
    text = row_text(table, first);
    for (int i = first; i < last; i++)
        for (int k = 0; k < table->columns; k++, text = next_text(text))
            add_cell(text, table->numeric[k], k + 1 == table->columns, width[k], out);
}
