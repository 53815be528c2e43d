/* The problems of which others published numbers: a suite's source beside the results. */
#ifndef PLUMB_PUBLISHED_H
#define PLUMB_PUBLISHED_H

#include "result_matrix.h"

/* The block is the problem of a suite's entry: its scenario and parameters, whatever its step and
 * duration, which publications leave open. */
bool pl_published_is(const pl_block *block, const pl_suite_entry *entry);

/* The suite has published numbers, and the results hold every problem of it. */
bool pl_published_applies(const pl_suite *suite, const pl_result_matrix *cells);

#endif
