/* One case of the HTML page: its scene, every metric on every engine, and the pictures;
 * and cells that the whole report uses. */
#ifndef PLUMB_CASE_PAGE_H
#define PLUMB_CASE_PAGE_H

#include "page.h"
#include "result_matrix.h"

/* Marks a cell of HTML whose repeats differ. */
#define PL_CELL_DISAGREES "<br><span class=\"badge bad\">not deterministic</span>"

/* Adds a column for each engine configuration to a table. */
void pl_case_columns(const pl_result_matrix *matrix, pl_table *table);

/* Adds the section of the case with that index to an HTML page. */
void pl_case_page(const pl_result_matrix *matrix, int index, pl_text_buffer *out);

/* Adds a figure element for every engine that has a run of the case, or one paragraph that says why
 * there are no pictures: the scene cannot be rebuilt, or is not the one that was run. */
void pl_case_pictures(const pl_result_matrix *matrix, int index, pl_text_buffer *out);

#endif
