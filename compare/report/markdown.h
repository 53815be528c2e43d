/* The report as Markdown. */
#ifndef PLUMB_MARKDOWN_H
#define PLUMB_MARKDOWN_H

#include "report/losses.h"

/* GitHub tables for the summary of a CI job: where plumb loses, then problems x engines, then
 * failed runs. */
void pl_markdown_write(const pl_cells *cells, const pl_losses *losses, pl_sheet *sheet);

#endif
