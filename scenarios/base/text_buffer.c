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

/* The code point of `bytes` bytes at `c`; -1 where they are no UTF-8. */
static long decode(const char *c, size_t bytes)
{
    static const long least[] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char first = (unsigned char)c[0];
    const size_t length = first < 0x80   ? 1
                          : first < 0xc0 ? 0
                          : first < 0xe0 ? 2
                          : first < 0xf0 ? 3
                                         : 4;
    if (length != bytes || first >= 0xf8) {
        return -1;
    }
    long point = length == 1 ? first : first & (0x7f >> length);
    for (size_t i = 1; i < length; ++i) {
        point = point << 6 | ((unsigned char)c[i] & 0x3f);
    }
    const bool is_one = point >= least[length] && point <= 0x10ffff;
    return is_one && (point < 0xd800 || point > 0xdfff) ? point : -1;
}

void pl_text_add_html(pl_text_buffer *out, const char *text)
{
    for (size_t bytes = 0; *text != '\0'; text += bytes) {
        bytes = pl_code_point_length(text);
        const long point = decode(text, bytes);
        if (entity(*text) != NULL) {
            pl_text_add(out, entity(*text));
        } else if (point == '"') {
            pl_text_add(out, "&quot;");
        } else if (point == '\'') {
            pl_text_add(out, "&#39;");
        } else if ((point < 0x20 && point != '\n' && point != '\t') || point == 0x7f ||
                   point == 0xfffe || point == 0xffff) {
            pl_text_add(out, "\xef\xbf\xbd");
        } else {
            add(out, text, bytes);
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

char pl_stand_in(const char *c, size_t bytes)
{
    const long point = decode(c, bytes);
    if (point == '\n' || point == '\t') {
        return ' ';
    }
    const bool is_control = point < 0x20 || (point >= 0x7f && point < 0xa0);
    const bool is_mark = point == 0x61c || point == 0x200e || point == 0x200f ||
                         (point >= 0x2028 && point <= 0x202e) ||
                         (point >= 0x2066 && point <= 0x2069);
    return is_control || is_mark ? '?' : 0;
}

void pl_text_add_plain(pl_text_buffer *out, const char *text, size_t length)
{
    for (size_t at = 0, bytes = 0; at < length; at += bytes) {
        bytes = pl_code_point_length(text + at);
        const char other = pl_stand_in(text + at, bytes);
        add(out, other != 0 ? &other : text + at, other != 0 ? 1 : bytes);
    }
}

char *pl_make_plain(char *text)
{
    char *to = text;
    for (const char *from = text; *from != '\0';) {
        const size_t bytes = pl_code_point_length(from);
        const char other = pl_stand_in(from, bytes);
        if (other != 0) {
            *to++ = other;
        } else {
            memmove(to, from, bytes);
            to += bytes;
        }
        from += bytes;
    }
    *to = '\0';
    return text;
}
