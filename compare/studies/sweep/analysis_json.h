/* An analysis as one JSON object, plumb.sweep/1 (SCHEMA.md beside this). */
#ifndef PLUMB_SWEEP_ANALYSIS_JSON_H
#define PLUMB_SWEEP_ANALYSIS_JSON_H

#include "analysis.h"

/* A new reference; NULL when out of memory. */
json_t *pl_sweep_to_json(const pl_sweep_analysis *analysis);

#endif
