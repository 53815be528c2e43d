#include "text_buffer.h"

#include "number.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void pl_text_free(pl_text_buffer *out)
{
    free(out->data);
    *out = (pl_text_buffer){0};
}

/* Makes the buffer larger, for `extra` bytes and a zero. */
static bool grow(pl_text_buffer *out, size_t extra)
{
    const size_t needed = out->length + extra + 1;
    size_t capacity = out->capacity < 1024 ? 1024 : out->capacity;
    while (capacity < needed) {
        capacity *= 2;
    }
    char *data = out->failed ? NULL : realloc(out->data, capacity);
    if (data == NULL) {
        out->failed = true;
        return false;
    }
    out->data = data;
    out->capacity = capacity;
    return true;
}

/* Makes room for `extra` bytes and a zero. */
static inline bool reserve(pl_text_buffer *out, size_t extra)
{
    return (!out->failed && out->length + extra < out->capacity) || grow(out, extra);
}

/* pl_text_add_bytes, for the functions of this file. */
static inline void add(pl_text_buffer *out, const char *bytes, size_t count)
{
    if (reserve(out, count)) {
        memcpy(out->data + out->length, bytes, count);
        out->length += count;
        out->data[out->length] = '\0';
    }
}

void pl_text_add_bytes(pl_text_buffer *out, const char *bytes, size_t count)
{
    add(out, bytes, count);
}

void pl_text_format(pl_text_buffer *out, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int count = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (count >= 0 && reserve(out, (size_t)count)) {
        vsnprintf(out->data + out->length, (size_t)count + 1, format, again);
        out->length += (size_t)count;
    } else {
        out->failed = true;
    }
    va_end(again);
}

void pl_text_add_spaces(pl_text_buffer *out, int count)
{
    if (count > 0 && reserve(out, (size_t)count)) {
        memset(out->data + out->length, ' ', (size_t)count);
        out->length += (size_t)count;
        out->data[out->length] = '\0';
    }
}

/* The HTML entity of a character; NULL for one that needs none. */
static const char *entity(char c)
{
    switch (c) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    default:
        return NULL;
    }
}

void pl_text_add_html(pl_text_buffer *out, const char *text)
{
    for (const char *c = text; *c != '\0'; ++c) {
        unsigned char byte = (unsigned char)*c;
        if (entity(*c) != NULL) {
            pl_text_add(out, entity(*c));
        } else if (byte == '"') {
            pl_text_add(out, "&quot;");
        } else if (byte == '\'') {
            pl_text_add(out, "&#39;");
        } else if ((byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f) {
            pl_text_add(out, "\xef\xbf\xbd");
        } else {
            pl_text_add_bytes(out, c, 1);
        }
    }
}

void pl_text_add_element(pl_text_buffer *out, const char *open, const char *text, const char *close)
{
    pl_text_add(out, open);
    pl_text_add_html(out, text);
    pl_text_add(out, close);
}

void pl_text_add_markdown(pl_text_buffer *out, const char *text)
{
    for (const char *c = text; *c != '\0'; ++c) {
        unsigned char byte = (unsigned char)*c;
        if (byte < 0x20 || byte == 0x7f) {
            pl_text_add(out, " ");
        } else if (entity(*c) != NULL) {
            pl_text_add(out, entity(*c));
        } else if (byte == '@') { /* it would notify the person of that name */
            pl_text_add(out, "&#64;");
        } else if (strchr("\\|`*_[]~#$", byte) != NULL) {
            pl_text_format(out, "\\%c", byte);
        } else {
            pl_text_add_bytes(out, c, 1);
        }
    }
}

void pl_text_add_csv(pl_text_buffer *out, const char *text)
{
    if (text[strcspn(text, ",\"\r\n")] == '\0') {
        pl_text_add(out, text);
        return;
    }
    pl_text_add(out, "\"");
    for (const char *c = text; *c != '\0'; ++c) {
        pl_text_add_bytes(out, *c == '"' ? "\"\"" : c, *c == '"' ? 2 : 1);
    }
    pl_text_add(out, "\"");
}

void pl_text_add_shell(pl_text_buffer *out, const char *text)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-.,:/=+@%";
    const bool is_plain = text[0] != '\0' && text[strspn(text, plain)] == '\0';
    pl_text_add(out, is_plain ? "" : "'");
    for (const char *c = text; *c != '\0'; ++c) {
        pl_text_add(out, *c == '\'' ? "'\\''" : (char[]){*c, '\0'});
    }
    pl_text_add(out, is_plain ? "" : "'");
}

/* Whether a byte stands for itself in a JSON string. */
static bool is_plain_in_json(char c)
{
    return (unsigned char)c >= 0x20 && c != '"' && c != '\\';
}

void pl_text_add_json(pl_text_buffer *out, const char *text)
{
    add(out, "\"", 1);
    while (*text != '\0') {
        size_t plain = 0;
        while (is_plain_in_json(text[plain])) {
            ++plain;
        }
        add(out, text, plain);
        text += plain;
        if (*text != '\0' && (unsigned char)*text < 0x20) {
            pl_text_format(out, "\\u%04x", (unsigned)*text++);
        } else if (*text != '\0') {
            add(out, (const char[]){'\\', *text++}, 2);
        }
    }
    add(out, "\"", 1);
}

void pl_text_add_json_key(pl_text_buffer *out, const char *key)
{
    pl_text_add_json(out, key);
    add(out, ": ", 2);
}

void pl_text_add_number(pl_text_buffer *out, double value)
{
    if (!isfinite(value)) {
        pl_text_add(out, "null");
    } else if (reserve(out, PL_NUMBER_SIZE)) {
        out->length += strlen(pl_number_text(value, out->data + out->length));
    }
}

void pl_text_add_numbers(pl_text_buffer *out, const double *values, int count)
{
    add(out, "[", 1);
    for (int i = 0; i < count; ++i) {
        add(out, ", ", i == 0 ? 0 : 2);
        pl_text_add_number(out, values[i]);
    }
    add(out, "]", 1);
}

size_t pl_code_point_length(const char *c)
{
    size_t length = 1;
    while (((unsigned char)c[length] & 0xc0) == 0x80) {
        ++length;
    }
    return length;
}

int pl_text_width(const char *text)
{
    int count = 0;
    for (; *text != '\0'; text += pl_code_point_length(text)) {
        ++count;
    }
    return count;
}

int pl_text_add_plain(pl_text_buffer *out, const char *text, size_t length)
{
    int count = 0;
    for (size_t at = 0, bytes = 0; at < length; at += bytes, ++count) {
        const char *c = text + at;
        bytes = pl_code_point_length(c);
        const unsigned char first = (unsigned char)c[0];
        const bool is_c1 = first == 0xc2 && bytes == 2 && (unsigned char)c[1] < 0xa0;
        if (first == '\n' || first == '\t') {
            pl_text_add(out, " ");
        } else if (first < 0x20 || first == 0x7f || is_c1) {
            pl_text_add(out, "?");
        } else {
            pl_text_add_bytes(out, c, bytes);
        }
    }
    return count;
}
