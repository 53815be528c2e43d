/* What a search found, as plumb.threshold/1 (results/SCHEMA.md) and as a table for people. */
#ifndef PLUMB_THRESHOLD_ROW_H
#define PLUMB_THRESHOLD_ROW_H

#include "threshold_search.h"

/* A new reference; NULL when out of memory. `started` is a time stamp. */
json_t *pl_threshold_json(const pl_plan *plan, const pl_threshold_search *search,
                          json_t *provenance, const char *started);

/* All of them, a block a scenario. */
void pl_threshold_print(FILE *out, const pl_plan *plan, const pl_threshold_search *searches,
                        int count);

#endif
