/* From rows of results to the scenes, engines and points of an analysis. */
#ifndef PLUMB_SWEEP_ANALYSIS_ROWS_H
#define PLUMB_SWEEP_ANALYSIS_ROWS_H

#include "analysis.h"

/* Fills points (but for their numbers), engines and scenes, each in its order, and the flags of
 * hosts and builds. Errors as of pl_sweep_analyse. */
pl_status pl_sweep_gather(const json_t *results, pl_sweep_analysis *analysis, pl_error *error);

/* Fills the numbers of a point from its repeats. */
pl_status pl_sweep_measure(const json_t *const *rows, int count, pl_sweep_point *point,
                           pl_error *error);

#endif
