/* How far the bodies of a scene have been scattered at the end: what ensembles of chaotic scenes
 * are compared by, since no single trajectory has a right answer. */
#ifndef PLUMB_SPREAD_H
#define PLUMB_SPREAD_H

#include "metrics.h"
#include "plumb/engine_abi.h"

typedef struct pl_spread pl_spread;

/* `scene` must outlive it. NULL when out of memory. Freed by pl_spread_destroy (NULL allowed). */
pl_spread *pl_spread_create(const pl_scene *scene);
void pl_spread_destroy(pl_spread *spread);

/* Whether there is anything to scatter: two dynamic bodies. */
bool pl_spread_applies(const pl_spread *spread);

/* The state before the first step. */
void pl_spread_start(pl_spread *spread, const pl_body_state *bodies);

/* spread_x, spread_y, mass_height and run_out_p95 of a last state, into item[PL_METRIC_COUNT].
 * mass_height stays absent where there is no gravity. */
void pl_spread_measure(pl_spread *spread, const pl_body_state *bodies, pl_metric *item);

#endif
