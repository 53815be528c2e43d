/* A self-contained HTML page: the page that page/ is bundled into, with its data as JSON. C writes
 * data; page/ draws it. page/README.md describes the data of each kind of page. */
#ifndef PLUMB_PAGE_H
#define PLUMB_PAGE_H

#include "base/text_buffer.h"
#include "plumb/base.h"

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

/* ---- Of a study, made of the JSON that its command writes ---- */

enum { PL_STUDY_KIND_SIZE = 32 };

/* Reads the JSON of a study from a file: an object, an array, or objects in lines, which become an
 * array. *study is a new reference, and `kind` the word of its schema, such as "threshold" of
 * plumb.threshold/1. PL_BAD_INPUT: FILE:LINE:COLUMN, or that it is no study. PL_IO. */
pl_status pl_study_read(const char *path, json_t **study, char kind[PL_STUDY_KIND_SIZE],
                        pl_error *error);

/* Writes DIRECTORY/NAME.html, renamed to its place when it is complete. PL_IO. */
pl_status pl_study_page_write(const char *directory, const char *name, const char *kind,
                              json_t *study, pl_error *error);

/* Adds a whole page of one object {"kind": KIND, "study": STUDY}. `study` is borrowed. */
void pl_page_of_study(pl_text_buffer *out, const char *kind, json_t *study);

#endif
