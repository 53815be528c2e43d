/* Metrics of the motion of bodies: lift-off height, path deviation, settling, drift, creep, and the
 * spread of the bodies at the end. Formulas are at the head of motion.c. */
#ifndef PLUMB_MOTION_H
#define PLUMB_MOTION_H

#include "base/arena.h"
#include "metrics.h"
#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* The state of these metrics over a run. */
typedef struct pl_motion pl_motion;

/* `scene` must outlive it. Memory of the arena; NULL when out of memory. */
pl_motion *pl_motion_create(const pl_scene *scene, pl_arena *arena);

/* Takes the state after step number `step`, (scene->body_count), from 0, before the first, on. */
void pl_motion_see(pl_motion *motion, long step, const pl_body_state *bodies);

/* Sets lift, path_deviation, settle_time, drift, creep, spread_x, spread_y, mass_height and
 * run_out_p95 in item (PL_METRIC_COUNT). A metric that does not apply to the scene stays
 * PL_METRIC_ABSENT. `last` is the state after the last of `steps` steps. */
void pl_motion_metrics(pl_motion *motion, long steps, const pl_body_state *last, pl_metric *item);

#endif
