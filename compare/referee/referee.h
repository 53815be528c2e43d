/* The referee: turns the frames of one run into metrics. It sees poses, velocities and the scene,
 * and the contacts that an engine reports; it never asks an engine how well it did.
 *
 * A run streams through it a frame at a time, so that its memory does not grow with the duration.
 * All of it is allocated by pl_referee_create. */
#ifndef PLUMB_REFEREE_H
#define PLUMB_REFEREE_H

#include "plumb/engine_abi.h"
#include "referee/metrics/metrics.h"
#include "referee/metrics/validity.h"

typedef struct pl_referee pl_referee;

/* `scene` must outlive the referee. The caller frees it by pl_referee_destroy (NULL allowed). */
pl_status pl_referee_create(const pl_scene *scene, pl_referee **referee, pl_error *error);
void pl_referee_destroy(pl_referee *referee);

/* The state before the first step. */
pl_verdict pl_referee_start(pl_referee *referee, const pl_frame *frame);

/* The state after a step. `contacts` are those of this step (NULL with contact_count < 0 when the
 * engine does not report them); cpu_time is the process's CPU time of the step call alone, s.
 * Returns NONFINITE or DIVERGED at the frame where that is seen, with the reason in `error` (NULL
 * allowed). */
pl_verdict pl_referee_step(pl_referee *referee, const pl_frame *frame, const pl_step_stats *stats,
                           const pl_contact *contacts, int contact_count, double cpu_time,
                           pl_error *error);

/* All metrics but memory_peak (the runner's) into *metrics; returns OK or COLLAPSED with the
 * reason. May be called after an early end: then final-state metrics are PL_METRIC_FAILED with the
 * reason "the run ended at step N of M", maxima and means are those of the steps seen, and the
 * verdict is the one that ended it with its reason (OK when the referee did not). residual_unit as
 * in pl_engine; *metrics points to it. */
pl_verdict pl_referee_finish(pl_referee *referee, const char *residual_unit, pl_metrics *metrics,
                             pl_error *error);

#endif
