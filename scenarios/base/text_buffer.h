/* A growing text, with one escape for each format that the report writes. */
#ifndef PLUMB_SHEET_H
#define PLUMB_SHEET_H

#include <stdbool.h>
#include <stddef.h>

/* Starts as {0}. `data` is zero-terminated once anything was added. When memory runs out `failed`
 * is set, and all that follows does nothing: look once, at the end. */
typedef struct pl_text_buffer {
    char *data;
    size_t length, capacity;
    bool failed;
} pl_text_buffer;

void pl_text_free(pl_text_buffer *buffer);

/* As it stands. */
void pl_text_add(pl_text_buffer *buffer, const char *text);
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_text_format(pl_text_buffer *buffer, const char *format, ...);

/* For HTML text and double-quoted attributes. Control characters but newline and tab become U+FFFD.
 */
void pl_text_add_html(pl_text_buffer *buffer, const char *text);

/* `text` as HTML between two pieces that go in as they stand. */
void pl_text_add_element(pl_text_buffer *buffer, const char *open, const char *text,
                         const char *close);

/* For a cell of a GitHub table: one line, nothing in it means markup. */
void pl_text_add_markdown(pl_text_buffer *buffer, const char *text);

/* One field of RFC 4180, quoted where it must be. */
void pl_text_add_csv(pl_text_buffer *buffer, const char *text);

/* For a terminal: control characters (C0, DEL, C1) become '?', a newline a space; at most `columns`
 * code points, the last of them an ellipsis when something was cut. Returns the code points added.
 */
int pl_text_add_plain(pl_text_buffer *buffer, const char *text, int columns);

#endif
