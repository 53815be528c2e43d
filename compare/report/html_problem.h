/* One problem of the HTML page: what it is, every metric on every engine, and the pictures. */
#ifndef PLUMB_HTML_PROBLEM_H
#define PLUMB_HTML_PROBLEM_H

#include "report/cells.h"
#include "report/sheet.h"

/* `index` is the block's. */
void pl_html_problem(const pl_cells *cells, int index, pl_sheet *sheet);

#endif
