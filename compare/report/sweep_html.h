/* A sweep as a part of an HTML page, and as a page of its own. */
#ifndef PLUMB_REPORT_SWEEP_HTML_H
#define PLUMB_REPORT_SWEEP_HTML_H

#include "base/text_buffer.h"
#include "studies/sweep/analysis.h"

/* The sections, with their headings, where plumb loses first. The page's head must have the rules
 * of pl_style and pl_sweep_style. */
void pl_sweep_html(const pl_sweep_analysis *analysis, pl_text_buffer *out);

/* One self-contained page: no script, no request. */
void pl_sweep_page(const pl_sweep_analysis *analysis, pl_text_buffer *out);

#endif
