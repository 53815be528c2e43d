/* The catalogue of scenarios as one HTML page. */
#ifndef PLUMB_REPORT_CATALOGUE_H
#define PLUMB_REPORT_CATALOGUE_H

#include "base/text_buffer.h"
#include "plumb/base.h"

/* One self-contained page, no script, no request: of every scenario its picture at the start, what
 * it shows, its formula with source and validity, its threshold, its parameters and the suites that
 * it is in. PL_NO_MEMORY, or what a builder says of its own defaults. */
pl_status pl_catalogue_page(pl_text_buffer *out, pl_error *error);

#endif
