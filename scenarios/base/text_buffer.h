/* A growing text buffer, with functions that escape text for each format that is written. */
#ifndef PLUMB_TEXT_BUFFER_H
#define PLUMB_TEXT_BUFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* Starts as {0}. `data` ends with a zero once something was added, and is NULL before. When memory
 * runs out, `failed` is set and every later call does nothing: check it once, at the end. */
typedef struct pl_text_buffer {
    char *data;
    size_t length, capacity;
    bool failed;
} pl_text_buffer;

/* Frees the text and makes the buffer empty. */
void pl_text_free(pl_text_buffer *out);

/* Adds `count` bytes unchanged. */
void pl_text_add_bytes(pl_text_buffer *out, const char *bytes, size_t count);

/* Adds text unchanged. Inline, so that the length of a literal is known. */
static inline void pl_text_add(pl_text_buffer *out, const char *text)
{
    pl_text_add_bytes(out, text, strlen(text));
}

/* Adds text as printf does. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_text_format(pl_text_buffer *out, const char *format, ...);

/* Adds `count` spaces; none for a negative count. */
void pl_text_add_spaces(pl_text_buffer *out, int count);

/* Adds text escaped for text and double-quoted attributes of HTML and XML. What these may not have,
 * control characters other than newline and tab and bytes that are no UTF-8, becomes U+FFFD. */
void pl_text_add_html(pl_text_buffer *out, const char *text);

/* Adds `text` escaped as HTML between two pieces of markup. */
void pl_text_add_element(pl_text_buffer *out, const char *open, const char *text,
                         const char *close);

/* Adds text escaped for a cell of a GitHub table: on one line and without markup. */
void pl_text_add_markdown(pl_text_buffer *out, const char *text);

/* Adds one field of CSV (RFC 4180), in quotes where necessary. */
void pl_text_add_csv(pl_text_buffer *out, const char *text);

/* Adds a word of a POSIX shell, in quotes where necessary. */
void pl_text_add_shell(pl_text_buffer *out, const char *text);

/* Adds a JSON string: text in quotes, escaped. */
void pl_text_add_json(pl_text_buffer *out, const char *text);

/* Adds the key of a member of a JSON object, with its colon. */
void pl_text_add_json_key(pl_text_buffer *out, const char *key);

/* Adds a JSON number, the shortest that reads back as the same double; null for one that is not
 * finite, which JSON has no word for. */
void pl_text_add_number(pl_text_buffer *out, double value);

/* Adds a JSON array of numbers. */
void pl_text_add_numbers(pl_text_buffer *out, const double *values, int count);

/* ---- Text from elsewhere, shown on a terminal ---- A code point that could steer the terminal or
 * deceive the eye becomes '?': control characters (C0, DEL, C1), marks that change the direction of
 * writing, separators of lines and paragraphs, and bytes that are no UTF-8. Newline and tab become
 * a space. */

/* Adds the first `length` bytes of such a text. */
void pl_text_add_plain(pl_text_buffer *out, const char *text, size_t length);

/* The same in place, of a text that ends with a zero. Returns `text`. */
char *pl_make_plain(char *text);

/* The character that is shown for the code point of `bytes` bytes at `c`, '?' or a space; 0 for one
 * that is shown itself. */
char pl_stand_in(const char *c, size_t bytes);

/* Bytes of the code point that starts at `c`, which is not the terminating zero. */
size_t pl_code_point_length(const char *c);

#endif
