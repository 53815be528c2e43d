/* The table of all problems and engines, and the engines' settings, of the HTML page. */
#ifndef PLUMB_HTML_RESULTS_H
#define PLUMB_HTML_RESULTS_H

#include "base/text_buffer.h"
#include "result_matrix.h"

/* Each a section with its heading. */
void pl_html_results(const pl_result_matrix *cells, pl_text_buffer *out);
void pl_html_settings(const pl_result_matrix *cells, pl_text_buffer *out);

#endif
