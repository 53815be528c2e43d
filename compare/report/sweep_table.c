#include "report/sweep_table.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { CELL_SIZE = 1024, WIDTH_MOST = 60 };

void pl_sweep_table_free(pl_sweep_table *table)
{
    pl_sheet_free(&table->texts);
}

void pl_sweep_table_add(pl_sweep_table *table, const char *format, ...)
{
    char text[CELL_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    pl_sheet_add(&table->texts, text);
    pl_sheet_format(&table->texts, "%c", '\0');
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

void pl_sweep_table_html(const pl_sweep_table *table, int first, int last, pl_sheet *sheet)
{
    if (first >= last || pl_sweep_table_rows(table) < last)
        return;
    pl_sheet_add(sheet, "<div class=\"scroll\"><table>\n<thead><tr>");
    for (int k = 0; k < table->columns; k++)
        pl_sheet_add_element(sheet, table->numeric[k] ? "<th class=\"n\">" : "<th>",
                             table->heads[k], "</th>");
    pl_sheet_add(sheet, "</tr></thead>\n<tbody>\n");
    const char *text = row_text(table, first);
    for (int i = first; i < last; i++) {
        for (int k = 0; k < table->columns; k++, text = next_text(text)) {
            pl_sheet_add(sheet, k == 0              ? "<tr><th>"
                                : table->numeric[k] ? "<td class=\"n\">"
                                                    : "<td>");
            pl_sheet_add_html(sheet, text);
            pl_sheet_add(sheet, k == 0 ? "</th>" : "</td>");
        }
        pl_sheet_add(sheet, "</tr>\n");
    }
    pl_sheet_add(sheet, "</tbody></table></div>\n");
}

/* Code points. */
static int length_of(const char *text)
{
    int count = 0;
    for (; *text != '\0'; text++)
        count += ((unsigned char)*text & 0xc0) != 0x80;
    return count < WIDTH_MOST ? count : WIDTH_MOST;
}

static void spaces(pl_sheet *sheet, int count)
{
    for (int i = 0; i < count; i++)
        pl_sheet_add(sheet, " ");
}

static void add_cell(const char *text, bool right, bool is_last, int width, pl_sheet *sheet)
{
    if (right)
        spaces(sheet, width - length_of(text));
    int used = pl_sheet_add_plain(sheet, text, WIDTH_MOST);
    if (!right && !is_last)
        spaces(sheet, width - used);
    pl_sheet_add(sheet, is_last ? "\n" : "  ");
}

void pl_sweep_table_text(const pl_sweep_table *table, int first, int last, pl_sheet *sheet)
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
        add_cell(table->heads[k], table->numeric[k], k + 1 == table->columns, width[k], sheet);
    text = row_text(table, first);
    for (int i = first; i < last; i++)
        for (int k = 0; k < table->columns; k++, text = next_text(text))
            add_cell(text, table->numeric[k], k + 1 == table->columns, width[k], sheet);
}
