/* One problem of the HTML page: what it is, every metric on every engine, and the pictures. */
#ifndef PLUMB_HTML_PROBLEM_H
#define PLUMB_HTML_PROBLEM_H

#include "base/text_buffer.h"
#include "result_matrix.h"

/* `index` is the block's. */
void pl_html_problem(const pl_result_matrix *cells, int index, pl_text_buffer *out);

#endif
