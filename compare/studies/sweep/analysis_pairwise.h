/* Our engine against each other: scene by scene, and over all of them. */
#ifndef PLUMB_SWEEP_ANALYSIS_DUELS_H
#define PLUMB_SWEEP_ANALYSIS_DUELS_H

#include "analysis.h"

/* From curves to pairs, their means and the comparisons of each scene. */
pl_status pl_compare_pairwise(pl_sweep_analysis *analysis, pl_error *error);

/* From comparisons to the list of losses. */
pl_status pl_list_losses(pl_sweep_analysis *analysis, pl_error *error);

#endif
