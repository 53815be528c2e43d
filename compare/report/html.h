/* The report as one HTML page. */
#ifndef PLUMB_HTML_H
#define PLUMB_HTML_H

#include "report/findings.h"
#include "report/losses.h"

/* One self-contained page: no script, no request. It begins with where plumb loses. */
void pl_html_write(const pl_cells *cells, const pl_losses *losses, const pl_faults *findings,
                   pl_sheet *sheet);

#endif
