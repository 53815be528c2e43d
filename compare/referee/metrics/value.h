/* The numbers that a scene expects of its bodies' paths, read from the frames. */
#ifndef PLUMB_REFEREE_VALUE_H
#define PLUMB_REFEREE_VALUE_H

#include "integrator.h"
#include "metrics.h"
#include "plumb/engine_abi.h"

typedef struct pl_values pl_values;

/* `scene` must outlive it. NULL: out of memory. Destroyed by pl_values_destroy (NULL allowed). */
pl_values *pl_values_create(const pl_scene *scene);
void pl_values_destroy(pl_values *values);

/* The state after step number `step`, from 0 (before the first) on. */
void pl_values_see(pl_values *values, long step, const pl_body_state *bodies);

/* The largest |found - expected| / scale against the continuous answers; absent where nothing is
 * expected. FAILED: a period that has not been seen whole. */
pl_metric pl_values_error(const pl_values *values);

/* The same against the answers of the engine's own rule, if they are known of all values. */
pl_metric pl_values_discrete_error(const pl_values *values, pl_integrator integrator);

#endif
