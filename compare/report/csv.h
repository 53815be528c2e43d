/* Results as CSV. */
#ifndef PLUMB_CSV_H
#define PLUMB_CSV_H

#include "base/text_buffer.h"

#include <jansson.h>

/* The long form of RFC 4180, with a header and CRLF: one row a run and metric, with what identifies
 * the run in every row; a run without metrics has one row whose metric is empty. Numbers at full
 * precision; what is null or absent is an empty field. `results` is an array of checked rows. */
void pl_csv_write(json_t *results, pl_text_buffer *out);

#endif
