/* The solver benchmark's result as text. */
#ifndef PLUMB_SOLVER_BENCHMARK_REPORT_H
#define PLUMB_SOLVER_BENCHMARK_REPORT_H

#include <jansson.h>

/* Both take the whole result ("plumb.solver_benchmark/1") and return malloc'd text; NULL when out
 * of memory. Markdown begins with what was not reached and what is slower than Gauss-Seidel; CSV
 * has a row for every level of every cell. */
char *pl_benchmark_markdown(const json_t *result);
char *pl_benchmark_csv(const json_t *result);

#endif
