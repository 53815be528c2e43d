/* A self-contained HTML page: the page that page/ is bundled into, with its data as JSON. C writes
 * data; page/ draws it. page/README.md describes the data of each kind of page. */
#ifndef PLUMB_PAGE_H
#define PLUMB_PAGE_H

#include "base/text_buffer.h"

#include <jansson.h>

/* Begins a page, up to the place of its data. */
void pl_page_open(pl_text_buffer *out);

/* Adds a script element of JSON with this id, which has only letters, digits and '-'. Whatever the
 * texts in it say, they stay texts. */
void pl_page_add(pl_text_buffer *out, const char *id, const json_t *json);

/* The same for JSON that is text already, of `length` bytes. */
void pl_page_add_text(pl_text_buffer *out, const char *id, const char *text, size_t length);

/* Ends the page. */
void pl_page_close(pl_text_buffer *out);

/* Adds a whole page of one object {"kind": KIND, "study": STUDY}. `study` is borrowed. */
void pl_page_of_study(pl_text_buffer *out, const char *kind, json_t *study);

#endif
