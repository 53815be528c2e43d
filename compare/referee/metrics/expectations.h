/* The verdict's data: everything that a scene states, each thing with its tolerance, and how far a run
 * is off.
 *
 * The tolerance of an expectation is its own, in its own unit. Without one it follows from the scene's
 * acceptance: that many metres of a rest, and radians of its orientation; that fraction of a travel's
 * distance; that many scales of a value or a statistic. Without either the expectation is not judged. */
#ifndef PLUMB_EXPECTATIONS_H
#define PLUMB_EXPECTATIONS_H

#include "reference_error.h"

/* Sets statistics_error in item (PL_METRIC_COUNT), which has the run's other metrics, if the scene
 * expects statistics, and chaotic_error if that is the scene's primary error. A metric without any
 * part that has a value is PL_METRIC_FAILED. */
void pl_chaotic_metrics(const pl_scene *scene, pl_metric *item);

/* The metric that a statistic reads. */
pl_metric_id pl_statistic_metric(pl_statistic statistic);

/* Judges the last state, (body_count), and what the frames have shown. `item` (PL_METRIC_COUNT) has the
 * other metrics, and gets expectation_error. A period that the run was too short to show is left out. */
void pl_expectations_judge(const pl_scene *scene, const pl_values *values,
                           const pl_body_state *last, pl_metric *item, pl_deviations *deviations);

/* How a second run differs from the first. */
typedef struct pl_difference {
    long steps; /* how many of its steps end in another state */
    long first; /* of those, from 1; 0: none */
} pl_difference;

/* Judges the bits of the states of a second run, as one more expectation; after pl_expectations_judge. */
void pl_expectations_judge_bits(const pl_difference *difference, pl_metric *item,
                                pl_deviations *deviations);

#endif
