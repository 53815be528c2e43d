/* The report as one HTML page. */
#ifndef PLUMB_HTML_H
#define PLUMB_HTML_H

#include "findings.h"
#include "losses.h"

/* One self-contained page: no script, no request. It begins with where plumb loses. */
void pl_html_write(const pl_result_matrix *cells, const pl_losses *losses,
                   const pl_faults *findings, pl_text_buffer *out);

#endif
