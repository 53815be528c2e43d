/* Our engine against each other: problem by problem, and over all of them. */
#ifndef PLUMB_SWEEP_ANALYSIS_DUELS_H
#define PLUMB_SWEEP_ANALYSIS_DUELS_H

#include "analysis.h"

/* From curves to pairs, their means and the duels of each problem. */
pl_status pl_duels_fight(pl_sweep_analysis *analysis, pl_error *error);

/* From duels to the list of losses. */
pl_status pl_duels_list_losses(pl_sweep_analysis *analysis, pl_error *error);

#endif
