/* A growing text. Failure is sticky, so that pages are written without a check a line. */
#include "report/sheet.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void pl_sheet_free(pl_sheet *sheet)
{
    free(sheet->data);
    *sheet = (pl_sheet){0};
}

/* Room for `extra` bytes and a zero. */
static bool reserve(pl_sheet *sheet, size_t extra)
{
    if (sheet->failed)
        return false;
    size_t needed = sheet->length + extra + 1;
    if (needed <= sheet->capacity)
        return true;
    size_t capacity = sheet->capacity < 1024 ? 1024 : sheet->capacity;
    while (capacity < needed)
        capacity *= 2;
    char *data = realloc(sheet->data, capacity);
    if (data == NULL) {
        sheet->failed = true;
        return false;
    }
    sheet->data = data;
    sheet->capacity = capacity;
    return true;
}

static void add_bytes(pl_sheet *sheet, const char *bytes, size_t count)
{
    if (!reserve(sheet, count))
        return;
    memcpy(sheet->data + sheet->length, bytes, count);
    sheet->length += count;
    sheet->data[sheet->length] = '\0';
}

void pl_sheet_add(pl_sheet *sheet, const char *text)
{
    add_bytes(sheet, text, strlen(text));
}

void pl_sheet_format(pl_sheet *sheet, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int count = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (count >= 0 && reserve(sheet, (size_t)count)) {
        vsnprintf(sheet->data + sheet->length, (size_t)count + 1, format, again);
        sheet->length += (size_t)count;
    } else {
        sheet->failed = true;
    }
    va_end(again);
}

void pl_sheet_add_html(pl_sheet *sheet, const char *text)
{
    for (const char *c = text; *c != '\0'; c++) {
        unsigned char byte = (unsigned char)*c;
        if (byte == '&')
            pl_sheet_add(sheet, "&amp;");
        else if (byte == '<')
            pl_sheet_add(sheet, "&lt;");
        else if (byte == '>')
            pl_sheet_add(sheet, "&gt;");
        else if (byte == '"')
            pl_sheet_add(sheet, "&quot;");
        else if (byte == '\'')
            pl_sheet_add(sheet, "&#39;");
        else if ((byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f)
            pl_sheet_add(sheet, "\xef\xbf\xbd");
        else
            add_bytes(sheet, c, 1);
    }
}

void pl_sheet_add_element(pl_sheet *sheet, const char *open, const char *text, const char *close)
{
    pl_sheet_add(sheet, open);
    pl_sheet_add_html(sheet, text);
    pl_sheet_add(sheet, close);
}

void pl_sheet_add_markdown(pl_sheet *sheet, const char *text)
{
    for (const char *c = text; *c != '\0'; c++) {
        unsigned char byte = (unsigned char)*c;
        if (byte < 0x20 || byte == 0x7f)
            pl_sheet_add(sheet, " ");
        else if (byte == '&')
            pl_sheet_add(sheet, "&amp;");
        else if (byte == '<')
            pl_sheet_add(sheet, "&lt;");
        else if (byte == '>')
            pl_sheet_add(sheet, "&gt;");
        else if (byte == '@') /* would notify a person of that name */
            pl_sheet_add(sheet, "&#64;");
        else if (strchr("\\|`*_[]~#$", byte) != NULL)
            pl_sheet_format(sheet, "\\%c", byte);
        else
            add_bytes(sheet, c, 1);
    }
}

void pl_sheet_add_csv(pl_sheet *sheet, const char *text)
{
    if (text[strcspn(text, ",\"\r\n")] == '\0') {
        pl_sheet_add(sheet, text);
        return;
    }
    pl_sheet_add(sheet, "\"");
    for (const char *c = text; *c != '\0'; c++)
        add_bytes(sheet, *c == '"' ? "\"\"" : c, *c == '"' ? 2 : 1);
    pl_sheet_add(sheet, "\"");
}

/* Bytes of the code point that starts at `c`, never past the terminating zero. */
static size_t code_point_length(const char *c)
{
    size_t length = 1;
    while (((unsigned char)c[length] & 0xc0) == 0x80)
        length++;
    return length;
}

int pl_sheet_add_plain(pl_sheet *sheet, const char *text, int columns)
{
    int total = 0;
    for (const char *c = text; *c != '\0'; c += code_point_length(c))
        total++;
    int kept = total <= columns ? total : columns - 1;
    const char *c = text;
    for (int i = 0; i < kept; i++) {
        size_t length = code_point_length(c);
        unsigned char first = (unsigned char)c[0];
        bool c1 = first == 0xc2 && length == 2 && (unsigned char)c[1] < 0xa0;
        if (first == '\n' || first == '\t')
            pl_sheet_add(sheet, " ");
        else if (first < 0x20 || first == 0x7f || c1)
            pl_sheet_add(sheet, "?");
        else
            add_bytes(sheet, c, length);
        c += length;
    }
    if (kept == total)
        return total;
    if (columns < 1)
        return 0;
    pl_sheet_add(sheet, "…");
    return columns;
}
