/* Tables of results made by hand. */
#ifndef PLUMB_TEST_RESULT_TABLES_H
#define PLUMB_TEST_RESULT_TABLES_H

#include "results/result_table.h"

/* Makes a table of the file made.jsonl, with runs on changed scenes; plumb is the home engine, if it has runs. The test
 * fails where the results are refused. */
pl_result_table *table_of(const json_t *results);

/* The same of two files, each a snapshot of its own, or both of one, for the home engine (NULL: none). */
pl_result_table *table_of_two(const json_t *first, const json_t *second, bool is_one_snapshot,
                              const char *home);

/* Frees a table; NULL is allowed. */
void free_table(const pl_result_table *table);

#endif
