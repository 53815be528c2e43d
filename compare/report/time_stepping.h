/* How much of an error comes from the time step, and how much from contacts and friction. */
#ifndef PLUMB_STEPPING_H
#define PLUMB_STEPPING_H

#include "base/text_buffer.h"
#include "result_matrix.h"

/* The section of each page, with its heading: a line for every ok run, ours too, that has both a
 * relative primary error and a discrete_error. Nothing where there is no such run. */
void pl_stepping_html(const pl_result_matrix *cells, pl_text_buffer *out);
void pl_stepping_markdown(const pl_result_matrix *cells, pl_text_buffer *out);

#endif
