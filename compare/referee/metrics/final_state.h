/* What the last frame of a complete run says against what the scene expects. */
#ifndef PLUMB_FINAL_STATE_H
#define PLUMB_FINAL_STATE_H

#include "integrator.h"
#include "metrics.h"
#include "plumb/engine_abi.h"

/* PL_METRIC_ABSENT where the scene expects nothing of the kind. `bodies` has scene->body_count
 * items. */
pl_metric pl_rest_position_error(const pl_scene *scene, const pl_body_state *bodies);
/* Spheres have no orientation that shows, and are left out. */
pl_metric pl_rest_rotation_error(const pl_scene *scene, const pl_body_state *bodies);
pl_metric pl_travel_error(const pl_scene *scene, const pl_body_state *bodies);
/* Against the answer of the engine's own rule, if it is known of all travels. */
pl_metric pl_discrete_error(const pl_scene *scene, const pl_body_state *bodies,
                            pl_integrator integrator);
pl_metric pl_state_hash(const pl_scene *scene, const pl_body_state *bodies);

/* Index into scene->rests of the body farthest from its reference and how far, m; -1 when none is
 * expected to rest. */
int pl_farthest_from_rest(const pl_scene *scene, const pl_body_state *bodies, double *distance);

#endif
