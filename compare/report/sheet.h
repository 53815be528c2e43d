/* A growing text, with one escape for each format that the report writes. */
#ifndef PLUMB_SHEET_H
#define PLUMB_SHEET_H

#include <stdbool.h>
#include <stddef.h>

/* Starts as {0}. `data` is zero-terminated once anything was added. When memory runs out `failed`
 * is set, and all that follows does nothing: look once, at the end. */
typedef struct pl_sheet {
    char *data;
    size_t length, capacity;
    bool failed;
} pl_sheet;

void pl_sheet_free(pl_sheet *sheet);

/* As it stands. */
void pl_sheet_add(pl_sheet *sheet, const char *text);
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_sheet_format(pl_sheet *sheet, const char *format, ...);

/* For HTML text and double-quoted attributes. Control characters but newline and tab become U+FFFD.
 */
void pl_sheet_add_html(pl_sheet *sheet, const char *text);

/* `text` as HTML between two pieces that go in as they stand. */
void pl_sheet_add_element(pl_sheet *sheet, const char *open, const char *text, const char *close);

/* For a cell of a GitHub table: one line, nothing in it means markup. */
void pl_sheet_add_markdown(pl_sheet *sheet, const char *text);

/* One field of RFC 4180, quoted where it must be. */
void pl_sheet_add_csv(pl_sheet *sheet, const char *text);

/* For a terminal: control characters (C0, DEL, C1) become '?', a newline a space; at most `columns`
 * code points, the last of them an ellipsis when something was cut. Returns the code points added.
 */
int pl_sheet_add_plain(pl_sheet *sheet, const char *text, int columns);

#endif
