/* Whether a frame can be believed at all: every number finite, no speed and no energy out of all
 * bounds. */
#ifndef PLUMB_SANITY_H
#define PLUMB_SANITY_H

#include "plumb/engine_abi.h"
#include "scale.h"

/* What a run's end looks like to the referee. */
typedef enum pl_verdict {
    PL_VERDICT_OK,
    PL_VERDICT_COLLAPSED, /* what should stand does not: final position beyond
                             scene.collapse_distance */
    PL_VERDICT_DIVERGED,  /* energy or speed beyond the scene's bound; the run should end */
    PL_VERDICT_NONFINITE  /* a pose or velocity is NaN or infinite; the run should end */
} pl_verdict;

/* NONFINITE, with body and step in `error`, when a number of a dynamic body is NaN or infinite or
 * its orientation has a squared norm outside 1/2 .. 2, so that it is no rotation. */
pl_verdict pl_check_finite(const pl_scene *scene, const pl_body_state *bodies, long step,
                           pl_error *error);

/* DIVERGED when any point of a dynamic body is faster than scale->speed_bound, or `energy_gain`
 * (the metric, now) exceeds 10: ten times the energy that the scene has to lose came from nowhere.
 * A fall, however long, gains none. */
pl_verdict pl_check_bounds(const pl_scene *scene, const pl_scale *scale,
                           const pl_body_state *bodies, double energy_gain, long step,
                           pl_error *error);

#endif
