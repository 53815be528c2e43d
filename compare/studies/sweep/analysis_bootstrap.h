/* What fronts would say had the repeats fallen otherwise: the bootstrap (Efron 1979). */
#ifndef PLUMB_SWEEP_ANALYSIS_DRAWS_H
#define PLUMB_SWEEP_ANALYSIS_DRAWS_H

#include "analysis_front.h"

/* In every replicate each point gets as many repeats as it has, drawn from its own with
 * replacement, and their medians make the fronts. Two or three repeats do not tell their own
 * scatter: of fewer than ten, each that is drawn is moved by the scene's noise (the smoothed
 * bootstrap, Silverman and Young 1987). Each point has a stream of random numbers of its own, so
 * that what a replicate says of one engine does not depend on which others were run. Fills readings
 * (engine_count x PL_BOOTSTRAP_REPLICATES, engine by engine) for the engines that have points
 * there. */
pl_status pl_bootstrap(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                       pl_front_reading *readings, pl_error *error);

/* The middle 95 % of `values`, which it sorts, those that are NAN left out; NAN where over 5 % are.
 * Percentile interval, Efron 1981. */
void pl_bootstrap_interval(double *values, int count, double *low, double *high);

#endif
