/* A broad phase of sort and sweep in rows. */
#ifndef PLUMB_BENCHMARK_ROWS_H
#define PLUMB_BENCHMARK_ROWS_H

#include "broad_phase/broad_phase.h"

/* All pairs whose gap may be below their margin, sorted by (a, b), in the step's arena. `order` has
 * the slots of all bounded bodies, in any order at first, and then as the last call left them. */
pe_status pe_rows_find(pe_world *world, int *order, int order_count, double dt, pe_pair **pairs,
                       int *count, pe_error *error);

#endif
