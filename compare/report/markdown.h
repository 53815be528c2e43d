/* The report as Markdown. */
#ifndef PLUMB_MARKDOWN_H
#define PLUMB_MARKDOWN_H

#include "findings.h"
#include "losses.h"

/* GitHub tables for the summary of a CI job: where plumb loses, then problems x engines, then
 * where other engines err and why, then failed runs. */
void pl_markdown_write(const pl_result_matrix *cells, const pl_losses *losses,
                       const pl_faults *findings, pl_text_buffer *out);

#endif
