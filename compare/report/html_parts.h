/* What the sections of the HTML page are put together from. Every text that comes from results or
 * the catalogue goes through pl_text_add_html. */
#ifndef PLUMB_HTML_PARTS_H
#define PLUMB_HTML_PARTS_H

#include "base/text_buffer.h"
#include "result_matrix.h"

enum { PL_HTML_NOTE_SIZE = 640, PL_HTML_TEXT_SIZE = 160 };

/* A numeric cell's opening tag, with a tooltip where there is something to say. */
void pl_html_open_cell(pl_text_buffer *out, const char *classes, const char *note);

/* An outcome's colour: good, bad, or neither where the engine never claimed it could. */
const char *pl_html_class(const pl_cell *cell);

/* The outcome of a run that is not ok, and of how many repeats it is that of. */
void pl_html_badge(const pl_cell *cell, pl_text_buffer *out);

#endif
