/* The table of all problems and engines, and the engines' settings, of the HTML page. */
#ifndef PLUMB_HTML_RESULTS_H
#define PLUMB_HTML_RESULTS_H

#include "report/cells.h"
#include "report/sheet.h"

/* Each a section with its heading. */
void pl_html_results(const pl_cells *cells, pl_sheet *sheet);
void pl_html_settings(const pl_cells *cells, pl_sheet *sheet);

#endif
