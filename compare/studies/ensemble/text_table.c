#include "text_table.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

struct pl_text_table {
    char **cells; /* (count), the heads first */
    int count, columns;
};

pl_text_table *pl_text_table_begin(const char *const *heads, int columns)
{
    pl_text_table *table = calloc(1, sizeof *table);
    if (table != NULL) {
        table->columns = columns;
        for (int i = 0; i < columns; ++i) {
            pl_text_table_add(table, heads[i]);
        }
    }
    return table;
}

void pl_text_table_add(pl_text_table *table, const char *text)
{
    if (table == NULL) {
        return;
    }
    char **grown = realloc(table->cells, ((size_t)table->count + 1) * sizeof *grown);
    char *cell = malloc(2 * strlen(text) + 1);
    if (grown != NULL) {
        table->cells = grown;
    }
    if (grown == NULL || cell == NULL) {
        free(cell);
        return;
    }
    char *to = cell;
    for (const char *from = text; *from != '\0'; ++from) {
        if (*from == '|') {
            *to++ = '\\';
        }
        *to++ = (unsigned char)*from < 0x20 ? '?' : *from;
    }
    *to = '\0';
    table->cells[table->count++] = cell;
}

void pl_text_table_format(pl_text_table *table, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    pl_text_table_add(table, text);
}

/* Code points of UTF-8. */
static int width_of(const char *text)
{
    int width = 0;
    for (; *text != '\0'; ++text) {
        width += ((unsigned char)*text & 0xc0) != 0x80;
    }
    return width;
}

static int column_width(const pl_text_table *table, int column)
{
    int widest = 3;
    for (int i = column; i < table->count; i += table->columns) {
        int width = width_of(table->cells[i]);
        widest = width > widest ? width : widest;
    }
    return widest;
}

static void write_rule(const pl_text_table *table, FILE *out)
{
    for (int k = 0; k < table->columns; ++k) {
        fputs("|-", out);
        for (int i = column_width(table, k); i > 0; --i) {
            fputc('-', out);
        }
        fputc('-', out);
    }
    fputs("|\n", out);
}

void pl_text_table_end(pl_text_table *table, FILE *out)
{
    if (table == NULL) {
        return;
    }
    for (int i = 0; i < table->count && table->count > table->columns; ++i) {
        const int column = i % table->columns;
        const char *cell = table->cells[i];
        fprintf(out, "| %s%*s ", cell, column_width(table, column) - width_of(cell), "");
        if (column == table->columns - 1) {
            fputs("|\n", out);
        }
        if (i == table->columns - 1) {
            write_rule(table, out);
        }
    }
    if (table->count > table->columns) {
        fputc('\n', out);
    }
    for (int i = 0; i < table->count; ++i) {
        free(table->cells[i]);
    }
    free(table->cells);
    free(table);
}
