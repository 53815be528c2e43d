/* The rows of a table before they are laid out, and their orders. */
#ifndef PLUMB_RESULT_ROWS_H
#define PLUMB_RESULT_ROWS_H

#include "result_table.h"

/* Reads the rows of all files into the table, without those that newer ones replace, which it counts. Errors as of
 * pl_result_table_build. */
pl_status pl_result_rows_read(const pl_result_table_def *def, pl_result_table *table,
                              pl_error *error);

/* What tells the row's scene from others. */
pl_case_identity pl_result_row_scene(const pl_result_row *row);

/* Order by scene, as of strcmp: 0 for rows of one scene. */
int pl_result_rows_compare_scenes(const pl_result_row *a, const pl_result_row *b);

/* Order by case: by scene, then by falling time step, change and hash. */
int pl_result_rows_compare_cases(const pl_result_row *a, const pl_result_row *b);

/* Order by build, of rows of one engine. */
int pl_result_rows_compare_builds(const pl_result_row *a, const pl_result_row *b);

#endif
