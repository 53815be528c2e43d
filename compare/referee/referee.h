/* The referee turns the frames of one run into metrics. It uses the poses, the velocities, the
 * scene and the contacts that the engine reports; an engine never rates itself.
 *
 * The referee takes one frame at a time, so its memory does not grow with the duration of the run.
 * pl_referee_create allocates it; only longer lists of contacts and pairs are allocated later. */
#ifndef PLUMB_REFEREE_H
#define PLUMB_REFEREE_H

#include "referee/metrics/mechanics.h"

/* A referee of one run. */
typedef struct pl_referee pl_referee;

/* Up to `threads` threads share the work on a frame, 1 or fewer: one; the results do not depend on them.
 * `scene` must outlive the referee. The caller frees it by pl_referee_destroy. */
pl_referee *pl_referee_create(const pl_scene *scene, int threads);
/* Frees the referee; NULL is allowed. */
void pl_referee_destroy(pl_referee *referee);

/* Takes the state before the first step, and what the engine declares, by which its frames are judged. */
pl_ending pl_referee_start(pl_referee *referee, const pl_referee_engine *engine,
                           const pl_frame *frame);

/* Takes a step, without its number, `before` and `repeats`. Returns PL_ENDING_NONFINITE or PL_ENDING_DIVERGED from the frame on that shows
 * it, with the reason in `error` (NULL allowed). */
pl_ending pl_referee_step(pl_referee *referee, const pl_step *seen, pl_error *error);

/* The deepest overlap of the last frame, m. */
double pl_referee_penetration(const pl_referee *referee);

/* Writes all metrics, except those that the runner measures, into *metrics. Returns PL_ENDING_OK,
 * or PL_ENDING_COLLAPSED with the reason in `error`. After an early end, metrics of the final
 * state are PL_METRIC_FAILED with the reason "the run ended at step N of M", maxima and means are
 * over the steps so far, and the ending is the one that ended the run, with its reason
 * (PL_ENDING_OK if the referee did not end it). residual_unit is as in pl_engine, and *metrics
 * points to it. *note says how bodies have moved that stand, see pl_standing_judge. */
pl_ending pl_referee_finish(pl_referee *referee, const char *residual_unit, pl_metrics *metrics,
                            pl_note *note, pl_error *error);

#endif
