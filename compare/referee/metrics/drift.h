/* Displacement from a baseline in the directions in which the reference does not move: how far at
 * most, and how fast on the whole.
 *
 * It follows the bodies of scene.rests in all directions and those of scene.travels across their
 * own. */
#ifndef PLUMB_DRIFT_H
#define PLUMB_DRIFT_H

#include "plumb/engine_abi.h"

typedef struct pl_drift pl_drift;

/* NULL when out of memory. Freed by pl_drift_destroy (NULL allowed). */
pl_drift *pl_drift_create(const pl_scene *scene);
void pl_drift_destroy(pl_drift *drift);

/* Whether the scene has any body to follow. */
bool pl_drift_applies(const pl_drift *drift);

/* Forgets all, and takes these poses at `time` (s) as the baseline and the first sample. */
void pl_drift_begin(pl_drift *drift, double time, const pl_body_state *bodies);
/* One more sample; a later time than the last. */
void pl_drift_add(pl_drift *drift, double time, const pl_body_state *bodies);

/* Samples since the baseline, with it; 0 before pl_drift_begin. */
long pl_drift_samples(const pl_drift *drift);

/* Max over bodies and samples of the displacement, m. */
double pl_drift_largest(const pl_drift *drift);

/* Max over bodies of the norm of the least-squares slope of the displacement against time, m/s.
 * Needs two samples. */
double pl_drift_slope(const pl_drift *drift);

#endif
