/* Errors of chaotic motion, where no single trajectory is right. Both follow from other metrics of
 * the run, which hold for every right motion. */
#ifndef PLUMB_CHAOTIC_H
#define PLUMB_CHAOTIC_H

#include "metrics.h"
#include "plumb/scene.h"

/* Sets statistics_error in item (PL_METRIC_COUNT), which has the run's other metrics, if the scene
 * expects statistics, and chaotic_error if that is the scene's primary error. A metric without any
 * part that has a value is PL_METRIC_FAILED. */
void pl_chaotic_metrics(const pl_scene *scene, pl_metric *item);

/* The metric that a statistic reads. */
pl_metric_id pl_statistic_metric(pl_statistic statistic);

#endif
